#!/usr/bin/env python3
"""Removes what sweeps have stored and no sweep refers to any more: members of designs that were changed, of case files and programs of before.

    prune.py --fem out/mochikoshi

A sweep refers to what its plan.json lists, as the last call of make sweep (or ensemble) wrote it. Named runs and the base run have files of their own.
"""

import argparse
import shutil
import sys
from pathlib import Path

import paths  # noqa: F401
import lock
import plan
import slurm
from stage import read_json


def plans(fem):
    """Folders of all sweeps that share the store, those of other times (T=) too."""
    return sorted(path.parent for root in (fem, *fem.glob("t[0-9]*")) for path in (root / "sweeps").glob("*/plan.json"))


def wanted(folders, store):
    """Folders of the store that some plan names. OSError where a plan cannot be read."""
    found = set()
    for folder in folders:
        content = read_json(folder / "plan.json")
        if content is None:
            raise OSError(f"{folder / 'plan.json'} cannot be read: make that sweep once more, or remove its folder")
        for member in content["members"]:
            found |= {plan.folder_of(store, stage, key) for stage, key in member["keys"].items()}
    return found


def size_of(folder):
    """Bytes on disk; of files that have other names too (links) nothing would be won."""
    states = [path.stat() for path in folder.rglob("*") if path.is_file()]
    return sum(512 * state.st_blocks for state in states if state.st_nlink == 1)


def prune(fem):
    store, folders, held = fem / "store", plans(fem), []
    for folder in folders:
        busy = slurm.still_queued(folder)
        taken = None if busy else lock.acquire(folder / ".lock", refuse=True)
        if taken is None:
            print(busy or f"{folder} is being computed; nothing is removed before it has ended", file=sys.stderr)
            return 1
        held.append(taken)
    keep = wanted(folders, store)
    gone, space = 0, 0
    for folder in sorted(path for path in store.glob("*-*") if path.is_dir()):
        if folder not in keep:
            space += size_of(folder)
            shutil.rmtree(folder)
            folder.with_name(f".{folder.name}.lock").unlink(missing_ok=True)
            gone += 1
    left = sum(path.is_dir() for path in store.glob("*-*"))
    print(f"{store}: {gone} removed ({space / 1e6:.1f} MB), {left} kept, which {len(folders)} sweep{'' if len(folders) == 1 else 's'} refer to"
          if gone or left else f"{store}: nothing stored")
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fem", type=Path, required=True, help="results of the case")
    try:
        return prune(parser.parse_args().fem)
    except OSError as error:
        print(error, file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
