#!/usr/bin/python3
"""Folders of fem_stage and transfer_tool are floors: a file includes its own folder and the ones below, never one above.

floors_test.py REPOSITORY

common/ is under both programs and neither includes another program. main.cpp stands on top of all folders.
"""
import pathlib
import re
import sys

# From the ground up. A folder that needs a place between two others gets it here.
FLOORS = {
    "fem_stage": ["mesh", "element", "material", "boundary", "model", "solver", "output", "stage", "element_test"],
    "transfer_tool": ["sample", "map", "assign", "audit", "options", "import", "inspect"],
}


def faults_of(root, program, floors):
    """Sentences about what a program's sources include that they may not, and how many includes were looked at."""
    faults, looked_at = [], 0
    for path in sorted((root / program).rglob("*.?pp")):
        folder = path.parent.name if path.parent != root / program else None
        if folder is not None and folder not in floors:
            faults.append(f"{program}/{folder} is not in the list of floors of this test")
            continue
        height = floors.index(folder) if folder is not None else len(floors)
        for included in re.findall(r'^\s*#include "([^"]+)"', path.read_text(), re.MULTILINE):
            looked_at += 1
            owner, *below = included.split("/")
            name = path.relative_to(root)
            if owner == "common":
                continue
            if owner != program or len(below) != 2 or below[0] not in floors:
                faults.append(f"{name}: {included} is neither in common nor in a folder of {program}")
            elif floors.index(below[0]) > height:
                faults.append(f"{name}: {included} is above {folder}")
    return faults, looked_at


def main():
    root = pathlib.Path(sys.argv[1])
    faults, looked_at = [], 0
    for program, floors in FLOORS.items():
        found, number = faults_of(root, program, floors)
        faults += found
        looked_at += number
    print("\n".join(sorted(set(faults))) or f"{looked_at} includes, none upwards")
    sys.exit(1 if faults or looked_at < 100 else 0)


if __name__ == "__main__":
    main()
