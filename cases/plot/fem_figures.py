#!/usr/bin/env python3
"""Pictures of the FEM stage: mesh, velocities, pore pressure ratio and displacement at the hand-over, and their history.

    fem_figures.py out/mochikoshi/fem --case cases/mochikoshi --time 16 -o out/mochikoshi/figures
"""

import argparse
from pathlib import Path

import numpy as np

import chain_files as chain
import field_plot as fields
import style


def plot_mesh(plt, snapshot, options, output):
    low, high = snapshot.position.min(axis=0), snapshot.position.max(axis=0)
    whole = [low[0], high[0], low[1] - 2.0, high[1] + 4.0]
    dam = fields.dam_view(snapshot, options)
    heights = [style.panel_height(whole, extra=0.5), style.panel_height(dam, extra=0.5)]
    figure, axes = plt.subplots(2, 1, figsize=(style.WIDTH, sum(heights) + 0.6), height_ratios=heights)
    for axis, view in zip(axes, (whole, dam)):
        handles = fields.draw_regions(axis, snapshot, snapshot.position)
        fields.draw_phreatic_line(axis, snapshot)
        style.true_aspect(axis, view)
    axes[0].set_title(f"mesh: {len(snapshot.position)} nodes, {len(snapshot.quads)} quadrilaterals")
    handles += axes[0].get_legend_handles_labels()[0]
    axes[1].legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0.0), borderaxespad=3.8, ncol=6)
    style.save(figure, output)


def moving(snapshot, name):
    """A nodal vector field relative to the base's own motion."""
    values = snapshot.nodal(name)
    return values - (snapshot.base_velocity if name == "velocity" else snapshot.base_displacement())


def plot_velocity(plt, snapshot, options, output):
    view = fields.dam_view(snapshot, options)
    points, velocity = snapshot.deformed(), moving(snapshot, "velocity")
    speed = np.hypot(*velocity.T)
    figure, axis = plt.subplots(figsize=(style.WIDTH, style.panel_height(view) + 0.5))
    fields.draw_mesh(axis, points, snapshot.quads)
    fields.draw_outlines(axis, snapshot, points)
    shown = np.isfinite(speed) & (speed > 0.01 * speed.max())
    # The longest arrow is a tenth of the panel; single runaway nodes are cut at the 99.5th percentile.
    limit = style.nice_limit(np.percentile(speed, 99.5))
    length = 0.1 * (view[1] - view[0]) / limit
    arrows = axis.quiver(
        *points[shown].T, *velocity[shown].T, speed[shown], cmap=style.SPEED_COLOURS, clim=(0.0, limit), angles="xy",
        scale_units="xy", scale=1.0 / length, width=0.0016,
    )  # fmt: skip
    style.true_aspect(axis, view)
    axis.set_title(f"velocity relative to the base on the deformed mesh, t = {snapshot.time:g} s")
    style.colour_bar(figure, arrows, axis, "speed (m/s)")
    style.save(figure, output)


def plot_pressure_ratio(plt, snapshot, options, output):
    view = fields.dam_view(snapshot, options)
    figure, axis = plt.subplots(figsize=(style.WIDTH, style.panel_height(view) + 0.5))
    mappable = draw_pressure_ratio(axis, snapshot, view)
    axis.set_title(f"excess pore pressure ratio, t = {snapshot.time:g} s")
    style.colour_bar(figure, mappable, axis, "$r_u$ = excess pore pressure / $\\sigma'_{v0}$ (1)")
    style.save(figure, output)


def draw_pressure_ratio(axis, snapshot, view):
    """r_u of each element on the deformed mesh; also used by the overview."""
    points = snapshot.deformed()
    ratio = np.clip(snapshot.cell("excess_pore_pressure_ratio"), 0.0, 1.0)
    mappable = fields.draw_cells(axis, points, snapshot.quads, ratio, **style.RATIO_SCALE)
    fields.draw_outlines(axis, snapshot, points)
    fields.draw_phreatic_line(axis, snapshot)
    style.true_aspect(axis, view)
    return mappable


def plot_displacement(plt, snapshot, options, output):
    view = fields.dam_view(snapshot, options)
    points, size = snapshot.deformed(), np.hypot(*moving(snapshot, "displacement").T)
    limit = options.get("displacement_scale", style.nice_limit(np.percentile(size, 99.9)))
    figure, axis = plt.subplots(figsize=(style.WIDTH, style.panel_height(view) + 0.5))
    mappable = fields.draw_nodal(
        axis, points, snapshot.quads, size, cmap=style.DISPLACEMENT_COLOURS, vmin=0.0, vmax=limit
    )
    fields.draw_outlines(axis, snapshot, points)
    fields.draw_outlines(axis, snapshot, snapshot.position, colour="0.6", width=0.5)
    style.true_aspect(axis, view)
    axis.set_title(
        f"displacement {'imported' if snapshot.imported else 'at the end of the FEM phase'}, t = {snapshot.time:g} s (largest {size.max():.2f} m; grey: before)"
    )
    style.colour_bar(figure, mappable, axis, "displacement relative to the base (m)", extend="max")
    style.save(figure, output)


def plot_series(plt, quality, summary, time, output):
    figure, axes = plt.subplots(4, 1, figsize=(9, 9), sharex=True)
    t = quality["time_s"]
    axes[0].plot(t, quality["liquefied_depth_m"], "C0")
    axes[0].set_ylabel("liquefied depth (m)")
    axes[1].plot(t, quality["mean_excess_pore_pressure_ratio"], "C0", label="mean $r_u$ of the tailings")
    axes[1].plot(t, quality["liquefied_share"], "C1", label="share with $r_u$ above the threshold")
    axes[1].set(ylabel="(1)", ylim=(0.0, 1.02))
    axes[1].legend(loc="upper left")
    axes[2].plot(t, quality["largest_displacement_m"], "C0")
    axes[2].set_ylabel("largest\ndisplacement (m)")
    axes[3].plot(t, quality["smallest_scaled_jacobian"], "C0", label="the smallest")
    if "least_jacobian_kept" in quality:  # not in series of earlier programs
        axes[3].plot(t, quality["least_jacobian_kept"], "C1", label="least that an element has of its own at the start")
        axes[3].legend(loc="lower left")
    axes[3].set(ylabel="scaled Jacobian (1)", xlabel="time since the start of shaking (s)", ylim=(min(0.0, quality["smallest_scaled_jacobian"].min()), 1.02))
    window = summary.get("transfer_window", {})
    opens, closes = window.get("opens_s"), window.get("closes_s")
    for axis in axes:
        if opens is not None:
            axis.axvspan(opens, closes if closes is not None else t[-1], color="#d9ead3", zorder=0)
        if time is not None:
            axis.axvline(time, color=style.ACCENT, lw=1.0)
        axis.grid(alpha=0.3)
        axis.set_xlim(t[0], t[-1])
    shaded = "; green: transfer window" if opens is not None else ""
    axes[0].set_title(f"liquefaction and mesh quality (red: hand-over{shaded})")
    style.save(figure, output)


def plot_histories(plt, history, time, output):
    names = [name[: -len("_ux_m")] for name in history if name.endswith("_ux_m")]
    if not names:
        return
    figure, axes = plt.subplots(2, 1, figsize=(9, 6), sharex=True)
    for name in names:
        axes[0].plot(history["time_s"], history[name + "_ux_m"], lw=1.0, label=name.replace("_", " "))
        axes[1].plot(history["time_s"], history[name + "_uy_m"], lw=1.0)
    axes[0].set(ylabel="horizontal displacement (m)", title="named points")
    axes[1].set(ylabel="vertical displacement (m)", xlabel="time since the start of shaking (s)")
    for axis in axes:
        axis.grid(alpha=0.3)
        if time is not None:
            axis.axvline(time, color=style.ACCENT, lw=1.0)
    axes[0].legend(ncol=2, fontsize=8)
    style.save(figure, output)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="results of fem_stage")
    parser.add_argument("--case", type=Path, help="the case's folder, for plot.json")
    parser.add_argument("--time", type=float, help="time of the hand-over (s); the last snapshot without")
    parser.add_argument("-o", "--output", type=Path, required=True)
    arguments = parser.parse_args()
    plt = style.pyplot()
    options = chain.plot_options(arguments.case)
    snapshot = chain.snapshot_at(arguments.folder, arguments.time)
    plot_mesh(plt, snapshot, options, arguments.output / "mesh.png")
    plot_velocity(plt, snapshot, options, arguments.output / "velocity.png")
    plot_pressure_ratio(plt, snapshot, options, arguments.output / "excess_pore_pressure_ratio.png")
    plot_displacement(plt, snapshot, options, arguments.output / "displacement_fem.png")
    quality = chain.series(arguments.folder / "quality.csv")
    if quality is not None:
        summary = chain.summary(arguments.folder / "summary.json")
        plot_series(plt, quality, summary, snapshot.time, arguments.output / "fem_series.png")
    history = chain.series(arguments.folder / "history.csv")
    if history is not None:
        plot_histories(plt, history, snapshot.time, arguments.output / "fem_histories.png")


if __name__ == "__main__":
    main()
