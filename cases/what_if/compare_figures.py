"""The picture of runs over one another: ground at the end, depth of what flowed, front over time, mass that flowed over time."""

import numpy as np

import paths  # noqa: F401
import style
from runs import hand_over_time


def colours(count):
    """One colour a run; the first is black."""
    import matplotlib

    ten = matplotlib.colormaps["tab10"].colors
    more = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.95, max(count - 1, 1)))
    return ["black", *(ten if count <= 11 else more)][:count]


def window(runs):
    """x from where soil moved, with some ground before and behind."""
    moved = [(run.flow.x[run.flow.depth > 0.0].min(), run.flow.x[run.flow.depth > 0.0].max())
             for run in runs if run.flow is not None and (run.flow.depth > 0.0).any()]
    if not moved:
        flows = [run.flow for run in runs if run.flow is not None]
        return min(flow.x.min() for flow in flows), max(flow.x.max() for flow in flows)
    low, high = min(pair[0] for pair in moved), max(pair[1] for pair in moved)
    margin = 0.06 * (high - low)
    return low - margin, high + margin


def draw_profiles(axes, runs, shades):
    low, high = window(runs)
    first = next(run.flow for run in runs if run.flow is not None)
    axes[0].plot(first.x, first.initial_surface, color="0.5", lw=1.0, ls="--", label=f"at the hand-over ({next(r.name for r in runs if r.flow is not None)})")
    longest = max((run.flow for run in runs if run.flow is not None), key=lambda flow: len(flow.x))
    axes[0].plot(longest.x, longest.bed, color="#8b6b4a", lw=1.5, label="bed")
    for run, shade in zip(runs, shades):
        if run.flow is not None:
            axes[0].plot(run.flow.x, run.flow.surface, color=shade, lw=1.4, label=run.name)
            axes[1].plot(run.flow.x, run.flow.depth, color=shade, lw=1.4, label=run.name)
    shown = [surface[(run.flow.x >= low) & (run.flow.x <= high)] for run in runs if run.flow is not None
             for surface in (run.flow.surface, run.flow.initial_surface)]
    values = np.concatenate(shown)
    bottom, top = np.nanmin(values), np.nanmax(values)
    axes[0].set(xlim=(low, high), ylim=(bottom - 0.15 * (top - bottom), top + 0.1 * (top - bottom)), ylabel="y (m)",
                title="ground at the end (heights exaggerated)")
    axes[1].set(xlim=(low, high), ylabel="depth (m)", xlabel="x (m)", title="depth of what flowed")
    axes[1].set_ylim(bottom=0.0)


def draw_fronts(axes, runs, shades):
    for run, shade in zip(runs, shades):
        if run.front is None:
            continue
        time = hand_over_time(run) + run.front["time_s"]
        if "runout_m" in run.front:
            axes[0].plot(time, run.front["runout_m"], color=shade, lw=1.4, label=run.name)
        if "flowed_mass_kg" in run.front:
            axes[1].plot(time, run.front["flowed_mass_kg"] / 1e3, color=shade, lw=1.4, label=run.name)
    axes[0].set(xlabel="time since the start of shaking (s)", ylabel="from the toe (m)", title="runout")
    axes[1].set(xlabel="time since the start of shaking (s)", ylabel="mass per metre of dam (t)", title="mass that flowed")


def draw(runs, output):
    plt = style.pyplot()
    shades = colours(len(runs))
    with_flow = any(run.flow is not None for run in runs)
    layout = [["surface", "surface"], ["depth", "depth"]] if with_flow else []
    figure, axes = plt.subplot_mosaic([*layout, ["front", "mass"]], figsize=(style.WIDTH, 10.5 if with_flow else 4.5))
    if with_flow:
        draw_profiles((axes["surface"], axes["depth"]), runs, shades)
    draw_fronts((axes["front"], axes["mass"]), runs, shades)
    for axis in axes.values():
        axis.grid(alpha=0.3)
    handles, labels = axes["surface" if with_flow else "front"].get_legend_handles_labels()
    if labels:
        figure.legend(handles, labels, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncol=min(len(labels), 6))
    style.save(figure, output)
