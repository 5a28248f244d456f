#!/usr/bin/env python3
"""Named runs: a case with a few values changed, beside its base run.

    named.py run weak --fem out/mochikoshi --phase out/mochikoshi --case cases/mochikoshi --bin build/bin     SET in the environment
    named.py list --results out/mochikoshi
    named.py remove weak --results out/mochikoshi

A run lives in <results>/runs/<name>/ with everything that the base run has. Stages whose input (stages.py) is that of the base
run or of another named run are links to the same files; the rest is computed. Nothing is ever written into another run.

While a run of the same name is computed anew the one before waits in runs/.<name>.before; it comes back when a program
refuses its input.
"""

import argparse
import os
import re
import shutil
import sys
import time
from pathlib import Path

sys.dont_write_bytecode = True
import lock  # noqa: E402
import settings as what_if  # noqa: E402
from stage import add_chain_options, chain_of, compute, read_json, results_of, take, write_json  # noqa: E402
from stages import STAGES, Place  # noqa: E402

REFUSED, DONE = 1, 0


def name_problem(name):
    """What is wrong with a run's name, None when nothing is."""
    if name == "base":
        return "'base' is the run without settings; choose another name"
    if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.+=-]{0,99}", name):
        return (f"'{name}' cannot be a run's name: letters, digits and _ . + = - are allowed, and it begins with a letter, "
                "digit or _")
    return None


def folder_of(results, name):
    return Path(results) / "runs" / name


def runs_in(results):
    """Names of the runs that there are."""
    return sorted(path.name for path in (Path(results) / "runs").glob("*") if path.is_dir() and not path.name.startswith("."))


def donors(fem, phase, own=None):
    """(words, folder) of everything that may have results of equal input."""
    found = []
    for base in dict.fromkeys([Path(fem), Path(phase), *sorted(Path(fem).glob("t[0-9]*"))]):
        found.append(("the base run", base))
        for path in sorted((base / "runs").glob("*")) + sorted((base / "runs").glob(".*.before")) + sorted((base / "runs").glob(".*.refused")):
            words = f"run {path.name}" if not path.name.startswith(".") else f"an earlier {path.name.split('.')[1]}"
            found.append((words, path))
        # What the members of a sweep share; of the members themselves only their numbers stay.
        found += [("a sweep", path) for path in sorted((base / "store").glob("*-*")) if not path.name.startswith("mpm-")]
    return [(words, path) for words, path in found if path.is_dir() and path != own]


def fill(chain, root, names, search):
    """Computes the stages `names` in `root`, taking from `search()` (as donors) what is there already. Returns the exit
    status and where each stage came from."""
    place, sources = Place(root, root), {}
    for name in names:
        key = chain.record(name)["key"]
        if results_of(root, name, key):
            sources[name] = "this run"
            continue
        for words, folder in search():
            if results_of(folder, name, key) and take(chain, name, folder, root):
                sources[name] = words
                print(f"{root}: {name} as in {words}", flush=True)
                break
        else:
            status = compute(chain, name, place)
            if status != DONE:
                return status, sources
            sources[name] = "computed"
    return DONE, sources


def make_way(root):
    """An earlier, complete run of the name steps aside."""
    before = root.with_name(f".{root.name}.before")
    if read_json(root / "run.json") is not None:
        shutil.rmtree(before, ignore_errors=True)
        os.replace(root, before)
    return before


def run(chain, fem, phase, name, until):
    root = folder_of(phase, name)
    held = lock.acquire(root.with_name(f".{name}.lock"), refuse=os.environ.get("WAIT") == "0")
    if held is None:
        return REFUSED
    names = chain.names(until)
    known = read_json(root / "run.json")
    words = what_if.words(chain.settings)
    complete = known is not None and all(results_of(root, stage, chain.record(stage)["key"]) for stage in names)
    if not complete:
        before = make_way(root)
        # Known at once, so that a run that is interrupted can be asked for by its name alone.
        write_json(root / "begun.json", {"name": name, "settings": words})
        status, sources = fill(chain, root, names, lambda: donors(fem, phase, root))
        refused = root.with_name(f".{name}.refused")
        if status == REFUSED:
            if before.exists():
                # What was computed so far serves the next attempt.
                shutil.rmtree(refused, ignore_errors=True)
                os.replace(root, refused)
                os.replace(before, root)
                print(f"{root}: the run before is as it was ({', '.join(read_json(root / 'run.json')['settings'])})", file=sys.stderr)
            elif not any(root.glob(".inputs/*.json")):
                shutil.rmtree(root)
            return status
        if status != DONE:
            return status
        for path in (before, refused):
            shutil.rmtree(path, ignore_errors=True)
        (root / "begun.json").unlink()
        write_json(root / "run.json", {
            "name": name, "settings": words, "size": chain.size, "case": str(chain.case_dir), "made": time.strftime("%Y-%m-%d %H:%M:%S"),
            "stages": {stage: {"key": chain.record(stage)["key"], "from": sources[stage]} for stage in names}})
    return DONE


def known_settings(phase, name):
    """Settings that the run of this name was made or begun with, None without one."""
    root = folder_of(phase, name)
    for path in (root / "begun.json", root / "run.json"):
        content = read_json(path)
        if content is not None:
            return what_if.parse(" ".join(content["settings"]))
    return None


def listed(results):
    lines = []
    for name in runs_in(results):
        root = folder_of(results, name)
        content, begun = read_json(root / "run.json"), read_json(root / "begun.json")
        summary = read_json(root / "mpm" / "summary.json") or {}
        state = content["made"] if content else "not complete"
        settings = " ".join((content or begun or {}).get("settings", []))
        runout = summary.get("runout_m")
        mass = summary.get("flowed_mass_kg")
        numbers = f"{runout:8.1f} m {mass / 1e3:8.0f} t" if content and None not in (runout, mass) else f"{'-':>10} {'-':>10}"
        lines.append(f"  {name:20s} {state:20s} {numbers}  {settings}")
    return [f"  {'run':20s} {'made':20s} {'runout':>10} {'flowed':>10}  settings", *lines] if lines else []


def remove(results, name):
    root = folder_of(results, name)
    if not root.exists():
        there = ", ".join(runs_in(results)) or "none"
        print(f"There is no run '{name}' in {results}; there are: {there}", file=sys.stderr)
        return REFUSED
    path = root.with_name(f".{name}.lock")
    if lock.acquire(path, refuse=True) is None:
        return REFUSED
    for folder in (root, root.with_name(f".{name}.before"), root.with_name(f".{name}.refused")):
        shutil.rmtree(folder, ignore_errors=True)
    path.unlink()
    print(f"removed {root}")
    return DONE


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    running = commands.add_parser("run")
    running.add_argument("name")
    running.add_argument("--fem", type=Path, required=True, help="results of the base run")
    running.add_argument("--phase", type=Path, required=True, help="the same, or their folder of another time (T=)")
    running.add_argument("--until", default="report", choices=list(STAGES))
    add_chain_options(running)
    for command in ("list", "remove"):
        part = commands.add_parser(command)
        if command == "remove":
            part.add_argument("name")
        part.add_argument("--results", type=Path, required=True)
    arguments = parser.parse_args()
    if arguments.command == "list":
        print("\n".join(listed(arguments.results)) or f"no named runs in {arguments.results}; make one with RUN=name SET='{what_if.EXAMPLE}'")
        return DONE
    problem = name_problem(arguments.name)
    if problem:
        print(f"RUN: {problem}", file=sys.stderr)
        return REFUSED
    if arguments.command == "remove":
        return remove(arguments.results, arguments.name)
    try:
        settings = what_if.parse(os.environ.get("SET", ""))
        if not settings:
            settings = known_settings(arguments.phase, arguments.name)
            if settings is None:
                raise what_if.SettingError(f"RUN={arguments.name} is new: say what is different in it, SET='{what_if.EXAMPLE}'")
        return run(chain_of(arguments, settings), arguments.fem, arguments.phase, arguments.name, arguments.until)
    except (what_if.SettingError, ValueError, OSError) as error:
        print(error, file=sys.stderr)
        return REFUSED


if __name__ == "__main__":
    sys.exit(main())
