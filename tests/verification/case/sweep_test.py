"""make sweep: each member once, only the new ones of a grown sweep, a failed one named while the rest finish and tried again when asked, going on after a
kill, no more kept than numbers, and nothing that no sweep refers to after make prune.

Usage: sweep_test.py SOURCE_FOLDER
"""

import copy
import csv
import os
import signal
import subprocess
import sys
import tempfile
import time

import h5py
import numpy as np
from stand_in_chain import FACTORS, Clone

FACTOR = "mpm_stage run /residual_strength/factor="

with tempfile.TemporaryDirectory() as name:
    clone = Clone(f"{name}/clone", sys.argv[1], fails_above=3.0)
    folder, store = clone.out / "sweeps" / "sweep", clone.out / "store"

    def table():
        return list(csv.DictReader((folder / "members.csv").open()))

    assert "docs/what_if.md" in clone.make("sweep-files", status=2)[0].stderr
    clone.sweep_file(FACTORS)
    result, ran = clone.make("sweep-files", "-j2", "-n", status=0)
    assert ran == [] and not folder.exists() and "4 members, 0 there already; to compute:" in result.stdout and "4 x mpm" in result.stdout, result.stdout
    result, ran = clone.make("sweep-files", "-j2", status=0)
    assert ran == sorted(["fem_stage mesh", "fem_stage geostatic", "fem_stage shake", "transfer_tool run", *(f"{FACTOR}{f}" for f in (0.5, 0.75, 1.25, 2.0))]), ran
    assert "2 at a time" in result.stdout and "4 of 4 members done" in result.stderr, (result.stdout, result.stderr)
    assert [float(row["runout_m"]) for row in table()] == [20, 13.3333333333, 8, 5] and {row["state"] for row in table()} == {"done"}
    with h5py.File(folder / "members.h5") as file:
        assert file["numbers/runout_m"].attrs["unit"] == b"m" and np.allclose(file["numbers/runout_m"], [20, 40 / 3, 8, 5])
        assert list(file["parameters/factor"]) == [0.5, 0.75, 1.25, 2.0]
    for picture in ("exceedance", "scatter"):
        assert (folder / f"{picture}.png").stat().st_size > 5000, picture
    member = next(store.glob("mpm-*"))
    assert sorted(p.name for p in member.iterdir()) == ["front.csv", "member.json"], "a member keeps its numbers and no more"
    before = (folder / "members.csv").read_bytes(), (folder / "members.h5").read_bytes()
    assert clone.make("sweep-files", "-j2", status=0)[1] == [] and before == ((folder / "members.csv").read_bytes(), (folder / "members.h5").read_bytes())

    # A grown sweep computes what is new; what fails is named, and the rest finishes.
    grown = copy.deepcopy(FACTORS)
    grown["parameters"]["factor"]["values"] = [0.5, 4.0, 1.5, -1.0, 2.0]
    clone.sweep_file(grown)
    result, ran = clone.make("sweep-files", "-j", status=2)
    assert ran == [f"{FACTOR}{f}" for f in (-1.0, 1.5, 4.0)], ran
    assert [row["state"] for row in table()] == ["done", "failed", "done", "failed", "done"]
    assert "member 2: mpm: [error] mpm_stage: the computation failed: energy grows at particle 7" in result.stderr, result.stderr
    assert "a number above 0 is allowed" in result.stderr and "3 of 5 members done, 2 failed" in result.stdout, (result.stdout, result.stderr)
    assert [row["member"] for row in csv.DictReader((folder / "failed.csv").open())] == ["2", "4"]
    result, ran = clone.make("sweep-files", status=2)
    assert ran == [] and "2 failed before (RETRY=1 tries them again)" in result.stdout and "energy grows at particle 7" in result.stderr, (ran, result.stdout)
    assert clone.make("sweep-files", "RETRY=1", status=2)[1] == [f"{FACTOR}{f}" for f in (-1.0, 4.0)], "the failed ones alone are tried again"

    # Stages before the runout: shared ones once, others go with their member; a failed one is the reason of all that need it.
    shaken = {"design": "grid", "parameters": {"peak": {"key": "fem:/shake/peak_acceleration", "values": [2.0, 60.0]}, **copy.deepcopy(FACTORS["parameters"])}}
    shaken["parameters"]["factor"]["values"] = [0.5, 0.75]
    clone.sweep_file(shaken)
    result, ran = clone.make("sweep-files", "-j3", status=2)
    assert ran.count("fem_stage shake /shake/peak_acceleration=2.0") == 1 and ran.count("fem_stage shake /shake/peak_acceleration=60.0") == 1, ran
    assert len(ran) == 5 and "members 3, 4" in result.stderr.replace("member 3", "members 3") and "the mesh folds up" in result.stderr, (ran, result.stderr)
    clone.sweep_file({"design": "grid", "parameters": {"peak": {"key": "fem:/shake/peak_acceleration", "values": [4.0]}}})
    kept = set(store.glob("shake-*"))
    assert len(clone.make("sweep-files", status=0)[1]) == 3 and set(store.glob("shake-*")) == kept, "a shaking that one member has goes with it"

    # What no sweep refers to any more goes, and nothing else.
    members = lambda: {path.parent.name for path in store.glob("mpm-*/member.json")}  # noqa: E731
    clone.sweep_file(FACTORS, "other")
    clone.make("sweep-files", "SWEEP=other", status=0)
    before = len(members())
    held = subprocess.Popen([sys.executable, "cases/run/lock.py", str(folder / ".lock"), "--", "sleep", "30"], cwd=clone.root)
    while not (folder / ".lock").exists() or "process" not in (folder / ".lock").read_text():
        time.sleep(0.02)
    time.sleep(0.2)
    assert "nothing is removed" in clone.make("prune", status=2)[0].stderr and len(members()) == before
    held.kill()
    held.wait()
    result, _ = clone.make("prune", status=0)
    assert before > 5 and len(members()) == 5 and "which 2 sweeps refer to" in result.stdout, (before, result.stdout)
    assert clone.make("sweep-files", status=0)[1] == clone.make("sweep-files", "SWEEP=other", status=0)[1] == []

    # Killed half-way, softly and hard, it goes on with what is missing; a member that was interrupted resumes.
    many = copy.deepcopy(FACTORS)
    many["parameters"]["factor"]["values"] = [0.5 + 0.01 * k for k in range(1, 21)]
    clone.sweep_file(many)
    (clone.root / "slow").write_text("0.8")
    called = ""
    for number, kill in ((signal.SIGTERM, os.kill), (signal.SIGTERM, os.killpg), (signal.SIGKILL, os.killpg)):
        called += clone.log.read_text()
        clone.log.write_text("")
        process = subprocess.Popen(clone.command("sweep-files", "-j2"), cwd=clone.root, env=clone.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   start_new_session=True)
        done = len(list(store.glob("mpm-*/member.json")))
        while process.poll() is None:  # until two are done and another one runs
            new = len(list(store.glob("mpm-*/member.json"))) - done
            if new >= 2 and clone.log.read_text().count("mpm_stage") > new:
                break
            time.sleep(0.02)
        time.sleep(0.1)
        kill(process.pid, number)
        process.communicate()
        assert process.returncode != 0
        if number == signal.SIGTERM:
            assert len(list(store.glob("mpm-*/*/mpm/checkpoint.h5"))) >= 1, "the programs were told to stop"
    there = {row for row in store.glob("mpm-*/member.json")}
    (clone.root / "slow").unlink()
    result, ran = clone.make("sweep-files", "-j2", status=0)
    assert 1 <= len(ran) <= 14 and "--resume" in called and len(table()) == 20 and {row["state"] for row in table()} == {"done"}, ran
    assert not [p for p in store.glob("mpm-*/work") if (p.parent / "member.json").exists()], "what a killed member left is gone"

    # A full disk: said, nothing under a final name, and it goes on when there is room.
    def small_files():
        import resource

        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (40000, 40000))

    full = copy.deepcopy(FACTORS)
    full["parameters"]["factor"]["values"] = [0.9, 0.95]
    clone.sweep_file(full)
    result, _ = clone.make("sweep-files", status=2, preexec_fn=small_files)
    assert "File too large" in result.stderr and "0 of 2 members done, 2 failed" in result.stdout, (result.stdout, result.stderr)
    assert clone.make("sweep-files", status=2)[1] == [] and len(clone.make("sweep-files", "RETRY=1", status=0)[1]) == 2
print("each member once")
