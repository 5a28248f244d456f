"""Table and pictures of a sweep, of all of its members that there are: members.csv, members.h5, failed.csv, PNGs, sweep.html."""

import sys
from pathlib import Path

import numpy as np

import paths  # noqa: F401
import curve_figures
import html_page as page
import members_table as members
import sweep_figures
import waterfall

QUANTILES = (("P10", 10), ("P50", 50), ("P90", 90))


def statistics(table):
    """Header and rows (texts) of the headline numbers over the members."""
    rows = []
    for headline in members.used_headlines(table):
        values = table.numbers[headline.name][np.isfinite(table.numbers[headline.name])]
        spread = values.std(ddof=1) if len(values) > 1 else None
        numbers = [values.min(), *(np.percentile(values, share) for _, share in QUANTILES), values.max(), values.mean(), spread]
        rows.append([headline.label, headline.display_unit, *(headline.display(number) for number in numbers)])
    return ["", "unit", "least", *(name for name, _ in QUANTILES), "most", "mean", "standard deviation"], rows


def failures(table):
    """(members, reason) for each reason, told once."""
    found = {}
    for member, state, content in zip(table.plan["members"], table.state, table.content):
        if state == "failed":
            found.setdefault((content["stage"], content["reason"], content["log"]), []).append(member["number"])
    return [(numbers, *what) for what, numbers in found.items()]


class Sampled:
    """How most designs are told: over all members."""

    statistics, draw, csv = staticmethod(statistics), staticmethod(sweep_figures.draw), None


class Steps:
    statistics, draw, csv = staticmethod(waterfall.statistics), staticmethod(waterfall.draw), ("steps.csv", waterfall.write_csv)


class Curves:
    statistics, draw, csv = staticmethod(curve_figures.statistics), staticmethod(curve_figures.draw), ("curves.csv", curve_figures.write_csv)


def gather(folder):
    """Writes all of it. Exit status 0 when every member is there, 2 when some are not."""
    folder = Path(folder)
    table = members.load(folder)
    done, failed, missing = (table.state.count(state) for state in ("done", "failed", "missing"))
    members.write_csv(folder / "members.csv", table)
    members.write_hdf5(folder / "members.h5", table)
    members.write_failures(folder / "failed.csv", table)
    for old in folder.glob("*.png"):
        old.unlink()
    told_as = Steps if table.plan["design"] == "steps" else Curves if table.plan.get("curves") else Sampled
    made = told_as.draw(table, folder) if done else []
    if told_as.csv:
        told_as.csv[1](folder / told_as.csv[0], table)
    header, rows = told_as.statistics(table)
    told = [f"member {', '.join(map(str, numbers))}: {stage}: {reason} (all that it said: {log})" for numbers, stage, reason, log in failures(table)]
    count = f"{done} of {len(table.state)} members done" + (f", {failed} failed" if failed else "") + (f", {missing} missing" if missing else "")
    moving = sum(content.get("stop_reason") == "end time" for content in table.content)
    end = [f"{moving} of {done} members ran until time/end of mpm.json without coming to rest: their numbers are of that moment."] if moving else []
    title = table.plan["title"] or f"{Path(table.plan['case']).name}: {folder.name}"
    parameters = [[p["name"], ", ".join(p["keys"]) + (" (scaled)" if p["scales"] else ""), members.text_of(p["base"])[:80]] for p in table.parameters]
    page.write(folder / "sweep.html", title, [
        *map(page.paragraph, [f"{count}. Design: {table.plan['design']}, seed {table.plan['seed']}.", *end]),
        page.table(["parameter", "key", "base run's value"], parameters), page.heading("Over the members"), page.table(header, rows),
        *(page.picture(folder / name, caption) for name, caption in made), *map(page.paragraph, told)])
    widths = [max(len(row[k]) for row in [header, *rows]) for k in range(len(header))]
    for row in [header, *rows]:
        print("  " + "  ".join(f"{cell:{'<' if k < 1 else '>'}{widths[k]}}" for k, cell in enumerate(row)).rstrip())
    for name in ("sweep.html", *(name for name, _ in made), *([told_as.csv[0]] if told_as.csv else []), "members.csv", "members.h5"):
        print(f"  {folder / name}")
    for text in end:
        print(f"  {text}")
    print(f"{folder}: {count}", flush=True)
    for text in told:
        print(f"  {text}", file=sys.stderr)
    if missing:
        print("  The same command computes what is not there, and nothing else.", file=sys.stderr)
    if failed:
        print("  RETRY=1 with the same command tries again what failed.", file=sys.stderr)
    return 0 if done == len(table.state) else 2
