#!/usr/bin/env python3
"""Residual strengths over sigma'_v0 from the CSV of `transfer_tool strength`; with --particles also where the soil lies.

    strength_plot.py out/mochikoshi/figures/strength.csv --particles out/mochikoshi/particles.h5 -o out/mochikoshi/figures/strength.png
"""

import argparse
import csv
from pathlib import Path

import numpy as np

import chain_files as chain
import style

COLUMNS = {"rule", "material", "relation", "percentile", "chosen", "sigma_v0_Pa", "s_R_Pa"}
MEDIAN, BAND = 50.0, (16.0, 84.0)


def read_curves(path):
    """Curves in the file's order: rule, material, relation, percentile (None), chosen, stress and strength (kPa)."""
    path = Path(path)
    if not path.exists():
        chain.fail(f"{path}: no such file; transfer_tool strength writes it")
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    if not rows or not COLUMNS <= set(rows[0]):
        chain.fail(f"{path}: not a table of transfer_tool strength, whose columns are {', '.join(sorted(COLUMNS))}")
    curves = {}
    for row in rows:
        percentile = float(row["percentile"]) if row["percentile"] else None
        key = (int(row["rule"]), row["material"], row["relation"], percentile, row["chosen"] == "1")
        curves.setdefault(key, []).append((float(row["sigma_v0_Pa"]) / 1e3, float(row["s_R_Pa"]) / 1e3))
    return [(*key, np.array(points).T) for key, points in curves.items()]


def draw_relation(axis, name, curves, colour):
    """One model: its median or only curve, the band between 16 and 84 %, other percentiles dashed."""
    by_percentile = {percentile: points for _, _, _, percentile, _, points in curves}
    if all(limit in by_percentile for limit in BAND):
        low, high = (by_percentile[limit] for limit in BAND)
        axis.fill_between(low[0], low[1], high[1], color=colour, alpha=0.15, lw=0)
    for percentile, points in by_percentile.items():
        if percentile in BAND:
            continue
        main = percentile in (None, MEDIAN)
        label = name if percentile is None else f"{name}, {percentile:g} %" + (" (band 16 to 84 %)" if main and BAND[0] in by_percentile else "")
        axis.plot(*points, color=colour, lw=1.4 if main else 1.0, ls="-" if main else "--", label=label)


def draw_stresses(axis, particles, law, limit):
    """Where the soil of this law lies: its volume over sigma'_v0, along the bottom of the panel."""
    mask = particles.data["strength_law"] == law
    if not mask.any():
        return
    stress = particles.data["initial_vertical_effective_stress"][mask] / 1e3
    below = axis.twinx()
    below.hist(np.clip(stress, 0.0, limit), bins=np.linspace(0.0, limit, 41), weights=particles.data["volume"][mask], color="0.8")
    below.set_ylim(0.0, 4.0 * below.get_ylim()[1])
    below.set_ylabel("soil of this rule (m3/m per bar; grey)", color="0.45", loc="bottom")
    below.tick_params(axis="y", colors="0.45")
    ticks = below.get_yticks()
    below.set_yticks(ticks[(ticks >= 0.0) & (ticks <= 0.3 * below.get_ylim()[1])])
    axis.set_zorder(below.get_zorder() + 1)
    axis.patch.set_visible(False)


def plot(plt, curves, particles, output):
    rules = list(dict.fromkeys(curve[0] for curve in curves))
    figure, axes = plt.subplots(len(rules), 1, figsize=(style.WIDTH, 5.6 * len(rules)), squeeze=False)
    for law, (rule, axis) in enumerate(zip(rules, axes[:, 0])):
        own = [curve for curve in curves if curve[0] == rule]
        limit = max(points[0].max() for *_, points in own)
        relations = list(dict.fromkeys(curve[2] for curve in own if not curve[4]))
        for index, name in enumerate(relations):
            draw_relation(axis, name.replace("_", " "), [c for c in own if c[2] == name and not c[4]], f"C{index}")
        for _, material, relation, percentile, chosen, points in own:
            if chosen:
                words = relation.replace("_", " ") + (f", {percentile:g} %" if percentile is not None else "")
                axis.plot(*points, color="k", lw=2.4, drawstyle="steps-mid" if relation == "bins" else "default", label=f"the case's own: {words}")
                axis.set_title(f"rule {rule}, {material.replace('_', ' ')}: residual strength")
        axis.set(xlim=(0.0, limit), ylim=(0.0, None), xlabel="$\\sigma'_{v0}$ (kPa)", ylabel="$s_R$ (kPa)")
        axis.grid(alpha=0.3)
        if particles is not None and "strength_law" in particles.data:
            draw_stresses(axis, particles, law, limit)
        axis.legend(loc="upper left", fontsize=9)
    style.save(figure, output)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", type=Path, help="CSV of transfer_tool strength")
    parser.add_argument("--particles", type=Path, help="particles file of the same transfer.json")
    parser.add_argument("-o", "--output", type=Path, required=True)
    arguments = parser.parse_args()
    particles = chain.Particles(arguments.particles) if arguments.particles else None
    plot(style.pyplot(), read_curves(arguments.table), particles, arguments.output)


if __name__ == "__main__":
    main()
