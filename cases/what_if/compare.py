#!/usr/bin/env python3
"""Runs of a case side by side: what was set differently, headline numbers and their differences from the first run, profiles over
one another, fronts over time.

    compare.py --fem out/mochikoshi --phase out/mochikoshi --title mochikoshi        the runs are in RUNS of the environment

Writes compare/<names>/: numbers.csv, profiles.csv, fronts.csv, compare.png and compare.html (one file that can be sent on).
"""

import argparse
import csv
import hashlib
import json
import os
import sys
from pathlib import Path

import numpy as np

import paths  # noqa: F401
import compare_figures
import html_page as page
import runs as what_is_there
from headline import HEADLINES


def shown(value):
    """A value of a case file in a table."""
    if isinstance(value, float):
        return f"{value:.10g}"
    if isinstance(value, list):
        return f"[{', '.join(map(shown, value))}]"
    return "-" if value is None else value if isinstance(value, str) else json.dumps(value)


def numbers_table(runs):
    """Header and rows (texts): a headline number, its value in each run, its difference from the first run."""
    header = ["", "unit", *(run.name for run in runs), *(f"{run.name} - {runs[0].name}" for run in runs[1:])]
    rows = []
    for headline in HEADLINES:
        values = [run.numbers[headline.name] for run in runs]
        if all(value is None for value in values):
            continue
        changes = [None if None in (value, values[0]) else value - values[0] for value in values[1:]]
        signs = ["+" if change is not None and change > 0 else "" for change in changes]
        rows.append([headline.label, headline.display_unit, *map(headline.display, values),
                     *(sign + headline.display(change) for sign, change in zip(signs, changes))])
    rows.append(["ended", "", *(run.ended or "-" for run in runs), *([""] * (len(runs) - 1))])
    return header, rows


def settings_table(runs):
    """Header and rows of what is not the same in all runs."""
    differences = what_is_there.differences(runs)
    return ["", *(run.name for run in runs)], [[key, *map(shown, row)] for key, row in differences.items()]


def in_columns(header, rows):
    """The table as text."""
    widths = [max(len(str(row[k])) for row in [header, *rows]) for k in range(len(header))]
    lines = ["  ".join(f"{cell:{'<' if k < 1 else '>'}{widths[k]}}" for k, cell in enumerate(row)) for row in [header, *rows]]
    return "\n".join("  " + line.rstrip() for line in lines)


def write_numbers(path, runs):
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["quantity", *(run.name for run in runs)])
        for headline in HEADLINES:
            values = [run.numbers[headline.name] for run in runs]
            writer.writerow([headline.name, *("" if value is None else f"{value:.9g}" for value in values)])
        for key, row in what_is_there.differences(runs).items():
            writer.writerow([key, *("" if value is None else shown(value) for value in row)])


def write_long(path, header, rows):
    """CSV of rows (run, numbers ...); NaN is empty."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        for name, *values in rows:
            writer.writerow([name, *("" if np.isnan(value) else f"{value:.7g}" for value in values)])


def write_profiles(path, runs):
    header = ["run", "x_m", "initial_surface_m", "surface_m", "flow_depth_m"]
    write_long(path, header, ((run.name, *row) for run in runs if run.flow is not None
                              for row in zip(run.flow.x, run.flow.initial_surface, run.flow.surface, run.flow.depth)))


def write_fronts(path, runs):
    names = ["robust_front_m", "flow_front_m", "runout_m", "flowed_mass_kg", "rms_speed_m_s"]
    rows = []
    for run in runs:
        if run.front is not None:
            gaps = np.full_like(run.front["time_s"], np.nan)
            columns = [run.front.get(name, gaps) for name in names]
            rows += [(run.name, what_is_there.hand_over_time(run) + row[0], *row[1:]) for row in zip(run.front["time_s"], *columns)]
    write_long(path, ["run", "time_since_shaking_began_s", *names], rows)


def folder_for(phase, names):
    """A folder of this comparison's own."""
    joined = "+".join(names)
    return Path(phase) / "compare" / (joined if len(joined) <= 100 else f"{len(names)}_runs_{hashlib.sha256(joined.encode()).hexdigest()[:8]}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fem", type=Path, required=True, help="results of the base run")
    parser.add_argument("--phase", type=Path, required=True, help="the same, or their folder of another time (T=)")
    parser.add_argument("--title", default="")
    arguments = parser.parse_args()
    try:
        runs = what_is_there.load_all(os.environ.get("RUNS", ""), arguments.fem, arguments.phase)
    except what_is_there.RunError as error:
        print(error, file=sys.stderr)
        return 1
    folder = folder_for(arguments.phase, [run.name for run in runs])
    folder.mkdir(parents=True, exist_ok=True)
    settings, numbers = settings_table(runs), numbers_table(runs)
    write_numbers(folder / "numbers.csv", runs)
    write_profiles(folder / "profiles.csv", runs)
    write_fronts(folder / "fronts.csv", runs)
    compare_figures.draw(runs, folder / "compare.png")
    equal = "nothing: all runs are computed from the same input"
    page.write(folder / "compare.html", f"{arguments.title}: {', '.join(run.name for run in runs)}", [
        page.heading("What is different"), page.table(*settings) if settings[1] else page.paragraph(equal),
        page.heading("What it comes to"), page.table(*numbers),
        page.picture(folder / "compare.png", "Ground at the end, depth of what flowed, and fronts over time"),
        page.paragraph("Volumes and masses are per metre of dam. What flowed has moved farther than output/flow_distance (1 m). A difference smaller "
                       "than the spread of runs that differ in nothing physical (make ensemble) is no difference.", small=True)])
    print("What is different:\n" + (in_columns(*settings) if settings[1] else f"  {equal}"))
    print("What it comes to:\n" + in_columns(*numbers))
    for name in ("compare.html", "compare.png", "numbers.csv", "profiles.csv", "fronts.csv"):
        print(f"  {folder / name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
