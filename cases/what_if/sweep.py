#!/usr/bin/env python3
"""A sweep over what sweep.json varies: computes the members that are missing, by make or as Slurm's arrays, and gathers all.

    sweep.py run --design cases/dam/sweep.json --fem out/dam --phase out/dam --case cases/dam --bin build/bin
    sweep.py run --submit slurm ...          queues them instead; a last job gathers
    sweep.py gather ...                      table and pictures of what is there

make's own -j says how many members are computed at a time (-j alone: as the cores and the scene's size allow); SBATCH_OPTIONS of the
environment goes to sbatch, RETRY=1 tries members again that have failed.
"""

import argparse
import hashlib
import json
import os
import re
import shlex
import sys
from pathlib import Path

import paths  # noqa: F401
import ensemble
import gather
import lock
import plan
import progress
import slurm
from design import read_design
from json_keys import DesignError
from settings import SettingError
from stage import add_chain_options, chain_of, read_json, write_json
from stages import call

PARTICLES_PER_THREAD = 50000  # fewer: one thread each, and as many members at a time as there are cores


def jobs_asked(flags):
    """The number behind make's -j: 1 without one, 0 for -j alone."""
    flags = flags.split(" -- ")[0]
    found = re.search(r"(?:^|\s)-j\s*(\d*)(?=\s|$)", f" {flags}") or re.search(r"(?:^|\s)--jobs(?:=(\d+))?(?=\s|$)", f" {flags}")
    return 1 if found is None else int(found.group(1) or 0)


def only_says(flags):
    """Whether make was called with -n (--dry-run, --just-print): then what is missing is said, and nothing computed or written."""
    first = flags.split(" ")[0]
    return not first.startswith("-") and "n" in first and "=" not in first


def share(missing, particles, cores, asked, memory=1.0, each=0.0, own=0):
    """(units at a time, threads of each) for `missing` members: as many at a time as make was asked for, or as the cores and the memory
    have room for (`memory` free, `each` of one run, in one unit). Cores that are left over go to the units, unless their threads are
    given (`own`)."""
    threads = own or min(max(particles // PARTICLES_PER_THREAD, 1), cores)
    room = int(min(memory / each, cores)) if each > 0.0 else cores
    jobs = asked or max(min(cores // threads, room), 1)
    jobs = max(min(jobs, missing), 1)
    return jobs, own or max(cores // jobs, 1)


def scene_of(arguments, members, store):
    """(particles, MB of memory of one run), as the base run's or an earlier member's summary says; zeros when nothing is known yet."""
    summaries = [arguments.phase / "mpm" / "summary.json"]
    summaries += [plan.folder_of(store, "mpm", member.key) / "member.json" for member in members if plan.is_done(store, member.key)][:1]
    known = next((content for content in map(read_json, summaries) if content and content.get("particles")), {})
    return int(known.get("particles", 0)), float(known.get("peak_memory_MB") or 0.0)


def free_memory():
    """MB that the system can give without swapping; without end where it does not say."""
    try:
        return int(re.search(r"MemAvailable:\s*(\d+) kB", Path("/proc/meminfo").read_text()).group(1)) / 1024.0
    except (OSError, AttributeError):
        return float("inf")


def retry_asked():
    return os.environ.get("RETRY", "") not in ("", "0", "no", "off")


def unit_command(arguments, store, folder, threads):
    """The words that compute a line of the table; '--line N' is to be added."""
    words = [arguments.python, Path(__file__).resolve().parent / "unit.py", "--folder", folder, "--store", store, "--fem", arguments.fem,
             "--phase", arguments.phase, "--case", arguments.case, "--bin", arguments.bin, "--size", arguments.size, "--threads", threads]
    words += ["--time", arguments.time] if arguments.time else []
    words += ["--trust-geometry"] if arguments.trust_geometry else []
    return shlex.join(map(str, words))


def write_rules(path, units, lines, command):
    """Rules for make: a unit comes after those whose results it reads. Failures are told by files, so that the rest goes on; an
    interruption ends all. `exec`, so that make's signals reach the unit and no shell in between."""
    rules = [f".PHONY: all {' '.join(f'unit{line}' for line in lines.values())}", "all: " + " ".join(f"unit{line}" for line in lines.values())]
    for unit in units:
        line = lines[unit.stage, unit.key]
        rules.append(f"unit{line}: {' '.join(f'unit{lines[name]}' for name in unit.after if name in lines)}")
        rules.append(f"\t@exec {command.replace('$', '$$')} --failures-told --line {line}")
    path.write_text("\n".join(rules) + "\n")


def input_of(base, members):
    """SHA-256 of all that the members depend on but the size: sweeps of one case at two sizes are of one input when it is the same."""
    records = [{key: value for key, value in base.record(name).items() if key not in ("size", "after", "key")} for name in base.names("mpm")]
    return hashlib.sha256(json.dumps([records, [member.settings for member in members]], sort_keys=True).encode()).hexdigest()


def write_plan(folder, design, members, arguments):
    write_json(folder / "plan.json", {
        "title": design.title, "case": str(arguments.case), "size": arguments.size, "time": arguments.time, "design": design.kind,
        "batches": design.batches, "seed": design.seed, "store": str(arguments.fem / "store"), "reference": design.reference,
        "curves": design.curves, "input": input_of(chain_of(arguments), members),
        "parameters": [{"name": p.name, "keys": p.keys, "base": p.base_value(), "scales": p.scales, "numeric": p.numeric, "choices": p.choices,
                        "labels": p.labels, "axis": p.axis} for p in design.parameters],
        "members": [{"number": m.number, "values": m.values, "settings": m.settings, "keys": m.keys} for m in members]})


def say_missing(folder, members, store, units):
    missing = sum(1 for unit in units if unit.stage == "mpm")
    stages = {stage: sum(1 for unit in units if unit.stage == stage) for stage in dict.fromkeys(unit.stage for unit in units)}
    failed = len({member.key for member in members if plan.has_failed(member, store)})
    print(f"{folder}: {len(members)} members, {len({m.key for m in members}) - missing - failed} there already"
          + (f", {failed} failed before (RETRY=1 tries them again)" if failed else "")
          + (f"; to compute: {', '.join(f'{count} x {stage}' for stage, count in stages.items())}" if units else ""), flush=True)


def run(arguments, design, folder):
    store = arguments.fem / "store"
    busy = slurm.still_queued(folder)
    if busy:
        print(busy, file=sys.stderr)
        return 1
    base = chain_of(arguments)
    members = plan.members_of(design, base)
    if only_says(os.environ.get("MAKEFLAGS", "")):
        say_missing(folder, members, store, plan.units_of(members, store, arguments.fem, arguments.phase))
        return 0
    for member in members:
        if plan.is_done(store, member.key):
            plan.tidy(store, member.key)
    if retry_asked():
        plan.forget_failures(members, store)
    units = plan.units_of(members, store, arguments.fem, arguments.phase)
    folder.mkdir(parents=True, exist_ok=True)
    write_plan(folder, design, members, arguments)
    say_missing(folder, members, store, units)
    missing = sum(1 for unit in units if unit.stage == "mpm")
    lines = plan.write_table(folder / "units.jsonl", units)
    cores = len(os.sched_getaffinity(0))
    particles, memory = scene_of(arguments, members, store)
    own = int(arguments.threads or 0)
    if arguments.submit == "slurm":
        threads = own or max(particles // PARTICLES_PER_THREAD, 1)
        progress.begin(folder, [unit.stage for unit in units], len(members), 1)
        return slurm.submit(arguments, folder, units, unit_command(arguments, store, folder, threads), threads, gather_command(arguments))
    status = 0
    if units:
        jobs, threads = share(missing, particles, cores, jobs_asked(os.environ.get("MAKEFLAGS", "")), free_memory(), memory, own)
        print(f"{jobs} at a time, {threads} thread{'s' if threads > 1 else ''} each", flush=True)
        progress.begin(folder, [unit.stage for unit in units], len(members), jobs)
        write_rules(folder / "units.mk", units, lines, unit_command(arguments, store, folder, threads))
        for name in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL"):
            os.environ.pop(name, None)
        status = call(["make", "--no-builtin-rules", "--no-print-directory", "-f", str(folder / "units.mk"), f"-j{jobs}", "all"])
    if status != 0:
        print(f"{folder}: interrupted; the same command goes on", file=sys.stderr)
        return 2
    return finish(arguments, folder)


def finish(arguments, folder):
    """Table and pictures; an ensemble's spread too."""
    try:
        status = gather.gather(folder)
        if arguments.ensemble:
            status = max(status, ensemble.write_uncertainty(folder, arguments.fem, arguments.phase, chain_of(arguments)))
        return status
    except OSError as error:
        print(f"{folder}: table and pictures cannot be made: {error}\nThe members that are done are kept; the same command goes on.", file=sys.stderr)
        return 2


def gather_command(arguments):
    words = [arguments.python, Path(__file__).resolve(), "gather", "--design", arguments.design, "--fem", arguments.fem, "--phase", arguments.phase,
             "--case", arguments.case, "--bin", arguments.bin, "--size", arguments.size]
    words += ["--time", arguments.time] if arguments.time else []
    words += ["--ensemble"] if arguments.ensemble else []
    return shlex.join(map(str, words))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=("run", "gather"))
    parser.add_argument("--design", type=Path, required=True, help="the sweep's file")
    parser.add_argument("--ensemble", action="store_true", help="without that file: runs that differ in nothing physical (ensemble.py)")
    parser.add_argument("--submit", choices=("", "slurm"), default="")
    parser.add_argument("--fem", type=Path, required=True)
    parser.add_argument("--phase", type=Path, required=True)
    add_chain_options(parser)
    arguments = parser.parse_args()
    arguments.python = sys.executable
    folder = arguments.phase / "sweeps" / arguments.design.stem
    try:
        if arguments.command == "gather":
            return finish(arguments, folder)
        own = not arguments.ensemble or arguments.design.exists()
        design = read_design(arguments.design, arguments.case) if own else ensemble.design_for(arguments.case)
        if only_says(os.environ.get("MAKEFLAGS", "")):
            return run(arguments, design, folder)
        held = lock.acquire(folder / ".lock", refuse=os.environ.get("WAIT") == "0")
        return 1 if held is None else run(arguments, design, folder)
    except (DesignError, SettingError, ValueError, OSError) as error:
        print(error, file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
