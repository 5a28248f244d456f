#!/usr/bin/env python3
"""Prints the main numbers of a case's results and where its pictures are.

    print_summary.py out/mochikoshi --phase out/mochikoshi
"""

import argparse
from pathlib import Path

import results


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="out/<case>[-<size>]")
    parser.add_argument("--phase", type=Path, help="folder of particles, mpm and figures (the same without T=)")
    arguments = parser.parse_args()
    phase = arguments.phase or arguments.folder
    print(f"{phase}:")
    for stage, what, value, unit in results.collect(arguments.folder, phase):
        print(f"  {stage:4s} {what:32s} {value} {unit if unit != '1' else ''}".rstrip())
    for name in ("report.html", "overview.png", "runout.mp4", "runout.gif"):
        if (phase / "figures" / name).exists():
            print(f"  {phase / 'figures' / name}")


if __name__ == "__main__":
    main()
