"""How fast and how deep it flowed: speeds at four moments, the final ground and flow depth (with a CSV), discharge at sections."""

import numpy as np

import chain_files as chain
import field_plot as fields
import profile_of_flow
import style


def speed_of(particles):
    return np.linalg.norm(particles.data["velocity"], axis=1)


def plot_speed(plt, paths, view, marks, output):
    """Speeds on one scale, at the same moments as the runout's stages but for the end, where all rests, and with the fastest."""
    strong = [np.percentile(speed_of(chain.Particles(path)), 99) for path in paths]
    last = len(paths) - 1
    chosen = sorted({0, max(1, last // 8), max(1, last // 3), int(np.argmax(strong))}) if last > 0 else [0]
    limit = style.nice_limit(max(max(strong), 1e-3))
    height = style.panel_height(view, extra=0.35)
    figure, axes = plt.subplots(len(chosen), 1, figsize=(style.WIDTH, len(chosen) * height + 1.0), sharex=True, squeeze=False)
    for axis, index in zip(axes[:, 0], chosen):
        particles = chain.Particles(paths[index])
        fields.draw_terrain(axis, particles, view[2] - 1.0)
        style.true_aspect(axis, view)
        mappable = fields.draw_particles(figure, axis, particles, speed_of(particles), cmap=style.DISPLACEMENT_COLOURS, vmin=0.0, vmax=limit)
        marks.draw(axis, particles.time, view)
        axis.set_xlabel("")
        axis.text(0.99, 0.94, f"t = {particles.time:g} s", transform=axis.transAxes, ha="right", va="top")
    axes[-1, 0].set_xlabel("x (m)")
    style.colour_bar(figure, mappable, axes[:, 0].tolist(), "speed (m/s)", extend="max")
    style.save(figure, output)


def plot_profile(plt, flow, marks, end, output):
    """Ground before and after, and the depth of what flowed."""
    figure, axes = plt.subplots(2, 1, figsize=(style.WIDTH, 5.2), sharex=True, height_ratios=(2, 1))
    axes[0].plot(flow.x, flow.initial_surface, color="0.4", ls="--", lw=1.0, label="ground at the hand-over")
    axes[0].plot(flow.x, flow.surface, "C3", lw=1.3, label=f"ground at the end, t = {end:g} s")
    axes[0].plot(flow.x, flow.bed, color="0.2", lw=1.3, label="bed")
    axes[0].set(ylabel="y (m)", title=f"final ground and flow depth: {flow.released_volume:.4g} m$^3$ per metre of dam flowed")
    axes[1].fill_between(flow.x, 0.0, flow.depth, step="mid", color="C3", alpha=0.4)
    axes[1].set(ylabel="flow depth (m)", xlabel="x (m)")
    for axis in axes:
        axis.grid(alpha=0.3)
        if marks.toe is not None and marks.along_x:
            axis.axvline(marks.toe, color="0.3", lw=0.8, ls=":")
    if marks.toe is not None and marks.along_x:
        axes[1].text(marks.toe, axes[1].get_ylim()[1], " toe before", va="top", fontsize=9)
    axes[0].legend(loc="best", fontsize=9)
    style.save(figure, output)


PANELS = [("discharge", "discharge\n({}/s)"), ("depth", "depth (m)"), ("area", "area (m$^2$)"), ("speed", "speed (m/s)"),
          ("passed_volume", "passed ({})")]
UNITS = ["_m2_s", "_m3_s", "_m", "_m2", "_m_s", "_m3"]


def plot_sections(plt, series, start, output):
    """sections.csv: discharge, depth (in 3-D the flow's area), speed and what has passed, a line for each section."""
    names = [key[: -len("_speed_m_s")] for key in series if key.endswith("_speed_m_s")]
    plane = f"{names[0]}_depth_m" in series
    panels = [(what, label) for what, label in PANELS if what != ("area" if plane else "depth")]
    figure, axes = plt.subplots(len(panels), 1, figsize=(9, 8.6), sharex=True)
    for axis, (what, label) in zip(axes, panels):
        for name in names:
            column = next(f"{name}_{what}{unit}" for unit in UNITS if f"{name}_{what}{unit}" in series)
            axis.plot(start + series["time_s"], series[column], lw=1.2, label=name)
        axis.set_ylabel(label.format("m$^2$" if plane else "m$^3$"))
        axis.grid(alpha=0.3)
    axes[0].set_title("soil that flows through sections" + (", per metre of width" if plane else ""))
    axes[0].legend(loc="best", fontsize=9)
    axes[-1].set_xlabel("time since the start of shaking (s)")
    style.save(figure, output)


def plot_all(plt, paths, view, marks, folder, output):
    """speed.png, in plane strain flow_depth.png with flow_depth.csv, and sections.png where the case names sections."""
    plot_speed(plt, paths, view, marks, output / "speed.png")
    summary = chain.summary(folder / "summary.json") or {}
    flow = profile_of_flow.of_frames(folder, summary.get("flow_distance_m", profile_of_flow.FLOW_DISTANCE))
    if flow is not None:
        profile_of_flow.write(output / "flow_depth.csv", flow)
        plot_profile(plt, flow, marks, chain.Particles(paths[-1]).time, output / "flow_depth.png")
    sections = chain.series(folder / "sections.csv")
    if sections is not None:
        plot_sections(plt, sections, marks.start, output / "sections.png")
