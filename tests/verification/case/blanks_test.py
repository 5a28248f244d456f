"""Makefile.cases refuses paths with blanks: `make clean OUT="/x/a b"` had removed the folder /x/a.

Usage: blanks_test.py SOURCE_FOLDER
"""

import pathlib
import subprocess
import sys
import tempfile

source = pathlib.Path(sys.argv[1])
with tempfile.TemporaryDirectory() as folder:
    kept = pathlib.Path(folder) / "a"
    kept.mkdir()
    (kept / "results.csv").write_text("mine")
    for target in ("clean", "distclean", "smoke"):
        for option in ("OUT", "BUILD", "CASE"):
            run = subprocess.run(["make", "-f", "Makefile.cases", target, f"{option}={kept} b", "PACKAGES=skip"],
                                 cwd=source, capture_output=True, text=True)
            if run.returncode == 0 or "blank" not in run.stderr:
                sys.exit(f"make {target} {option}='... b' was not refused: {run.stdout}{run.stderr}")
    if not (kept / "results.csv").exists():
        sys.exit("a folder that is none of make's was removed")
print("paths with blanks are refused")
