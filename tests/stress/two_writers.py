"""Two runs that write to one folder: the second is told who is there and ends with status 1, and what the first leaves is
what it leaves alone. A killed holder leaves the folder free. Two hand-overs to one file, which takes its name when it is
whole, may run beside each other.

Usage: two_writers.py FEM_STAGE TRANSFER_TOOL MPM_STAGE CASES [TRIALS]
"""
import os
import pathlib
import random
import shutil
import signal
import sys
import tempfile
import time

import chain

trials = int(sys.argv[5]) if len(sys.argv) > 5 else 4
random.seed(14)
pairs = refused = 0


def folder_of(stage):
    return "mpm" if stage == "mpm" else "fem"


with tempfile.TemporaryDirectory() as name:
    sound, tried = pathlib.Path(name) / "sound", pathlib.Path(name) / "tried"
    lasted, wanted = chain.undisturbed(sound)

    for stage in ("geostatic", "shake", "mpm", "transfer"):
        for _ in range(trials):
            shutil.rmtree(tried, ignore_errors=True)
            shutil.copytree(sound, tried)
            first = chain.start(stage, tried)
            time.sleep(random.uniform(0, 0.3) * lasted[stage])
            second = chain.start(stage, tried)
            said = [p.communicate(timeout=300)[1] for p in (first, second)]
            status = sorted((first.returncode, second.returncode))
            pairs += 1
            # One may be over before the other looks.
            allowed = ([0, 0],) if stage == "transfer" else ([0, 1], [0, 0])
            assert status in allowed, f"{stage}: exit statuses {status}\n{said}"
            if status == [0, 1]:
                text = said[0] if first.returncode == 1 else said[1]
                assert "another run writes to this folder (process " in text, text
                refused += 1
            assert chain.results(tried) == wanted, f"{stage}: other results"
            left = [p.name for p in tried.rglob("*") if p.suffix == ".part" or p.name == ".tailrun_lock"]
            assert not left, f"{stage}: left {left}"
    assert refused >= pairs // 3, f"only {refused} of {pairs} met"

    # A holder that is killed; one that is stopped and holds on.
    for stage in ("shake", "mpm"):
        holder = chain.start(stage, tried)
        lock = tried / folder_of(stage) / ".tailrun_lock"
        until = time.perf_counter() + 30
        while not (lock.exists() and lock.read_text()) and time.perf_counter() < until:
            time.sleep(0.002)
        os.kill(holder.pid, signal.SIGSTOP)
        waiting = chain.run(stage, tried)
        assert waiting.returncode == 1 and f"process {holder.pid} on" in waiting.stderr, waiting.stderr
        holder.kill()
        holder.communicate()
        after = chain.run(stage, tried)
        assert after.returncode == 0, f"{stage} after a killed holder: {after.stderr}"
    assert chain.results(tried) == wanted, "other results after killed holders"
print(f"{pairs} pairs, {refused} of them met and one was told so: results as of one run alone")
