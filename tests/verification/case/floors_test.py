#!/usr/bin/python3
"""Folders of common and of each program are floors: a file includes its own folder and the ones below, never one above.

floors_test.py REPOSITORY

common/ is under all programs and includes none of them; no program includes another. main.cpp stands on top of all folders of its program.
"""
import pathlib
import re
import sys

# From the ground up ("" is the folder itself). A folder that needs a place between two others gets it here.
FLOORS = {
    "common": ["", "residual_strength"],
    "fem_stage": ["mesh", "element", "material", "boundary", "model", "solver", "output", "stage", "element_test"],
    "transfer_tool": ["sample", "map", "assign", "balance", "audit", "options", "import", "inspect"],
    "mpm_stage": ["particles", "grid", "material", "transfer", "boundary", "step", "scene", "output", "checkpoint", "run"],
}


def faults_of(root, part, floors):
    """Sentences about what the sources of a part include that they may not, and how many includes were looked at."""
    faults, looked_at = [], 0
    for path in sorted((root / part).rglob("*.?pp")):
        name, folder = path.relative_to(root), path.parent.relative_to(root / part).as_posix().removeprefix(".")
        on_top = folder == "" and "" not in floors
        if not on_top and folder not in floors:
            faults.append(f"{part}/{folder} is not in the list of floors of this test")
            continue
        height = len(floors) if on_top else floors.index(folder)
        for included in re.findall(r'^\s*#include "([^"]+)"', path.read_text(), re.MULTILINE):
            looked_at += 1
            owner, *below = included.split("/")
            if owner == "common" and part != "common":
                continue
            if owner != part or "/".join(below[:-1]) not in floors:
                faults.append(f"{name}: {included} is neither in common nor in a folder of {part}")
            elif floors.index("/".join(below[:-1])) > height:
                faults.append(f"{name}: {included} is above {folder or part}")
    return faults, looked_at


def main():
    root = pathlib.Path(sys.argv[1])
    faults, counts = [], {}
    for part, floors in FLOORS.items():
        found, counts[part] = faults_of(root, part, floors)
        faults += found
    faults += [f"{part}: {count} includes found; this test looks in the wrong place" for part, count in counts.items() if count < 50]
    print("\n".join(sorted(set(faults))) or f"includes, none upwards: {counts}")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
