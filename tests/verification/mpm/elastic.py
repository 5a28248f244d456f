"""Elastic bodies: rigid motion, vibration, large deformation, equilibrium under their own weight."""
import json
import math
import subprocess

import numpy as np

from lagrangian import TaylorGreenSolid
from reissner import hanging_beam
from runner import G, relative


def rigid_motion(r):
    run = r.run()
    first, last = run.frame(0), run.frame()
    time = run.summary["simulated_time_s"]
    moved = last["x"][:, :2] - first["x"][:, :2] - np.array([3.0, -1.5]) * time
    p = np.hypot(run.ledger["momentum_x_Ns"], run.ledger["momentum_y_Ns"])
    return [("largest error of position over distance", None, None, np.abs(moved).max() / (3.0 * time), 1e-11),
            ("change of momentum", None, None, np.abs(p / p[0] - 1).max(), 1e-12),
            ("largest stress over Young's modulus", None, None, np.abs(last["effective_stress"]).max() / 1e6, 1e-10)]


def orders(cells, errors):
    return [math.log(a / b) / math.log(n / m) for a, b, m, n in zip(errors, errors[1:], cells, cells[1:])]


def vibrating_bar(r):
    """u = A sin(pi x / 2L) sin(omega t), the bar carried across the grid's rows all the while."""
    scene = r.scene()
    amplitude = scene["particles"][0]["velocity_wave"]["amplitude"]
    omega = 0.5 * math.pi * math.sqrt(4e6 / 1000.0) / 8.0
    cells, errors, rows = (8, 16, 32, 64), [], []
    for n in cells:
        scene = r.scene()
        h = 8.0 / n
        scene["grid"]["cell_size"] = h
        scene["domain"]["high"][0] = 8.0 + 4 * h
        scene["particles"][0]["high"][1] = 2 * h
        scene["time"].update(end=2.2 * 2 * math.pi / omega, courant=4.0 / n)
        run = r.run(scene, f"cells{n}")
        first, last = run.frame(0), run.frame()
        x = first["x"][:, 0]
        exact = amplitude / omega * np.sin(math.pi * x / 16.0) * math.sin(omega * run.summary["simulated_time_s"])
        errors.append(math.sqrt(np.mean((last["x"][:, 0] - x - exact) ** 2)) / (amplitude / omega))
    for n, e in zip(cells, errors):
        print(f"     {n} cells: RMS of the displacement over the amplitude {e:.3g}")
    order = orders(cells, errors)
    rows.append(("2 minus the order between 16 and 64 cells", 0.5 * (order[1] + order[2]), 2.0,
                 max(0.0, 2.0 - 0.5 * (order[1] + order[2])), 0.1))
    scene = r.scene()
    scene["time"]["end"] = 20 * 2 * math.pi / omega
    scene["output"]["frame_interval"] = scene["time"]["end"]
    run = r.run(scene, "twenty_periods")
    energy = []
    for frame in (run.frame(0), run.frame()):
        v, m, s = frame["velocity"], frame["mass"], frame["effective_stress"]
        drift = v[:, 1] - np.average(v[:, 1], weights=m)
        energy.append(0.5 * np.sum(m * (v[:, 0] ** 2 + drift**2)) + 0.5 * np.sum(frame["volume"] * s[:, 0] ** 2) / 4e6)
    rows.append(("loss of energy over 20 periods, 32 cells", None, None, abs(energy[1] / energy[0] - 1), 0.01))
    return rows


def spinning_square(r):
    """A slow turn of an elastic square: the angle turned, and momenta and stress from the program linked to the core.
    Particles that started without the affine velocity of their spin would turn 4.6 % less with APIC."""
    rows = []
    for transfer in ("apic", "aflip"):
        scene = r.scene()
        scene["scheme"] = {"transfer": transfer}
        run = r.run(scene, transfer)
        first, last = run.frame(0), run.frame()
        omega, time = 0.5, run.summary["simulated_time_s"]
        a, b = (f["x"][:, :2] - np.average(f["x"][:, :2], axis=0, weights=f["mass"]) for f in (first, last))
        turned = math.atan2(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]), np.sum(a * b))
        error = math.remainder(turned - omega * time, 2 * math.pi)
        rows.append((f"angle over that of the spin, less 1{', APIC' if transfer == 'apic' else ''}", omega * time + error,
                     omega * time, abs(error / (omega * time)), 1e-3))
    return [*rows[::-1], *point_checks(r, "spinning_square")]


def point_checks(r, name):
    """Rows of a program that is linked to mpm_stage's own code."""
    text = subprocess.run([r.program.replace("mpm_stage", "verify_mpm_points"), name], check=True, capture_output=True,
                          text=True).stdout
    return [(row["quantity"], None, None, row["error"], row["ceiling"]) for row in json.loads(text)]


def manufactured(r):
    """A square of elastic material starts in the velocity field of Taylor and Green's vortex. The exact motion comes from
    a Fourier series in the body's own coordinates (lagrangian.py)."""
    scene = r.scene()
    solid = scene["materials"]["solid"]
    speed, end = 3.5, scene["time"]["end"]
    exact = TaylorGreenSolid(solid["youngs_modulus"], solid["poisson_ratio"], solid["density"], speed, modes=16)
    cells, errors = (16, 32, 64), []
    motion, stretch = exact.solve(end)
    for n in cells:
        scene = r.scene()
        scene["grid"]["cell_size"] = 1.0 / n

        def vortex(p):
            x, y = math.pi * p["x"][:, 0], math.pi * p["x"][:, 1]
            p["velocity"][:, 0] = speed * np.sin(x) * np.cos(y)
            p["velocity"][:, 1] = -speed * np.cos(x) * np.sin(y)

        particles = r.particles(scene, vortex)
        run = r.run(scene, f"cells{n}", particles)
        start = run.frame(0)["x"][:, :2]
        error = run.frame()["x"][:, :2] - motion(start)
        errors.append(math.sqrt(np.mean(np.sum(error**2, axis=1)) / np.mean(np.sum((motion(start) - start) ** 2, axis=1))))
        print(f"     {n} cells: RMS error of the displacement over its RMS {errors[-1]:.3g}")
    order = orders(cells, errors)
    print(f"     largest principal stretch {stretch:.3g}; orders {', '.join(f'{o:.2f}' for o in order)}")
    return [("2 minus the order between 16 and 64 cells", np.mean(order), 2.0, max(0.0, 2.0 - np.mean(order)), 0.2),
            ("RMS error of the displacement at 64 cells over its RMS", None, None, errors[-1], 0.02)]


def gravity_column(r):
    run = r.run()
    f = run.frame()
    y, m = f["x"][:, 1], f["mass"]
    order = np.argsort(-y)
    # Weight above each particle's centre over the width: the exact vertical stress of its deformed position.
    rows = {}
    for p in order:
        rows.setdefault(round(y[p], 3), []).append(p)
    above, error = 0.0, []
    for _, row in sorted(rows.items(), reverse=True):
        weight = G * m[row].sum()
        exact = -(above + 0.5 * weight)
        error += [f["effective_stress"][p, 1] - exact for p in row]
        above += weight
    rms = math.sqrt(np.mean(np.square(error))) / above
    return [("RMS of vertical stress over that of the bottom", None, None, rms, 0.005)]


def moving_bar(r):
    """Amplitude of the first free-free mode, bar carried over 64, 128 and 256 cells against the bar at rest."""
    rows, amplitudes = [], {}
    for cells in (0, 64, 128, 256):
        scene = r.scene()
        scene["particles"][0]["velocity"] = [cells * 0.25 / 0.5, 0]
        run = r.run(scene, f"cells{cells}")
        start = run.frame(0)["x"][:, 0]
        amplitudes[cells] = np.array([
            2 * np.average((f["velocity"][:, 0] - np.average(f["velocity"][:, 0])) * np.cos(math.pi * start / 8))
            for f in (run.frame(k) for k in range(len(run.frames())))])
        if cells:
            e = np.abs(amplitudes[cells] - amplitudes[0]).max() / 0.1
            rows.append((f"mode's velocity against the bar at rest, {cells} cells", None, None, e, 0.02))
    return rows


def cantilever_large(r):
    """A beam clamped in the left wall hangs under its own weight: tip against Reissner's beam (elastica with shear and
    stretch)."""
    scene, rows = r.scene(), []
    solid = scene["materials"]["beam"]
    length, depth = 10.0, 1.0
    x, y = hanging_beam(length, depth, solid["youngs_modulus"], solid["density"] * G)
    run = r.run()
    first, last = run.frame(0), run.frame()
    # The end's middle: a straight line through the last column of particles, carried to the end of the beam.
    columns = np.unique(np.round(first["x"][:, 0], 6))[-2:]
    inner, outer = (np.mean(last["x"][np.abs(first["x"][:, 0] - c) < 1e-4, :2], axis=0) for c in columns)
    tip = outer + (length - columns[1]) / (columns[1] - columns[0]) * (outer - inner)
    down, back = np.mean(first["x"][:, 1]) - tip[1], length - tip[0]
    rows.append(("drop of the tip over the length", down / length, -y / length, relative(down, -y), 0.02))
    rows.append(("shortening of the span over the length", back / length, (length - x) / length,
                 relative(back, length - x), 0.02))
    return rows
