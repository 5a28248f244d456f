"""Hands a sweep's missing units to Slurm: one array for each stage that has any (most sweeps: the runouts alone), each after the one
before it, and a last job that gathers.

An array's task computes its own line of units.jsonl, or several where the cluster's MaxArraySize is smaller. Arrays depend on each
other by `afterany`: a member whose earlier stage failed says so itself, and the others go on.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import paths  # noqa: F401
from stage import read_json, write_json


class Refused(Exception):
    """What Slurm said."""


def ask(*words):
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=120)
    except FileNotFoundError:
        raise Refused(f"{words[0]} is not on this machine: SUBMIT=slurm is for a machine that submits to a Slurm cluster") from None
    except subprocess.TimeoutExpired:
        raise Refused(f"{words[0]} has not answered within two minutes") from None
    if done.returncode != 0:
        raise Refused(f"{words[0]}: {done.stderr.strip() or f'exit status {done.returncode}'}")
    return done.stdout


def most_tasks():
    """Tasks that an array may have; their numbers stay below MaxArraySize."""
    found = re.search(r"MaxArraySize\s*=\s*(\d+)", ask("scontrol", "show", "config"))
    return max(int(found.group(1)) - 1, 1) if found else 1000


def still_queued(folder):
    """Words about jobs of an earlier submission that have not ended; "" when there are none."""
    jobs = (read_json(Path(folder) / "slurm.json") or {}).get("jobs", [])
    if not jobs or not shutil.which("squeue"):
        return ""
    try:
        left = [line.split() for line in ask("squeue", "--noheader", "--array", "--format=%A %T %F").splitlines() if line.strip()]
    except Refused:
        return ""
    mine = [state for _, state, job in left if job in jobs]
    if not mine:
        return ""
    states = ", ".join(f"{mine.count(state)} {state.lower()}" for state in sorted(set(mine)))
    return (f"{folder}: an earlier submission has not ended: {states} (job {', '.join(jobs)}). It gathers when it has; to begin anew first: "
            f"scancel {' '.join(jobs)}")


def submit_job(folder, name, text, after, options):
    """Queues a script; returns the job's number."""
    path = Path(folder) / "slurm" / f"{name}.sh"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    words = ["sbatch", "--parsable", f"--job-name={Path(folder).name}-{name}", f"--chdir={Path.cwd()}", "--open-mode=append",
             f"--output={path.with_suffix('.log').resolve()}", *([f"--dependency=afterany:{after}"] if after else []), *options,
             *shlex.split(os.environ.get("SBATCH_OPTIONS", "")), str(path)]
    return ask(*words).strip().split(";")[0]


def submit(arguments, folder, units, command, threads, gather):
    """Exit status. Nothing stays queued of a submission that is refused half-way."""
    jobs, after = [], ""
    try:
        limit = most_tasks() if units else 1
        begun = 0
        for stage in dict.fromkeys(unit.stage for unit in units):
            count = sum(1 for unit in units if unit.stage == stage)
            every = -(-count // limit)
            tasks = -(-count // every)
            line = f"{command} --line $(({begun} + ($SLURM_ARRAY_TASK_ID - 1) * {every} + 1)) --every {every} --last {begun + count}"
            after = submit_job(folder, stage, f"#!/bin/sh\nexec {line}\n", after, [f"--array=1-{tasks}", f"--cpus-per-task={threads}"])
            jobs.append(after)
            print(f"  job {after}: {tasks} task{'s' if tasks > 1 else ''}, {count} x {stage}, {threads} core{'s' if threads > 1 else ''} each")
            begun += count
        jobs.append(submit_job(folder, "gather", f"#!/bin/sh\nexec {gather}\n", after, []))
        print(f"  job {jobs[-1]}: gathers into {folder}")
    except Refused as problem:
        for job in jobs:
            subprocess.run(["scancel", job], capture_output=True)
        print(f"Slurm has not taken the sweep: {problem}\nNothing of it is queued, and nothing that was computed is lost. The same command tries again; "
              "without SUBMIT=slurm it computes here.", file=sys.stderr)
        return 1
    write_json(folder / "slurm.json", {"jobs": jobs})
    print(f"Followed by: squeue --job={','.join(jobs)}; the same command queues what is missing, with RETRY=1 what failed, too, and nothing else")
    return 0
