#!/usr/bin/env python3
"""Pictures of the MPM stage: the hand-over, the additional displacement, the runout in stages, its front, flow and energy.

    mpm_figures.py out/mochikoshi/mpm --case cases/mochikoshi -o out/mochikoshi/figures
"""

import argparse
from pathlib import Path

import numpy as np

import chain_files as chain
import field_plot as fields
import flow_figures
import runout_plot as runout
import style
from palette import Palette
from runout_marks import Marks


def plot_handover(plt, first, view, palette, output):
    figure, axis = plt.subplots(figsize=(style.WIDTH, style.panel_height(view) + 0.6))
    runout.draw_materials(figure, axis, first, view, palette)
    axis.set_title(f"particles at the hand-over, t = {first.time:g} s: {len(first.position)}, {first.size:.2f} m apart")
    palette.legend(axis, first)
    style.save(figure, output)


def plot_displacement(plt, first, last, view, marks, output):
    extra = last.data["displacement"] - runout.displacement_at_transfer(first, last)
    size = np.hypot(extra[:, 0], extra[:, 1])
    limit = style.nice_limit(np.percentile(size, 99))  # a scale of its own: soil runs many times as far as the mesh moved
    figure, axis = plt.subplots(figsize=(style.WIDTH, style.panel_height(view) + 0.6))
    fields.draw_terrain(axis, last, view[2] - 1.0)
    style.true_aspect(axis, view)
    scale = {"cmap": style.DISPLACEMENT_COLOURS, "vmin": 0.0, "vmax": limit}
    mappable = fields.draw_particles(figure, axis, last, size, **scale)
    marks.draw(axis, last.time, view)
    since = "after the hand-over" if extra is not last.data["displacement"] else "since the start of the motion"
    axis.set_title(f"displacement {since}, t = {last.time:g} s (largest {size.max():.1f} m)")
    style.colour_bar(figure, mappable, axis, "additional displacement (m)", extend="max")
    style.save(figure, output)


def plot_stages(plt, paths, view, palette, marks, output):
    """Four moments: hand-over, an eighth, a third and the end of the run."""
    last = len(paths) - 1
    chosen = sorted({0, max(1, last // 8), max(1, last // 3), last}) if last > 0 else [0]
    height = style.panel_height(view, extra=0.35)
    figure, axes = plt.subplots(
        len(chosen), 1, figsize=(style.WIDTH, len(chosen) * height + 1.0), sharex=True, squeeze=False
    )
    for axis, index in zip(axes[:, 0], chosen):
        particles = chain.Particles(paths[index])
        runout.draw_materials(figure, axis, particles, view, palette)
        marks.draw(axis, particles.time, view)
        axis.set_xlabel("")
        axis.text(0.99, 0.94, f"t = {particles.time:g} s", transform=axis.transAxes, ha="right", va="top")
    axes[-1, 0].set_xlabel("x (m)")
    palette.legend(axes[-1, 0], particles)
    style.save(figure, output)


def plot_front(plt, front, summary, marks, output):
    figure, axes = plt.subplots(3, 1, figsize=(9, 8.6), sharex=True)
    t = marks.start + front["time_s"]
    foremost, body = (f"{100.0 * share:g} %" for share in summary["runout_quantiles"])
    axes[0].plot(t, front["runout_m"], "C3", lw=2.0, label="runout")
    axes[0].plot(t, marks.runout("flow_front_m"), color="0.6", lw=0.8, label=f"{foremost} of what flowed")
    axes[0].plot(t, marks.runout("coherent_front_m"), "C0", lw=1.0, ls="--", label="of what flowed, without gaps")
    axes[0].plot(t, marks.runout("flow_body_m"), "C3", lw=1.0, ls=":", label=f"{body} of what flowed")
    axes[0].axhline(0.0, color="0.3", lw=0.8)
    axes[0].set(ylabel="from the toe (m)", title=f"runout from the toe before the motion, x = {marks.toe:.1f} m; "
                f"flowed is what has moved more than {summary['flow_distance_m']:g} m")
    axes[0].legend(loc="best", fontsize=9)
    if summary.get("ground_before_m") is not None:
        axes[1].axhline(summary["ground_before_m"], color="0.3", lw=0.8, ls="--", label="before the motion")
        low, high = summary["footprint_m"]
        axes[1].plot(t, front["ground_m"], "C0", label=f"highest ground over the dam's footprint (x = {low:.0f} to {high:.0f} m)")
    followed = [name for name in front if name.endswith("_y_m") and name != "centre_y_m"]
    for index, name in enumerate(followed):
        axes[1].plot(t, front[name], color=f"C{index + 1}", lw=0.8, label=f"followed particle: {name[: -len('_y_m')].replace('_', ' ')}")
    axes[1].set_ylabel("y (m)")
    axes[1].legend(loc="best", fontsize=9)
    axes[2].semilogy(t, np.maximum(front["rms_speed_m_s"], 1e-6), "C0", label="root mean square")
    axes[2].semilogy(t, np.maximum(front["maximum_speed_m_s"], 1e-6), color="0.6", lw=0.8, label="largest")
    axes[2].set(ylabel="speed (m/s)", xlabel="time since the start of shaking (s)")
    axes[2].legend(loc="best")
    for axis in axes:
        axis.grid(alpha=0.3)
    style.save(figure, output)


def plot_energy(plt, ledger, start, output):
    names = {
        "kinetic_J": "kinetic",
        "elastic_J": "elastic (change)",
        "gravitational_J": "gravitational (change)",
        "plastic_J": "dissipated in the soil",
        "friction_J": "dissipated on the bed",
        "contact_J": "dissipated between soils",
        "damping_J": "damping",
        "external_J": "external work",
        "pore_pressure_J": "work of frozen pore pressure",
        "crowding_J": "work on crowded soil",
        "transfer_J": "lost between particles and grid",
        "impact_J": "lost in impacts",
    }
    figure, axis = plt.subplots(figsize=(9, 4.6))
    t = start + ledger["time_s"]
    for column, label in names.items():
        if column not in ledger:
            continue
        values = ledger[column]
        if "change" in label:
            values = values - values[0]
        if np.nanmax(np.abs(values), initial=0.0) > 0.0:
            axis.plot(t, values / 1e6, label=label, lw=1.3)
    axis.plot(t, ledger["residual_J"] / 1e6, "k:", label="residual of the balance")
    axis.axhline(0.0, color="0.6", lw=0.8)
    axis.set(xlabel="time since the start of shaking (s)", ylabel="energy per metre of dam (MJ/m)", title="energy ledger")
    axis.grid(alpha=0.3)
    axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    style.save(figure, output)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="results of mpm_stage")
    parser.add_argument("--case", type=Path, help="the case's folder, for plot.json")
    parser.add_argument("-o", "--output", type=Path, required=True)
    arguments = parser.parse_args()
    plt = style.pyplot()
    options = chain.plot_options(arguments.case)
    first, last, paths = runout.first_and_last(arguments.folder)
    view, palette = runout.runout_view(first, last, options), Palette(first)
    marks = Marks(first, arguments.folder)
    plot_handover(plt, first, view, palette, arguments.output / "handover.png")
    plot_displacement(plt, first, last, view, marks, arguments.output / "displacement_mpm.png")
    plot_stages(plt, paths, view, palette, marks, arguments.output / "runout.png")
    front = chain.series(arguments.folder / "front.csv")
    if front is not None:
        plot_front(plt, front, chain.summary(arguments.folder / "summary.json"), marks, arguments.output / "runout_front.png")
    flow_figures.plot_all(plt, paths, view, marks, arguments.folder, arguments.output)
    ledger = chain.series(arguments.folder / "ledger.csv")
    if ledger is not None:
        plot_energy(plt, ledger, first.time, arguments.output / "energy.png")


if __name__ == "__main__":
    main()
