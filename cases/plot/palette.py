"""Colours of the runout's particles: by material, and liquefied soil in shades of the strength that the run computes with."""

import numpy as np

import style

MOST_STEPS = 7  # strengths that a legend lists one by one; more are put into classes
CLASSES = 5


def kilopascal(value):
    return f"{value / 1e3:.3g}"


def strength_edges(strengths):
    """Edges (k + 1) of classes of strengths (Pa): one for each where there are few, else classes of equal numbers."""
    steps = np.unique(strengths)
    if len(steps) <= MOST_STEPS:
        middles = 0.5 * (steps[1:] + steps[:-1])
        return np.concatenate([steps[:1], middles, steps[-1:]])
    return np.unique(np.quantile(strengths, np.linspace(0.0, 1.0, CLASSES + 1)))


class Palette:
    """Made of one frame, it colours every frame of the run alike."""

    def __init__(self, particles):
        import matplotlib

        strength = self.strengths(particles)
        liquefied = strength > 0.0
        self.edges = strength_edges(strength[liquefied]) if liquefied.any() else np.zeros(2)
        count = max(len(self.edges) - 1, 1)
        map_ = matplotlib.colormaps[style.LIQUEFIED_COLOURS]
        self.shades = [matplotlib.colors.to_hex(map_(level)) for level in np.linspace(0.3, 0.95, count)]
        self.materials = style.material_colours(particles.material_names)

    @staticmethod
    def strengths(particles):
        return particles.data.get("residual_strength", np.zeros(len(particles.position)))

    def classes(self, particles):
        """Class of each particle's strength, -1 for soil without one."""
        strength = self.strengths(particles)
        found = np.clip(np.searchsorted(self.edges, strength, side="right") - 1, 0, len(self.shades) - 1)
        return np.where(strength > 0.0, found, -1)

    def colours(self, particles):
        by_material = np.array([self.materials[name] for name in particles.material_names])[particles.material()]
        classes = self.classes(particles)
        return np.where(classes >= 0, np.array(self.shades)[classes], by_material)

    def labels(self, particles):
        """(label, colour) of everything that there are particles of: by material, weak to strong."""
        strength, classes, found = self.strengths(particles), self.classes(particles), []
        for index, name in enumerate(particles.material_names):
            mask, words = particles.material() == index, name.replace("_", " ")
            if (mask & (classes < 0)).any():
                found.append((words, self.materials[name]))
            for number in np.unique(classes[mask & (classes >= 0)]):
                values = strength[mask & (classes == number)]
                low, high = kilopascal(values.min()), kilopascal(values.max())
                found.append((f"{words}, $s_R$ {low if low == high else f'{low} to {high}'} kPa", self.shades[number]))
        return found

    def legend(self, axis, particles):
        """The legend below a panel."""
        from matplotlib.patches import Patch

        handles = [Patch(color=colour, label=label) for label, colour in self.labels(particles)]
        return axis.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0.0), borderaxespad=3.8, ncol=4)
