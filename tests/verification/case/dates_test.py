"""Makefile.cases reruns what depends on a changed input and nothing else. The programs are replaced by scripts that write
the files that the real ones write and note that they ran.

Usage: dates_test.py SOURCE_FOLDER
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

source = pathlib.Path(sys.argv[1])
PROGRAM = """#!/bin/sh
log={log}
name=$(basename "$0")
echo "$name $1" >>"$log"
command=$1
shift
while [ $# -gt 0 ]; do [ "$1" = -o ] && out=$2; shift; done
case "$name $command" in
  "fem_stage mesh") mkdir -p "$out"; touch "$out/mesh.msh" ;;
  "fem_stage geostatic") touch "$out/geostatic.h5" ;;
  "fem_stage shake") touch "$out/snapshot_t08.000.h5" "$out/snapshot_t04.000.h5" ;;
  "transfer_tool run") touch "$out" ;;
  "mpm_stage run") mkdir -p "$out/frames" ;;
esac
"""

with tempfile.TemporaryDirectory() as name:
    root = pathlib.Path(name) / "a clone"
    root = pathlib.Path(str(root).replace(" ", "_"))
    (root / "cases").mkdir(parents=True)
    shutil.copy(source / "Makefile.cases", root)
    shutil.copy(source / "cases" / "case_part.py", root / "cases")
    shutil.copytree(source / "cases" / "run", root / "cases" / "run")
    shutil.copytree(source / "cases" / "template", root / "cases" / "dam")
    log = root / "log"
    for program in ("fem_stage", "transfer_tool", "mpm_stage"):
        path = root / "bin" / program
        path.parent.mkdir(exist_ok=True)
        path.write_text(PROGRAM.format(log=log))
        path.chmod(0o755)
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("MAKE", "MFLAGS"))}

    def run(*options):
        """Stages that a call of make ran, in order."""
        log.write_text("")
        command = ["make", "-f", "Makefile.cases", "mpm-files", "CASE=dam", "BIN=bin", f"PYTHON={sys.executable}", *options]
        result = subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True)
        return result, [line.split()[1] if line.startswith("fem") else line.split()[0] for line in log.read_text().split("\n") if line]

    def change(file, pattern=None, replacement=None):
        time.sleep(0.02)
        path = root / "cases" / "dam" / file
        text = path.read_text()
        if pattern:
            changed = re.sub(pattern, replacement, text, count=1)
            assert changed != text, (file, pattern)
            text = changed
        path.write_text(text)

    def expect(what, stages, *options):
        result, ran = run(*options)
        assert result.returncode == 0, (what, result.stderr)
        assert ran == stages, f"{what}: ran {ran}, expected {stages}"

    everything = ["mesh", "geostatic", "shake", "transfer_tool", "mpm_stage"]
    expect("from nothing", everything, "-j4")
    expect("again", [])
    change("mpm.json")
    expect("mpm.json touched", ["mpm_stage"])
    change("transfer.json")
    expect("transfer.json touched", everything[3:])
    change("motion.csv")
    expect("motion touched", everything[2:])
    change("fem.json", r'"peak_acceleration": [0-9.]+', '"peak_acceleration": 3.0')
    expect("motion scaled otherwise", everything[2:])
    change("fem.json", r'"K0": [0-9.]+', '"K0": 0.6')
    expect("geostatic stage changed", everything[1:])
    change("template.geo")
    expect("geometry touched", everything)
    expect("another transfer time", everything[3:], "T=4")
    expect("the case's own time again", [], "T=8")
    expect("another size", everything, "SIZE=coarse")
    expect("dry run", [], "-n")

    result, ran = run("T=5")
    assert result.returncode != 0 and "snapshot_t05.000.h5" in result.stderr and ran == [], result.stderr
