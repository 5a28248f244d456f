"""Every command of docs/what_if.md runs as it stands there, from a clone: on programs that stand in for the real ones, and for the
compiler's.

Usage: what_if_walk_test.py SOURCE_FOLDER
"""

import contextlib
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

import local_slurm
from stand_in_chain import Clone

source = pathlib.Path(sys.argv[1])
text = (source / "docs" / "what_if.md").read_text()
commands = re.findall(r"^make -f Makefile\.cases .*$", text, re.MULTILINE) + re.findall(r"`(make -f Makefile\.cases [^`]*)`", text)
assert len(commands) >= 8, commands

with tempfile.TemporaryDirectory() as name, contextlib.ExitStack() as stack:
    clone = Clone(f"{name}/clone", source)
    shutil.copy(source / "cases" / "check_packages.sh", clone.root / "cases")
    case = clone.root / "cases" / "mochikoshi"
    shutil.copytree(clone.case, case)
    for file in ("sweep.json", "mpm.json"):
        shutil.copy(source / "cases" / "mochikoshi" / file, case)
    for script in ("fem_figures", "mpm_figures", "report"):
        (clone.root / "cases" / "plot" / f"{script}.py").write_text("")
    for tool in ("cmake", "ninja"):
        path = clone.root / "tools" / tool
        path.parent.mkdir(exist_ok=True)
        path.write_text("#!/bin/sh\n")
        path.chmod(0o755)
    (clone.root / "build").mkdir()
    environment = clone.environment
    if not local_slurm.lacking():
        environment = {**environment, **stack.enter_context(local_slurm.running(f"{name}/slurm"))}
    environment["PATH"] = f"{clone.root / 'tools'}:{environment['PATH']}"
    for command in commands:
        if "SUBMIT=slurm" in command and local_slurm.lacking():
            print(f"left out, for Slurm is not installed: {command}")
            continue
        words = [*shlex.split(command), "BIN=bin", "PACKAGES=skip", f"PYTHON={sys.executable}"]
        done = subprocess.run(words, cwd=clone.root, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, (command, done.stdout, done.stderr)
        if "SUBMIT=slurm" in command:
            local_slurm.wait_for(lambda: not subprocess.run(["squeue", "--noheader"], env=environment, capture_output=True).stdout.strip(),
                                 lambda: "the jobs have not ended", 240)
    out = clone.root / "out" / "mochikoshi-coarse"
    assert (out / "compare" / "base+weak+smooth_bed" / "compare.html").exists() and (out / "uncertainty.json").exists()
    assert (out / "sweeps" / "sweep" / "members.csv").read_text().count("done") == 24
print(f"{len(commands)} commands of docs/what_if.md run")
