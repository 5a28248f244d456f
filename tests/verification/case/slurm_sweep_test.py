"""SUBMIT=slurm on a Slurm started for the test: one array for each stage, the table of the sweep that make computes to the bit, the missing alone
queued again, members shared out where arrays are short, and a queue that refuses. Skipped (77) where Slurm is not installed.

Usage: slurm_sweep_test.py SOURCE_FOLDER
"""

import copy
import shutil
import subprocess
import sys
import tempfile

import local_slurm
from stand_in_chain import FACTORS, Clone

if local_slurm.lacking():
    print(f"skipped: Slurm is not installed (packages slurm-wlm and munge); missing: {', '.join(local_slurm.lacking())}")
    sys.exit(77)

MOTIONS = {"design": "grid", "parameters": {"peak": {"key": "fem:/shake/peak_acceleration", "values": [2.0, 2.5, 60.0]}, **FACTORS["parameters"]}}

with tempfile.TemporaryDirectory() as name:
    here, there = Clone(f"{name}/here", sys.argv[1], 3.0), Clone(f"{name}/there", sys.argv[1], 3.0)

    def sweep(content):
        here.sweep_file(content), there.sweep_file(content)

    def table(clone, file="members.csv"):
        return (clone.out / "sweeps" / "sweep" / file).read_bytes()

    # Programs are part of a member's key: both clones call the same ones.
    for program in ("fem_stage", "transfer_tool", "mpm_stage"):
        shutil.copy2(here.root / "bin" / program, there.root / "bin" / program)
    there.log = here.log

    with local_slurm.running(f"{name}/slurm", most=6) as environment:
        there.environment = {**there.environment, **environment}

        def said(*words):
            return subprocess.run(words, env=environment, capture_output=True, text=True).stdout

        def submit(*words):
            """What make said, and what was computed."""
            result, _ = there.make("sweep-files", "SUBMIT=slurm", *words, status=0)
            local_slurm.wait_for(lambda: not said("squeue", "--noheader").strip(), lambda: said("squeue"), 120)
            return result, sorted(line for line in there.log.read_text().split("\n") if line)

        sweep(FACTORS)
        here.make("sweep-files", "-j2", status=0)
        result, ran = submit()
        assert result.stdout.count("  job ") == 6 and "4 tasks, 4 x mpm" in result.stdout, result.stdout
        assert len(ran) == 8 and table(here) == table(there) and table(here, "members.h5") == table(there, "members.h5"), (ran, result.stdout)

        # What is new is queued, with RETRY=1 what failed, too, in one array; the rest is not.
        grown = copy.deepcopy(FACTORS)
        grown["parameters"]["factor"]["values"] += [4.0, 1.5]
        sweep(grown)
        here.make("sweep-files", status=2)
        for retry in ((), ("RETRY=1",)):
            result, ran = submit(*retry)
            assert ran[-1].endswith("=4.0") and result.stdout.count("  job ") == 2, (ran, result.stdout)
        assert table(here) == table(there) and b"energy grows" in table(there, "failed.csv")

        # Stages one after another; eight members in four tasks of two (MaxArraySize 6 allows five tasks).
        sweep(MOTIONS)
        here.make("sweep-files", "-j2", status=2)
        result, ran = submit()
        assert "2 tasks, 2 x shake" in result.stdout and "4 tasks, 8 x mpm" in result.stdout, result.stdout
        assert table(here) == table(there) and table(there).count(b"failed") == 4, table(there).decode()

        # While it is queued nothing is queued twice; a queue that refuses changes nothing.
        more = copy.deepcopy(FACTORS)
        more["parameters"]["factor"]["values"] += [1.6, 1.7]
        sweep(more)
        said("scontrol", "update", "PartitionName=main", "State=INACTIVE")
        before = table(there)
        result, _ = there.make("sweep-files", "SUBMIT=slurm", status=2)
        assert "Slurm has not taken the sweep" in result.stderr and "nothing that was computed is lost" in result.stderr, result.stderr
        assert before == table(there) and not said("squeue", "--noheader").strip()
        said("scontrol", "update", "PartitionName=main", "State=DOWN")  # takes jobs and starts none
        there.make("sweep-files", "SUBMIT=slurm", status=0)
        again = there.make("sweep-files", "SUBMIT=slurm", status=2)[0].stderr
        assert "has not ended: " in again and "pending" in again and "scancel" in again, again
        said("scontrol", "update", "PartitionName=main", "State=UP")
        local_slurm.wait_for(lambda: not said("squeue", "--noheader").strip(), lambda: said("squeue"), 120)
        assert table(there).count(b"done") == 6
    there.environment["PATH"] = str(there.root / "tools")
    (there.root / "tools").mkdir()
    for tool in ("make", "sh", "bash", "sed", "awk", "head", "grep", "tr", "nproc", "find", "sort", "env", "dirname"):
        (there.root / "tools" / tool).symlink_to(shutil.which(tool))
    more["parameters"]["factor"]["values"] += [1.8]
    sweep(more)
    assert "is not on this machine" in there.make("sweep-files", "SUBMIT=slurm", status=2)[0].stderr
print("the same table from Slurm")
