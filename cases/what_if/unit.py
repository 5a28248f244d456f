#!/usr/bin/env python3
"""Computes one unit of a sweep: one stage of one member, or of all members that share it.

    unit.py --folder out/dam/sweeps/sweep --line 7 ...        a line of units.jsonl; what make and Slurm call
    unit.py --folder ... --line 7 --every 3                   lines 7, 8 and 9, one after another

Exit status 0 computed (or there already), 2 failed (failed.json says why), 130 interrupted: it goes on when it is called again.
"""

import argparse
import json
import os
import re
import shutil
import sys
import time
from pathlib import Path

import paths  # noqa: F401
import headline
import lock
import named
import plan
import profile_of_flow
import progress
import stages
from stage import add_chain_options, chain_of, compute, read_json, results_of, take, write_json
from stages import STAGES, Place

INTERRUPTED = 130
FEM_ORDER = ("mesh", "geostatic", "shake")


class Failure(Exception):
    """The unit, or one before it, cannot be computed."""


def inputs_of(chain, stage):
    """Stages whose files its program reads."""
    if stage in FEM_ORDER:
        return [name for name in FEM_ORDER[: FEM_ORDER.index(stage)]]
    return [name for name in STAGES[stage].after if chain.has(name)]


def reason_in(log):
    """What a program said of its end: the first line of an error, or the last line."""
    lines = [line.strip() for line in Path(log).read_text(errors="replace").splitlines() if line.strip()] if Path(log).exists() else []
    told = [line for line in lines if re.search(r"\[error\]|\berror:", line)]
    return (told[:1] or lines[-1:] or ["it said nothing"])[0][:600]


def ensure(chain, stage, root, store, donors):
    """The stage's results in `root`: taken from where they are, or computed."""
    key = chain.record(stage)["key"]
    if results_of(root, stage, key):
        return
    own = plan.folder_of(store, stage, key)
    for folder in (own, *donors):
        if folder != root and results_of(folder, stage, key) and take(chain, stage, folder, root):
            return
    failed = read_json(own / "failed.json")
    if failed is not None and folder_of_unit(root) != own:
        raise Failure(failed["reason"])
    for name in inputs_of(chain, stage):
        ensure(chain, name, root, store, donors)
    status = compute(chain, stage, Place(root, root))
    if stages.SIGNALS:
        raise KeyboardInterrupt
    if status != 0:
        raise Failure(None)


def folder_of_unit(root):
    return root.parent if root.name == "work" else root


def write_member(chain, root, work, store, donors):
    """Keeps a member's numbers, front and profile; the rest goes."""
    summary = read_json(work / headline.MPM) or {}
    contents = {headline.MPM: summary, headline.STRENGTH: headline.of_strengths(summary)}
    if chain.has("shake"):
        key = chain.record("shake")["key"]
        shaken = (folder for folder in (work, plan.folder_of(store, "shake", key), *donors) if results_of(folder, "shake", key))
        folder = next(shaken, None)
        if folder is not None:
            contents[headline.FEM] = read_json(folder / headline.FEM)
            contents[headline.HANDOVER] = headline.at_handover(folder / headline.HANDOVER, float(chain.transfer_time() or "nan"))
    output = chain.content("mpm").get("output", {})
    flow = profile_of_flow.of_frames(work / "mpm", output.get("flow_distance", profile_of_flow.FLOW_DISTANCE))
    if flow is not None:
        profile_of_flow.write(root / "profile.csv", flow)
        contents[headline.FLOW] = headline.of_flow(flow)
    if (work / "mpm" / "front.csv").exists():
        shutil.copyfile(work / "mpm" / "front.csv", root / "front.csv")
    write_json(root / "member.json", {
        "key": chain.record("mpm")["key"], "measure": headline.MEASURE, "settings": stages.what_if.words(chain.settings), "numbers": headline.numbers(contents),
        "stop_reason": summary.get("stop_reason", ""), "particles": summary.get("particles"), "warnings": summary.get("warnings", []),
        "peak_memory_MB": summary.get("peak_memory_MB")})


def compute_unit(arguments, entry):
    """Exit status of a line of the table."""
    stage, key, store = entry["stage"], entry["key"], Path(arguments.store)
    root = plan.folder_of(store, stage, key)
    root.mkdir(parents=True, exist_ok=True)
    held = lock.acquire(root.with_name(f".{root.name}.lock"))
    work = root / "work" if stage == "mpm" else root
    log, begun = root / "log.txt", time.monotonic()
    chain = chain_of(arguments, entry["settings"])
    if stage == "mpm" and plan.is_done(store, key):
        return 0
    donors = [folder for _, folder in named.donors(arguments.fem, arguments.phase) if store not in folder.parents]
    screen = [os.dup(1), os.dup(2)]
    failure = None
    try:
        (root / "failed.json").unlink(missing_ok=True)
        with log.open("w") as file:
            os.dup2(file.fileno(), 1)
            os.dup2(file.fileno(), 2)
        if chain.record(stage)["key"] != key:
            raise Failure("the case or a program has changed since the sweep was planned; make sweep once more")
        ensure(chain, stage, work, store, donors)
        if stage == "mpm":
            write_member(chain, root, work, store, donors)
    except Failure as problem:
        failure = problem.args[0] or reason_in(log)
    except (OSError, ValueError, SystemExit) as problem:
        failure = f"{problem}"
    except KeyboardInterrupt:
        return INTERRUPTED
    finally:
        sys.stdout.flush()
        for number, kept in zip((1, 2), screen):
            os.dup2(kept, number)
            os.close(kept)
    if failure is None:
        log.unlink(missing_ok=True)
        if stage == "mpm":
            for folder in [work, *map(Path, entry["sole"])]:
                shutil.rmtree(folder, ignore_errors=True)
    else:
        say_failure(root, stage, failure, log)
    root.with_name(f".{root.name}.lock").unlink(missing_ok=True)  # whoever waits for it looks again
    held.close()
    progress.note(arguments.folder, stage, key, failure is None, time.monotonic() - begun)
    return 0 if failure is None else 2


def say_failure(root, stage, failure, log):
    try:
        write_json(root / "failed.json", {"stage": stage, "reason": failure, "log": str(log)})
    except OSError as problem:  # a full disk: the reason is at least said
        print(f"{root.name}: {failure} ({problem})", file=sys.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, required=True, help="the sweep's folder, with units.jsonl")
    parser.add_argument("--line", type=int, required=True)
    parser.add_argument("--every", type=int, default=1, help="lines to compute")
    parser.add_argument("--last", type=int, default=10**9)
    parser.add_argument("--failures-told", action="store_true", help="exit status 0 for a failure that failed.json tells")
    parser.add_argument("--store", type=Path, required=True)
    parser.add_argument("--fem", type=Path, required=True)
    parser.add_argument("--phase", type=Path, required=True)
    add_chain_options(parser)
    arguments = parser.parse_args()
    worst = 0
    with (arguments.folder / "units.jsonl").open() as file:
        wanted = range(arguments.line, min(arguments.line + arguments.every, arguments.last + 1))
        entries = [json.loads(text) for number, text in enumerate(file, 1) if number in wanted]
    for entry in entries:
        status = compute_unit(arguments, entry)
        if status == INTERRUPTED:
            return INTERRUPTED
        worst = max(worst, status)
    return 0 if arguments.failures_told else worst


if __name__ == "__main__":
    sys.exit(main())
