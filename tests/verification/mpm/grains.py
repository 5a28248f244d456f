"""Grains whose friction grows with the rate of shear, mu(I): a steady flow, and the column of bars."""
import math

import numpy as np

from collapse import BUI_SURFACE, surface_height
from runner import G, relative


def bagnold_profile(scene, slope):
    """Velocity (m/s) over the height y (m) of a layer on a rough incline: I is the same at all depths, where mu(I) = tan
    slope, so the rate of shear grows with the root of the depth (Bagnold 1954; GDR MiDi 2004)."""
    beads, layer = scene["materials"]["beads"], scene["particles"][0]["high"][1]
    tan = math.tan(slope)
    inertial = beads["I_0"] * (tan - beads["mu_s"]) / (beads["mu_2"] - tan)
    weight = beads["density"] * G * math.cos(slope) / beads["grain_density"]
    scale = 2.0 / 3.0 * inertial / beads["grain_diameter"] * math.sqrt(weight)
    return lambda y: scale * (layer**1.5 - np.maximum(layer - y, 0.0) ** 1.5)


def layer_down(r, degrees, end, cell=None):
    """RMS of the velocity from Bagnold's over that of the surface, in the middle of a layer that starts with half of it.
    `end` (s): by then a one-dimensional solution from rest is within 1 % of the steady one."""
    scene, slope = r.scene(), math.radians(degrees)
    scene["grid"]["cell_size"] = cell or scene["grid"]["cell_size"]
    scene["time"]["end"] = scene["output"]["frame_interval"] = end
    scene["gravity"] = [G * math.sin(slope), -G * math.cos(slope)]
    layer, length = scene["particles"][0]["high"][1], scene["particles"][0]["high"][0]
    profile = bagnold_profile(scene, slope)

    def begin(p):
        y = p["x"][:, 1]
        p["velocity"][:, 0] = 0.5 * profile(y)
        p["effective_stress"][:, 3] = scene["materials"]["beads"]["density"] * G * math.sin(slope) * (layer - y)

    frame = r.run(scene, f"{degrees}deg_{scene['grid']['cell_size']}", r.particles(scene, begin)).frame()
    middle = np.abs(frame["x"][:, 0] - 0.5 * length) < layer
    error = frame["velocity"][middle, 0] - profile(frame["x"][middle, 1])
    return math.sqrt(np.mean(error**2)) / profile(layer)


def bagnold(r):
    """Three slopes between those on which the layer stops (20.8 deg) and on which it accelerates without end (32.6 deg)."""
    rows = [(f"RMS of the velocity over the surface's, {degrees} deg, 10 cells", None, None, layer_down(r, degrees, end), 0.03)
            for degrees, end in ((24, 0.45), (26, 0.7), (28, 1.1))]
    for cell in (0.005, 0.004):
        error = layer_down(r, 26, 0.7, cell)
        rows.append((f"RMS of the velocity over the surface's, 26 deg, {0.02 / cell:.0f} cells", None, None, error, 0.03))
    return rows


def bui_mu_i(r):
    """The column of bui_2008 with mu(I), on 5, 2.5 and 1.25 mm, the last as large as a bar. The front is that of 99.9 % of
    the mass."""
    cells, fronts, surface = (0.005, 0.0025, 0.00125), [], []
    for h in cells:
        scene = r.scene()
        scene["grid"]["cell_size"] = h
        run = r.run(scene, f"cell{h}")
        frame = run.frame()
        fronts.append(run.front["robust_front_m"][-1])
        error = [surface_height(frame, x, h) - y for x, y in BUI_SURFACE]
        surface.append(math.sqrt(np.mean(np.square(error))) / 0.1)
        reach = np.arange(0.2, frame["x"][:, 0].max(), 0.25 * h)
        thick = max(x for x in reach if surface_height(frame, x, h) >= BUI_SURFACE[-1][1])
        print(f"     cells of {1e3 * h} mm: front {fronts[-1]:.4f} m, to 1.52 mm of bars {thick:.4f} m, surface {surface[-1]:.4f}")
    return [("RMS of the free surface over 0.1 m, 1.25 mm", None, None, surface[-1], 0.04),
            ("front, m, 1.25 mm", fronts[-1], 0.442, relative(fronts[-1], 0.442), 0.06),
            ("change of the front from 2.5 to 1.25 mm", None, None, relative(fronts[-1], fronts[-2]), 0.04)]
