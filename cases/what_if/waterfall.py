"""A way of steps (steps.py) as table, CSV and picture: what each choice moves a number by, beside what chance does to it."""

import csv

import numpy as np

import paths  # noqa: F401
import style
from headline import BY_NAME
from members_table import used_headlines
from steps import PARAMETER

SHOWN = ("largest_displacement_fem_m", "largest_displacement_mpm_m", "runout_m", "released_volume_m3")
MORE, LESS, ALL = "#c0392b", "#2b6ca3", "0.55"
WITHOUT = {"missing": "not computed", "failed": "failed", "done": "none"}  # what stands in the place of a bar
CERTAIN = 2.0  # standard errors that a change has to exceed


class Way:
    """Of one headline number: arrays with a value a step."""

    def __init__(self, table, headline):
        # Why there is no value of a step: "failed" only where no member is done.
        self.state = {name: state for wanted in ("missing", "failed", "done") for name, state in zip(table.values[PARAMETER], table.state) if state == wanted}
        names = list(dict.fromkeys(table.values[PARAMETER]))
        own = np.array(table.values[PARAMETER])
        numbers = table.numbers[headline.name] * headline.factor
        self.names, self.headline = names, headline
        self.values = [numbers[(own == name) & np.isfinite(numbers)] for name in names]
        self.count = np.array([len(values) for values in self.values])
        self.mean = np.array([values.mean() if len(values) else np.nan for values in self.values])
        self.spread = np.array([values.std(ddof=1) if len(values) > 1 else np.nan for values in self.values])
        # From the last step before that has members.
        self.before = np.full(len(names), np.nan)
        self.error = np.full(len(names), np.nan)  # standard error of the change
        last = None
        for k in range(len(names)):
            if last is not None and self.count[k]:
                self.before[k] = self.mean[last]
                self.error[k] = np.hypot(self.spread[k] / np.sqrt(self.count[k]), self.spread[last] / np.sqrt(self.count[last]))
            last = k if self.count[k] else last

    @property
    def change(self):
        return self.mean - self.before

    def certain(self, k):
        return abs(self.change[k]) > CERTAIN * self.error[k]

    def words(self, k):
        if not self.count[k]:
            return "-"
        spread = "" if np.isnan(self.spread[k]) else f" +- {self.spread[k]:.{self.headline.digits}f}"
        return f"{self.mean[k]:.{self.headline.digits}f}{spread}"


def ways(table, names=None):
    used = used_headlines(table)
    return [Way(table, headline) for headline in (used if names is None else [BY_NAME[name] for name in names]) if headline in used]


def statistics(table):
    """Header and rows (texts): a step, its members, value +- standard deviation of the numbers of the picture."""
    shown = ways(table, SHOWN)
    if not shown:
        return ["step", "members"], []
    done = {name: sum(state == "done" and own == name for state, own in zip(table.state, table.values[PARAMETER])) for name in shown[0].names}
    header = ["step", "members", *(f"{way.headline.label} ({way.headline.display_unit})" for way in shown)]
    return header, [[name, str(done[name]), *(way.words(k) for way in shown)] for k, name in enumerate(shown[0].names)]


def write_csv(path, table):
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["step", "number", "unit", "members", "mean", "standard_deviation", "change", "standard_error_of_change"])
        for way in ways(table):
            for k, name in enumerate(way.names):
                numbers = ["" if np.isnan(value) else f"{value / way.headline.factor:.6g}" for value in (way.mean[k], way.spread[k], way.change[k], way.error[k])]
                writer.writerow([name, way.headline.name, way.headline.unit, way.count[k], *numbers])


def panel(axis, way, reference):
    """A bar from the value before to that of the step; the first and the last are given whole. Pale where chance alone could do it."""
    for k in range(len(way.names)):
        if not way.count[k]:
            axis.text(0.02, k, WITHOUT[way.state[way.names[k]]], transform=axis.get_yaxis_transform(), va="center", fontsize=8, color="0.4")
            continue
        whole = np.isnan(way.before[k])
        low, high = (0.0, way.mean[k]) if whole else sorted((way.before[k], way.mean[k]))
        colour = ALL if whole else MORE if way.change[k] > 0.0 else LESS
        axis.barh(k, high - low, left=low, height=0.62, color=colour, alpha=1.0 if whole or way.certain(k) else 0.3)
        axis.plot(way.values[k], np.full(way.count[k], k), "o", ms=3, mfc="white", mec="0.15", mew=0.8, zorder=3)
        axis.text(1.02, k, way.words(k), transform=axis.get_yaxis_transform(), va="center", fontsize=8)
    for k in range(1, len(way.names)):  # from bar to bar
        if way.count[k] and not np.isnan(way.before[k]):
            axis.plot([way.before[k]] * 2, [k - 1, k], color="0.5", lw=0.7, zorder=0)
    if reference and way.headline.name in reference["numbers"]:
        axis.axvline(reference["numbers"][way.headline.name] * way.headline.factor, color="0.2", ls="--", lw=1.0)
        axis.text(reference["numbers"][way.headline.name] * way.headline.factor, -0.75, f" {reference['name']}", fontsize=8, ha="left", va="center")
    axis.set(title=way.headline.label, xlabel=way.headline.display_unit, ylim=(len(way.names) - 0.4, -1.1))
    axis.grid(alpha=0.3, axis="x")


def draw(table, folder):
    """[(file, caption)]"""
    shown = ways(table, SHOWN)
    if not shown:
        return []
    plt = style.pyplot()
    height = 1.4 + 0.33 * (len(shown[0].names) + 1)
    rows = [shown[k:k + 2] for k in range(0, len(shown), 2)]
    figure, axes = plt.subplots(len(rows), min(len(shown), 2), figsize=(style.WIDTH * 1.15, height * len(rows)), squeeze=False, sharey=True)
    for axis in axes.flat[len(shown):]:
        axis.set_axis_off()
    for axis, way in zip(axes.flat, shown):
        panel(axis, way, table.plan.get("reference"))
    for row in axes:
        row[0].set_yticks(range(len(shown[0].names)), [("" if k == 0 else "+ ") + name for k, name in enumerate(shown[0].names)])
    figure.suptitle("each choice added to those above it; circles: members, which differ in nothing physical; pale: no more than chance "
                    f"(change below {CERTAIN:g} standard errors)", fontsize=9)
    style.save(figure, folder / "waterfall.png")
    return [("waterfall.png", "What each choice moves")]
