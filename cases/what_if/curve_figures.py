"""Curves of a grid (curves.py) as table, CSV and picture: mean and standard deviation of its numbers over one list, for each combination of the others, at each
size of the case whose sweep is of the same input."""

import csv
from pathlib import Path

import numpy as np

import members_table
import paths  # noqa: F401
import style
from case_part import read_case
from headline import BY_NAME
from mesh_study import folder_of_size
from stage import read_json

COLOURS = ["#2b6ca3", style.ACCENT, "#3a8f4d", "#8b6b4a", "#7a4fa3", "0.35"]
MARKERS = ("o", "s", "^", "D", "v")


class Line:
    """A combination of the lists that are neither the axis nor chance: of each number arrays with a value a point of the axis."""

    def __init__(self, table, chosen, name):
        self.name, over = name, table.plan["curves"]["over"]
        self.over = sorted(next(p for p in table.parameters if p["name"] == over)["choices"])
        rows = [[row for row, state in enumerate(table.state) if state == "done" and table.values[over][row] == point
                 and all(table.values[own][row] == value for own, value in chosen.items())] for point in self.over]
        self.members = [len(own) for own in rows]
        self.values = {}
        for number in table.plan["curves"]["numbers"]:
            self.values[number] = [found[np.isfinite(found)] for found in (table.numbers[number][own] for own in rows)]

    def mean(self, number):
        return np.array([values.mean() if len(values) else np.nan for values in self.values[number]])

    def spread(self, number):
        return np.array([values.std(ddof=1) if len(values) > 1 else np.nan for values in self.values[number]])


def lines(table):
    """The Lines of a table, in the order of the lists."""
    curves = table.plan["curves"]
    others = [p for p in table.parameters if p["name"] not in (curves["over"], *curves["chance"]) and len(p["choices"]) > 1]
    combinations = [({}, [])]
    for p in others:
        labels = p["labels"] or [members_table.text_of(value) for value in p["choices"]]
        combinations = [({**chosen, p["name"]: value}, [*words, label]) for chosen, words in combinations for value, label in zip(p["choices"], labels)]
    return [Line(table, chosen, ", ".join(words)) for chosen, words in combinations]


def statistics(table):
    """Header and rows (texts): a point of a line, its members, mean +- standard deviation of each number."""
    curves = table.plan["curves"]
    headlines = [BY_NAME[name] for name in curves["numbers"]]
    rows = []
    for line in lines(table):
        for k, point in enumerate(line.over):
            cells = []
            for headline in headlines:
                mean, spread = line.mean(headline.name)[k], line.spread(headline.name)[k]
                cells.append(headline.display(mean) + ("" if np.isnan(spread) else f" +- {headline.display(spread)}"))
            rows.append([line.name, f"{point:g}", str(line.members[k]), *cells])
    return ["", curves["axis"], "members", *(f"{headline.label} ({headline.display_unit})" for headline in headlines)], rows


def write_csv(path, table):
    with Path(path).open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["line", table.plan["curves"]["over"], "number", "unit", "members", "mean", "standard_deviation"])
        for line in lines(table):
            for number, values in line.values.items():
                for k, point in enumerate(line.over):
                    cells = ["" if np.isnan(value) else f"{value:.6g}" for value in (line.mean(number)[k], line.spread(number)[k])]
                    writer.writerow([line.name, f"{point:g}", number, BY_NAME[number].unit, len(values[k]), *cells])


def sizes(table, folder):
    """{size: Table} of this sweep and of the same one at other sizes, in the order of the case file."""
    plan, folder = table.plan, Path(folder).absolute()
    found = {}
    for size in read_case(Path(plan["case"]) / "mpm.json").get("sizes") or [plan["size"]]:
        other = folder_of_size(Path(plan["store"]).absolute().parent, folder.parents[1], plan["size"], size) / "sweeps" / folder.name
        if size == plan["size"]:
            found[size] = table
        elif (read_json(other / "plan.json") or {}).get("input", "") == plan["input"]:
            found[size] = members_table.load(other)
    return {size: own for size, own in found.items() if own.done.any()}


def panel(axis, tables, headline, words):
    for (size, table), marker in zip(tables.items(), MARKERS):
        for line, colour in zip(lines(table), COLOURS):
            mean, spread = line.mean(headline.name) * headline.factor, line.spread(headline.name) * headline.factor
            first = marker == MARKERS[0]
            axis.plot(line.over, mean, color=colour, marker=marker, ms=5, mfc="white" if first else colour, lw=1.3, ls="--" if first else "-",
                      label=", ".join(word for word in (size if len(tables) > 1 else "", line.name) if word))
            some = np.isfinite(spread)
            axis.errorbar(np.array(line.over)[some], mean[some], spread[some], color=colour, ls="none", capsize=3)
            for point, values in zip(line.over, line.values[headline.name]):
                axis.plot(np.full(len(values), point), values * headline.factor, ".", ms=3, color=colour, alpha=0.5)
    axis.set(title=headline.label, ylabel=headline.display_unit, xlabel=words)
    low, high = axis.get_ylim()
    axis.set_ylim(min(0.0, low), high + 0.05 * abs(high))
    axis.grid(alpha=0.3)


def draw(table, folder):
    """[(file, caption)]"""
    tables, curves = sizes(table, folder), table.plan["curves"]
    headlines = [BY_NAME[name] for name in curves["numbers"] if any(np.isfinite(own.numbers[name]).any() for own in tables.values())]
    if not headlines:
        return []
    plt = style.pyplot()
    columns = min(len(headlines), 2)
    rows = -(-len(headlines) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(style.WIDTH, 3.1 * rows + 0.6), squeeze=False)
    for axis in axes.flat[len(headlines):]:
        axis.set_axis_off()
    for axis, headline in zip(axes.flat, headlines):
        panel(axis, tables, headline, curves["axis"])
    handles, labels = axes[0, 0].get_legend_handles_labels()
    if labels:  # one line at one size has no name
        figure.legend(handles, labels, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncol=min(len(labels), 4), fontsize=9)
    several = any(count > 1 for own in tables.values() for line in lines(own) for count in line.members)
    figure.suptitle("mean and standard deviation over runs that differ in nothing physical; dots: the runs" if several else "one run each", fontsize=9)
    style.save(figure, Path(folder) / "curves.png")
    return [("curves.png", "Over " + curves["axis"])]
