#!/usr/bin/env python3
"""Puts the verification runs' results together: ctest's own record, and what the tests wrote about themselves.

    collect_verification.py out/verification -o out/verification.json [--document docs/verification.md]

The folder holds ctest.xml (JUnit; several ctest*.xml where the tests ran in parts) and, for each test that measures errors, <name>.json: one object or a list of them
with name (the test's), row (of the verification table), quantity, error, ceiling, and optionally against, seconds,
compare ("at_least" where the figure must reach the ceiling) and pictures ([{"file", "caption"}], files beside it).
Tests find the folder in the environment variable TAILRUN_VERIFICATION_DIR. The document has a table for each stage and
the pictures.
"""

import argparse
import json
import shutil
import sys
import xml.etree.ElementTree as xml
from pathlib import Path

STAGES = {"fem": "FEM stage", "mpm": "MPM stage", "handover": "Hand-over", "": "Chain"}


def ctest_record(path):
    """{test name: (passed, seconds)}; what did not run is left out."""
    tests = {}
    for case in xml.parse(path).getroot().iter("testcase"):
        if case.get("status") in ("run", "fail"):
            tests[case.get("name")] = (case.get("status") == "run", float(case.get("time")))
    return tests


def collect(folder, tests):
    """One row for each error measured, and one for each test that measured none."""
    rows, measured = [], set()
    for path in sorted(folder.glob("*.json")):
        content = json.loads(path.read_text())
        for entry in content if isinstance(content, list) else [content]:
            name = entry["name"]
            if name not in tests:
                print(f"{path}: no test '{name}' ran; left out", file=sys.stderr)
                continue
            row = dict(entry)
            row["passed"] = (
                entry["error"] >= entry["ceiling"]
                if entry.get("compare") == "at_least"
                else entry["error"] <= entry["ceiling"]
            )
            row.setdefault("seconds", tests[name][1])
            rows.append(row)
            measured.add(name)
    for name in sorted(measured):
        mine = [row for row in rows if row["name"] == name]
        if not tests[name][0] and all(row["passed"] for row in mine):  # it failed before or after its measurements
            for row in mine:
                row["passed"] = False
    for name, (passed, seconds) in tests.items():
        if name not in measured:
            rows.append({"name": name, "passed": passed, "seconds": seconds})
    return rows


def stage_of(name):
    prefix = name.split("_")[0]
    return prefix if prefix in STAGES else ""


def figure(value):
    return f"{value:.3g}"


def cell(text):
    return str(text).replace("|", "\\|")


def table_line(row):
    at_least = row.get("compare") == "at_least"
    return (
        f"| {cell(row.get('row', row['name']))} | {cell(row.get('quantity', 'as the test states'))} "
        f"| {cell(row.get('against', ''))} | {figure(row['error']) if 'error' in row else ''} "
        f"| {('≥ ' if at_least else '≤ ') + figure(row['ceiling']) if 'ceiling' in row else ''} "
        f"| {'yes' if row['passed'] else '**no**'} | {row['seconds']:.1f} |"
    )


def document(rows, folder, path):
    """Markdown with a table for each stage; pictures are copied beside it."""
    pictures = path.parent / "pictures" / "verification"
    total, held = len(rows), sum(row["passed"] for row in rows)
    lines = [
        "# Verification: errors reached",
        "",
        "Written by `make -f Makefile.cases verification` from what the tests measured; do not edit. Scenes are under "
        "`cases/verification/` and run by hand. `Seconds` is the whole test's wall-clock time where it ran.",
        "",
        f"{held} of {total} figures are within their ceilings.",
    ]
    for prefix, title in STAGES.items():
        mine = [row for row in rows if stage_of(row["name"]) == prefix]
        if not mine:
            continue
        lines += ["", f"## {title}", "", "| row | quantity | against | reached | ceiling | within | seconds |"]
        lines += ["|---|---|---|---|---|---|---|"] + [table_line(row) for row in mine]
        for row in mine:
            for picture in row.get("pictures", []):
                pictures.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(folder / picture["file"], pictures / picture["file"])
                lines += ["", f"![{picture['caption']}](pictures/verification/{picture['file']})"]
                lines += ["", picture["caption"] + "."]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--document", type=Path, help="Markdown file to write")
    arguments = parser.parse_args()
    records = sorted(arguments.folder.glob("ctest*.xml"))
    if not records:
        print(f"{arguments.folder / 'ctest.xml'}: no such file; did ctest run?", file=sys.stderr)
        return 1
    rows = collect(arguments.folder, {name: row for record in records for name, row in ctest_record(record).items()})
    arguments.output.write_text(json.dumps(rows, indent=1) + "\n")
    for row in rows:
        error = f"{figure(row['error'])} ({figure(row['ceiling'])})" if "error" in row else ""
        state = "ok    " if row["passed"] else "FAILED"
        print(f"  {state} {error:20s} {row.get('row', row['name'])}: {row.get('quantity', '')}")
    print(arguments.output)
    if arguments.document:
        document(rows, arguments.folder, arguments.document)
        print(arguments.document)
    return 0


if __name__ == "__main__":
    sys.exit(main())
