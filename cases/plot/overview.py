"""The picture of the whole chain in three panels: r_u at the hand-over, the particles, the runout."""

import fem_figures
import field_plot as fields
import runout_plot as runout
import style
from palette import Palette


def plot_overview(plt, snapshot, first, last, marks, options, output):
    view = runout.runout_view(first, last, options)
    view = [view[0], view[1], view[2], max(view[3], fields.dam_view(snapshot, options)[3])]
    palette = Palette(first)
    height = style.panel_height(view, extra=0.45)
    figure, axes = plt.subplots(3, 1, figsize=(style.WIDTH, 3.0 * height + 1.3), sharex=True)
    mappable = fem_figures.draw_pressure_ratio(axes[0], snapshot, view)
    origin = "imported state" if snapshot.imported else "fem_stage"
    axes[0].set_title(f"{origin}: excess pore pressure ratio $r_u$ after {snapshot.time:g} s of shaking", loc="left")
    figure.colorbar(mappable, ax=axes[0], label="$r_u$ (1)", fraction=0.02, pad=0.01)
    for axis, particles, title in (
        (axes[1], first, f"hand-over: {len(first.position)} particles, the liquefied ones with the strength of this run"),
        (axes[2], last, f"mpm_stage: runout after {last.time - first.time:g} s more"),
    ):
        runout.draw_materials(figure, axis, particles, view, palette)
        axis.set_title(title, loc="left")
    marks.draw(axes[2], last.time, view)
    for axis in axes[:2]:
        axis.set_xlabel("")
    palette.legend(axes[2], first)
    style.save(figure, output)
