"""The runout's panels: particles by material over the terrain. Shared by the pictures, the film and the overview."""

import numpy as np

import chain_files as chain
import field_plot as fields
import style


def extent(x):
    """Least and largest of x, but for drops that are far ahead of the rest: they would make all else too small to see."""
    near, far = np.quantile(x, [0.01, 0.99])
    margin = 0.5 * (far - near)
    return max(x.min(), near - margin), min(x.max(), far + margin)


def runout_view(first, last, options):
    """plot.json's runout_view, grown to hold the last frame's front; or what moved, with some ground before it."""
    moved = np.hypot(*(last.data["displacement"] - displacement_at_transfer(first, last))[:, :2].T)
    shown = moved > max(0.02 * moved.max(), 1e-9)
    reach = last.position[shown] if shown.any() else last.position
    if shown.any() and len(first.position) == len(shown):
        reach = np.concatenate([reach, first.position[shown]])
    left, right = extent(reach[:, 0])
    low, high = last.position.min(axis=0), last.position.max(axis=0)
    high = np.maximum(high, first.position.max(axis=0))
    if "runout_view" in options:
        view = list(options["runout_view"])
        view[1] = max(view[1], right + 20.0)
        return view
    height = high[1] - low[1]
    return [
        max(low[0], left - 2.0 * height),
        right + 2.0 * height,
        low[1] - 0.15 * height,
        high[1] + 0.2 * height,
    ]


def displacement_at_transfer(first, last):
    """The first frame's displacement, for every particle of the last: frames list particles in the same order."""
    if len(first.position) == len(last.position):
        return first.data["displacement"]
    # Particles have left the domain: rows no longer correspond, and only the displacement since the motion is known.
    return np.zeros_like(last.data["displacement"])


def draw_materials(figure, axis, particles, view, palette):
    fields.draw_terrain(axis, particles, view[2] - 1.0)
    style.true_aspect(axis, view)
    return fields.draw_particles(figure, axis, particles, palette.colours(particles))


def first_and_last(folder):
    paths = chain.frames(folder)
    return chain.Particles(paths[0]), chain.Particles(paths[-1]), paths
