"""Members of a sweep are known by what they are computed from: motions of a folder by their content, whole JSON values, base and named runs that have the
same, and a case that changes between plan and computation.

Usage: sweep_inputs_test.py SOURCE_FOLDER
"""

import json
import re
import shlex
import subprocess
import sys
import tempfile

from stand_in_chain import FACTORS, Clone

with tempfile.TemporaryDirectory() as name:
    clone = Clone(f"{name}/clone", sys.argv[1])
    (clone.root / "cases" / "plot" / "print_summary.py").write_text("")
    folder = clone.out / "sweeps" / "sweep"
    clone.make("mpm-files", status=0)

    # Motions: what the base run has is not computed again, nor what only changed its name.
    motions = clone.case / "motions"
    motions.mkdir()
    for letter in "ab":
        (motions / f"{letter}.csv").write_text(f"time_s,acceleration_m_s2\n0,{ord(letter)}\n1,0\n")
    clone.sweep_file({"design": "grid", "parameters": {"motion": {"key": "fem:/shake/motion", "folder": "motions", "pattern": "*.csv"}}})
    _, ran = clone.make("sweep-files", "-j2", status=0)
    assert [line.split(" /")[0] for line in ran] == ["fem_stage shake"] * 2 + ["mpm_stage run"] * 2 + ["transfer_tool run"] * 2, ran
    assert "fem_stage shake /shake/motion=\"motions/a.csv\"" in ran, ran
    (motions / "b.csv").write_text("time_s,acceleration_m_s2\n0,7\n1,0\n")
    _, ran = clone.make("sweep-files", status=0)
    assert len(ran) == 3 and all("a.csv" not in line for line in ran), ran

    # Whole values, and a shaking that a named run has.
    _, ran = clone.make("named", "UNTIL=transfer", "RUN=loud", "SET=fem:/shake/peak_acceleration=3", status=0)
    clone.sweep_file({"design": "grid", "parameters": {
        "peak": {"key": "fem:/shake/peak_acceleration", "values": [3.0]},
        "strength": {"key": "mpm:/residual_strength", "values": [{"factor": 0.5}, {"factor": 0.6}]}}})
    result, ran = clone.make("sweep-files", status=0)
    assert ran == ['mpm_stage run /residual_strength={"factor": 0.5}', 'mpm_stage run /residual_strength={"factor": 0.6}'], ran

    # A case that changes after the sweep was planned: its members are not what was asked for.
    clone.sweep_file(FACTORS)
    clone.make("sweep-files", status=0)
    command = re.search(r"@exec (.*)", (folder / "units.mk").read_text()).group(1).replace("--failures-told ", "")
    for member in (clone.out / "store").glob("mpm-*/member.json"):
        member.unlink()
    case = json.loads((clone.case / "mpm.json").read_text().split("\n", 1)[1])
    (clone.case / "mpm.json").write_text(json.dumps({**case, "time": {"end": 21.0}}))
    done = subprocess.run(shlex.split(command), cwd=clone.root, env=clone.environment, capture_output=True, text=True)
    failed = [json.loads(path.read_text())["reason"] for path in (clone.out / "store").glob("mpm-*/failed.json")]
    assert done.returncode == 2 and failed == ["the case or a program has changed since the sweep was planned; make sweep once more"], (done, failed)
    assert len(clone.make("sweep-files", status=0)[1]) == 4, "the changed case has members of its own"
print("members are known by their inputs")
