"""Makefile.cases reads T=16.5 as sixteen and a half wherever it runs: with a decimal comma in the environment, awk had read
16, said that there is nothing to do, and left the results of 16 s standing for those of 16.5 s.

Usage: locale_test.py SOURCE_FOLDER
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

source = pathlib.Path(sys.argv[1])


def phase(environment, **options):
    """The folder of a hand-over time's results, as make works it out."""
    run = subprocess.run(["make", "-f", "Makefile.cases", "-pn", "PACKAGES=skip", "list"]
                         + [f"{key}={value}" for key, value in options.items()],
                         cwd=source, env=environment, capture_output=True, text=True)
    lines = [line for line in run.stdout.split("\n") if line.startswith("PHASE :=")]
    return (lines[0].split(":=")[1].strip() if lines else None), run.stderr


def with_decimal_comma(folder):
    """An environment whose C library writes 16,5; or None where no such locale can be had."""
    if shutil.which("localedef"):
        subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", pathlib.Path(folder) / "de_DE.UTF-8"],
                       capture_output=True)
    for name, path in (("de_DE.UTF-8", folder), ("de_DE.UTF-8", None), ("de_DE.utf8", None), ("de_DE", None)):
        environment = {**os.environ, "LC_ALL": name, **({"LOCPATH": folder} if path else {})}
        run = subprocess.run(["/usr/bin/printf", "%.1f", "0,5"], env=environment, capture_output=True, text=True)
        if run.returncode == 0 and run.stdout == "0,5":
            return environment
    return None


with tempfile.TemporaryDirectory() as folder:
    comma = with_decimal_comma(folder)
    if comma is None:
        print("no locale with a decimal comma here")
    for environment in filter(None, (comma, {**os.environ, "LC_ALL": "C"})):
        main = phase(environment, CASE="mochikoshi")[0]
        assert phase(environment, CASE="mochikoshi", T="16")[0] == main, "T of the case itself"
        assert phase(environment, CASE="mochikoshi", T="16.5")[0] == main + "/t16.5", "T=16.5"
        for wrong in ("16,5", "x", "1e9x", "-3"):
            found, message = phase(environment, CASE="mochikoshi", T=wrong)
            assert "is not a time" in message, (wrong, found, message)
print("times have a decimal point")
