"""Lets the scripts of this folder use those that compute runs (cases/run) and those that read and draw them (cases/plot)."""

import sys
from pathlib import Path

CASES = Path(__file__).resolve().parents[1]
sys.dont_write_bytecode = True
for folder in (CASES / "run", CASES / "plot"):
    if str(folder) not in sys.path:
        sys.path.append(str(folder))
