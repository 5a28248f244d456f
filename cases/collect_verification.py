#!/usr/bin/env python3
"""Puts the verification runs' results together: ctest's own record, and what the tests wrote about themselves.

    collect_verification.py out/verification -o out/verification.json

The folder holds ctest.xml (JUnit) and, for each test that measures an error, <name>.json with name, error, ceiling (and
whatever else); tests find the folder in the environment variable TAILRUN_VERIFICATION_DIR.
"""

import argparse
import json
import sys
import xml.etree.ElementTree as xml
from pathlib import Path


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True)
    arguments = parser.parse_args()
    record = arguments.folder / "ctest.xml"
    if not record.exists():
        print(f"{record}: no such file; did ctest run?", file=sys.stderr)
        return 1
    rows = []
    for case in xml.parse(record).getroot().iter("testcase"):
        row = {"name": case.get("name"), "passed": case.get("status") == "run", "seconds": float(case.get("time"))}
        rows.append(row)
    tests = {row["name"]: row for row in rows}
    for path in sorted(arguments.folder.glob("*.json")):
        measured = json.loads(path.read_text())
        for entry in measured if isinstance(measured, list) else [measured]:
            if entry["name"] in tests:
                tests[entry["name"]].update(entry)
            else:
                rows.append(entry)
    arguments.output.write_text(json.dumps(rows, indent=1) + "\n")
    for row in rows:
        error = f"error {row['error']:.3g}, ceiling {row['ceiling']:.3g}" if "error" in row else ""
        state = "" if "passed" not in row else "passed" if row["passed"] else "FAILED"
        print(f"  {row['name']:36s} {state:7s} {error}")
    print(arguments.output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
