#!/usr/bin/env python3
"""Computes one stage of a case, or takes its results from another run that had the same input.

    stage.py shake --case cases/mochikoshi --fem out/mochikoshi --phase out/mochikoshi --bin build/bin   (what make calls)

Beside the results, `.inputs/<stage>.json` keeps what they were computed from (stages.py) and which files they are. A program
that refuses its input (exit status 1) changes nothing: files of the run before come back. A shake or runout that was
interrupted goes on from its checkpoint when its input is still the same.
"""

import argparse
import json
import os
import shlex
import shutil
import sys
from pathlib import Path

sys.dont_write_bytecode = True
import settings as what_if  # noqa: E402
from stages import STAGES, Chain, Place, call  # noqa: E402


def stamp_path(root, name):
    return Path(root) / ".inputs" / f"{name}.json"


def begun_path(root, name):
    return Path(root) / ".inputs" / f"{name}.begun.json"


def read_json(path):
    try:
        return json.loads(Path(path).read_text())
    except (OSError, ValueError):
        return None


def write_json(path, content):
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f"{path.name}.{os.getpid()}.part")
    temporary.write_text(json.dumps(content, indent=1) + "\n")
    os.replace(temporary, path)


def signature(path):
    status = Path(path).stat()
    return [status.st_size, status.st_mtime_ns]


def outputs(root, name):
    """{path below root: [size, date]} of a stage's results."""
    found = sorted({path for pattern in STAGES[name].outputs for path in Path(root).glob(pattern) if path.is_file()})
    return {str(path.relative_to(root)): signature(path) for path in found}


def results_of(root, name, key):
    """The stage's results in `root` as its stamp lists them, or None: of another input, or no longer what they were."""
    stamp = read_json(stamp_path(root, name))
    if stamp is None or stamp.get("key") != key:
        return None
    files = stamp.get("outputs", {})
    try:
        return stamp if files and all(signature(Path(root) / path) == value for path, value in files.items()) else None
    except OSError:
        return None


def mark(root, name):
    """Dates the stage for make."""
    path = Path(root) / STAGES[name].marker
    path.parent.mkdir(parents=True, exist_ok=True)
    path.touch()


def finish(chain, root, name):
    mark(root, name)
    write_json(stamp_path(root, name), {**chain.record(name), "outputs": outputs(root, name)})
    begun_path(root, name).unlink(missing_ok=True)


def take(chain, name, donor, root):
    """Results of the same input in another folder, as links to the same files (copies where links cannot be): whoever
    computes them anew gives new files their names and writes into none. False when they change or go meanwhile."""
    stamp = results_of(donor, name, chain.record(name)["key"])
    if stamp is None:
        return False
    for pattern in STAGES[name].outputs:
        for path in Path(root).glob(pattern):
            path.unlink()
    try:
        for path in stamp["outputs"]:
            target = Path(root) / path
            target.parent.mkdir(parents=True, exist_ok=True)
            try:
                os.link(Path(donor) / path, target)
            except FileNotFoundError:
                return False
            except OSError:
                shutil.copy2(Path(donor) / path, target)
    except OSError:
        return False
    if results_of(donor, name, chain.record(name)["key"]) is None:
        return False
    path = Path(root) / STAGES[name].marker
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists():
        path.touch()
    write_json(stamp_path(root, name), stamp)
    return True


def compute(chain, name, place):
    """Runs the stage's program. Returns its exit status."""
    stage, root = STAGES[name], place.root(name)
    record, stamp, begun = chain.record(name), stamp_path(root, name), begun_path(root, name)
    if name == "transfer" and not chain.snapshot(place).exists():
        say_missing(chain, place)
        return 1
    command = chain.command(name, place)
    interrupted = stage.checkpoint and (root / stage.checkpoint).exists()
    goes_on = interrupted and (read_json(begun) or {}).get("key") == record["key"]
    if goes_on:
        print(shlex.join([*command, "--resume"]), flush=True)
        status = call([*command, "--resume"])
        if status != 1:
            return settle(chain, root, name, status)
        print("The checkpoint cannot be used; beginning anew.", flush=True)

    # An earlier run's files give way to the command's, and come back when it refuses its input.
    before = root / ".inputs" / f"{name}.before"
    shutil.rmtree(before, ignore_errors=True)
    before.mkdir(parents=True)
    aside = [path for pattern in stage.replaced for path in root.glob(pattern)] + [path for path in (stamp,) if path.exists()]
    for path in aside:
        (before / path.relative_to(root)).parent.mkdir(parents=True, exist_ok=True)
        os.replace(path, before / path.relative_to(root))
    write_json(begun, record)
    (root / stage.marker).parent.mkdir(parents=True, exist_ok=True)
    print(shlex.join(command), flush=True)
    status = call(command)
    if status == 1:
        for pattern in stage.replaced:
            for path in root.glob(pattern):
                shutil.rmtree(path) if path.is_dir() else path.unlink()
        for path in aside:
            os.replace(before / path.relative_to(root), path)
        begun.unlink(missing_ok=True)
    shutil.rmtree(before, ignore_errors=True)
    return settle(chain, root, name, status)


def settle(chain, root, name, status):
    if status == 0:
        finish(chain, root, name)
    elif status != 1:
        (root / STAGES[name].marker).unlink(missing_ok=True)
    return status


def say_missing(chain, place):
    there = sorted((place.fem / "fem").glob("snapshot_t*.h5"))
    print(f"There is no {chain.snapshot(place)}: {chain.case_dir}/fem.json must ask for it (output/snapshots), as transfer.json's "
          f"transfer_time (or T=) wants the state at {chain.transfer_time() or '?'} s. There are:", file=sys.stderr)
    print("\n".join(f"  {path}" for path in there) or "  none", file=sys.stderr)


def add_chain_options(parser):
    parser.add_argument("--case", type=Path, required=True, help="the case's folder")
    parser.add_argument("--bin", type=Path, required=True, help="folder of the programs")
    parser.add_argument("--size", default="default")
    parser.add_argument("--time", default="", help="time of the hand-over, in place of transfer.json's")
    parser.add_argument("--threads", default="")
    parser.add_argument("--no-film", action="store_true")
    parser.add_argument("--trust-geometry", action="store_true")


def chain_of(arguments, settings=None):
    return Chain(arguments.case, arguments.bin, arguments.size, arguments.time, arguments.threads, sys.executable,
                 not arguments.no_film, arguments.trust_geometry, settings or {})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("stage", choices=list(STAGES))
    parser.add_argument("--fem", type=Path, required=True, help="folder of results that fem/ is in")
    parser.add_argument("--phase", type=Path, required=True, help="folder of particles.h5, mpm/ and figures/")
    add_chain_options(parser)
    arguments = parser.parse_args()
    try:
        return compute(chain_of(arguments), arguments.stage, Place(arguments.fem, arguments.phase))
    except (what_if.SettingError, ValueError, OSError) as error:
        print(error, file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
