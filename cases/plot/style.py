"""What all pictures of tailrun have in common: colours of materials, colour scales, fonts, saving."""

import os
from pathlib import Path

import numpy as np

ACCENT = "#c0392b"
REGION_COLOURS = {
    "tailings": "#e8d9a0",
    "embankment": "#9fc58f",
    "foundation": "#cfc6d6",
    "freefield_tailings": "#d9b96a",
    "freefield_foundation": "#b3a4c2",
}
SPARE_COLOURS = ["#a6cee3", "#fdbf6f", "#cab2d6", "#fb9a99", "#b2df8a", "#ffff99"]
LIQUEFIED_COLOURS = "YlGnBu"  # weak (shallow) to strong (deep) residual strength

RATIO_SCALE = {"cmap": "RdYlBu_r", "vmin": 0.0, "vmax": 1.0}  # r_u
DISPLACEMENT_COLOURS = "magma_r"
SPEED_COLOURS = "plasma"
WIDTH = 11.0  # inches; at 110 dots per inch about the width of a README


def pyplot():
    """matplotlib.pyplot without a display, with the toolchain's settings."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update(
        {
            "figure.facecolor": "white",
            "savefig.facecolor": "white",
            "figure.constrained_layout.use": True,
            "font.size": 10,
            "axes.titlesize": 11,
            "axes.grid": False,
            "legend.frameon": False,
            "image.cmap": "viridis",
        }
    )
    return plt


def save(figure, path):
    """Writes the picture under a temporary name, then renames it; closes the figure."""
    import matplotlib.pyplot as plt

    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name("." + path.name + ".part" + path.suffix)
    figure.savefig(temporary, dpi=110, bbox_inches="tight", pad_inches=0.12)
    os.replace(temporary, path)
    plt.close(figure)


def region_colour(name, index=0):
    return REGION_COLOURS.get(name, SPARE_COLOURS[index % len(SPARE_COLOURS)])


def material_colours(names):
    """A colour per material: that of its region's name."""
    return {name: region_colour(name, index) for index, name in enumerate(names)}


def nice_limit(value):
    """The next of 1, 2, 5 times a power of ten."""
    if not value > 0.0:
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    return float(next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= 0.98 * value))


def true_aspect(axis, view, labels=True):
    """Equal scales on both axes over view = (x_low, x_high, y_low, y_high)."""
    axis.set_aspect("equal")
    axis.set_xlim(view[0], view[1])
    axis.set_ylim(view[2], view[3])
    if labels:
        axis.set_xlabel("x (m)")
        axis.set_ylabel("y (m)")


def panel_height(view, width=WIDTH, extra=0.9):
    """Height (inches) of a figure whose single panel shows `view` at true aspect."""
    return (width - 1.6) * (view[3] - view[2]) / (view[1] - view[0]) + extra


def marker_area(figure, axis, size):
    """Marker area (points^2) of a square of `size` metres on a drawn axis with true aspect."""
    figure.canvas.draw()
    pixels = axis.transData.transform([[0.0, 0.0], [size, 0.0]])
    return max(((pixels[1, 0] - pixels[0, 0]) * 72.0 / figure.dpi) ** 2, 0.3)


def colour_bar(figure, mappable, axes, label, extend="neither"):
    """A slim bar below the panels, so that these keep the picture's width."""
    return figure.colorbar(mappable, ax=axes, orientation="horizontal", shrink=0.45, aspect=40, pad=0.02, label=label, extend=extend)
