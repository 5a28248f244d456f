#!/usr/bin/python3
"""Runs a verification scene of mpm_stage and compares it with a closed form or an experiment.

verify.py MPM_STAGE SCENES_FOLDER NAME OUTPUT_FOLDER

Each check returns rows (quantity, found, wanted, error, tolerance). They are printed and added to the run's summary.json
under "verification"; the exit status is 1 when an error exceeds its tolerance.
"""
import csv
import json
import math
import os
import pathlib
import subprocess
import sys
import time

import h5py
import numpy as np

G = 9.81


class Run:
    """One finished run: its summary, series and frames."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.summary = json.loads((self.folder / "summary.json").read_text())
        with open(self.folder / "front.csv") as f:
            rows = list(csv.DictReader(f))
        self.front = {k: np.array([float(r[k]) for r in rows]) for k in rows[0]}
        with open(self.folder / "ledger.csv") as f:
            rows = list(csv.DictReader(f))
        self.ledger = {k: np.array([float(r[k]) for r in rows]) for k in rows[0]}

    def frames(self):
        return sorted((self.folder / "frames").glob("*.vtkhdf"))

    def frame(self, k=-1):
        with h5py.File(self.frames()[k]) as f:
            data = {name: f["VTKHDF/PointData"][name][()] for name in f["VTKHDF/PointData"]}
            data["x"] = f["VTKHDF/Points"][()]
        return data


class Runner:
    def __init__(self, program, scenes, name, output):
        self.program, self.name = program, name
        self.case = pathlib.Path(scenes) / name / "mpm.json"
        self.output = pathlib.Path(output)

    def scene(self):
        return json.loads(self.case.read_text())

    def run(self, scene=None, label=""):
        folder = self.output / label if label else self.output
        folder.mkdir(parents=True, exist_ok=True)
        for old in (folder / "frames").glob("*") if (folder / "frames").exists() else []:
            old.unlink()
        case = self.case
        if scene is not None:
            case = folder / "mpm.json"
            case.write_text(json.dumps(scene, indent=1))
        subprocess.run([self.program, "run", str(case), "-o", str(folder), "--quiet"], check=True)
        return Run(folder)


def relative(found, wanted):
    return abs(found / wanted - 1.0)


def rigid_motion(r):
    run = r.run()
    first, last = run.frame(0), run.frame()
    time = run.summary["simulated_time_s"]
    moved = last["x"][:, :2] - first["x"][:, :2] - np.array([3.0, -1.5]) * time
    p = np.hypot(run.ledger["momentum_x_Ns"], run.ledger["momentum_y_Ns"])
    return [("largest error of position over distance", None, None, np.abs(moved).max() / (3.0 * time), 1e-11),
            ("change of momentum", None, None, np.abs(p / p[0] - 1).max(), 1e-12),
            ("largest stress over Young's modulus", None, None, np.abs(last["effective_stress"]).max() / 1e6, 1e-10)]


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


def mu_block(r):
    run = r.run()
    travelled = run.front["centre_x_m"][-1] - run.front["centre_x_m"][0]
    wanted = 5.0**2 / (2 * 0.35 * G)
    return [("distance, m", travelled, wanted, relative(travelled, wanted), 0.01)]


def incline(r):
    rows = []
    for mu in (0.35, 0.6):
        for angle in (0, 5, 10, 15, 20, 25, 30, 35, 40, 45):
            beta = math.radians(angle)
            c, s = math.cos(beta), math.sin(beta)
            scene = r.scene()
            scene["particles"][0]["rotation"] = -angle
            scene["particles"][0]["stress"].update(surface_point=[s, c], angle=angle, shear_ratio=min(mu, s / c))
            scene["terrain"][0].update(points=[[-100 * c, 100 * s], [100 * c, -100 * s]], friction=mu)
            run = r.run(scene, f"mu{mu}_{angle}")
            t = run.front["time_s"]
            along = run.front["centre_x_m"] * c - run.front["centre_y_m"] * s
            wanted = max(0.0, G * (s - mu * c))
            late = t >= 0.3
            found = 2.0 * np.polyfit(t[late], along[late], 2)[0]
            if wanted > 0.0:
                rows.append((f"acceleration, mu {mu}, {angle} deg", found, wanted, relative(found, wanted), 0.01))
            else:
                drift = abs(along[-1] - along[t >= 0.3][0])
                rows.append((f"drift in cells when sticking, mu {mu}, {angle} deg", None, None, drift / 0.25, 0.001))
    return rows


def mean_stress_noise(frame, h):
    """RMS difference of a full cell's mean stress from the mean of its two neighbours, over the mean of all."""
    s, v = frame["effective_stress"], frame["volume"]
    mean = -(s[:, 0] + s[:, 1] + s[:, 2]) / 3.0
    cells = {}
    for p, key in enumerate(map(tuple, np.floor(frame["x"][:, :2] / h).astype(int))):
        c = cells.setdefault(key, [0.0, 0.0])
        c[0] += mean[p] * v[p]
        c[1] += v[p]
    value = {k: c[0] / c[1] for k, c in cells.items() if c[1] > 0.7 * h * h}
    d = [q - 0.5 * (value[i + a, j + b] + value[i - a, j - b]) for (i, j), q in value.items()
         for a, b in ((1, 0), (0, 1)) if (i + a, j + b) in value and (i - a, j - b) in value]
    return math.sqrt(np.mean(np.square(d))) / np.mean(list(value.values()))


def cohesive_block(r):
    rows, runout = [], []
    for courant in (0.1, 0.4, 0.8):
        scene = r.scene()
        scene["time"]["courant"] = courant
        run = r.run(scene, f"courant{courant}")
        runout.append(run.summary["runout_m"])
        total = run.ledger["kinetic_J"] + run.ledger["elastic_J"] + run.ledger["gravitational_J"]
        rows.append((f"energy above the start's, courant {courant}", None, None, (total.max() - total[0]) / total[0], 1e-3))
    spread = (max(runout) - min(runout)) / np.mean(runout)
    rows.append(("spread of the runout over time steps", None, None, spread, 0.03))
    noise = {}
    for average in (True, False):
        scene = r.scene()
        scene["scheme"] = {"volumetric_average": average}
        scene["materials"]["soil"]["poisson_ratio"] = 0.49
        scene["particles"][0]["stress"]["k0"] = 0.49 / 0.51
        run = r.run(scene, f"nu049_{'averaged' if average else 'plain'}")
        noise[average] = mean_stress_noise(run.frame(), 0.5)
    rows.append(("checkerboard at rest, averaged over plain", noise[True], noise[False], noise[True] / noise[False], 0.1))
    return rows


BUI_SURFACE = np.array(
    [(.00012, .09923), (.01960, .09928), (.03984, .09587), (.06004, .08900), (.08027, .08444), (.10008, .07756),
     (.12030, .07223), (.14013, .06651), (.16035, .06157), (.18016, .05392), (.19998, .04744), (.22020, .04249),
     (.24079, .03485), (.26219, .03067), (.28202, .02649), (.30224, .02154), (.32209, .01890), (.34231, .01357),
     (.36216, .01093), (.38240, .00790), (.40224, .00372), (.42209, .00224), (.44235, .00152)])


def surface_height(frame, x, h):
    near = np.abs(frame["x"][:, 0] - max(x, 0.5 * h)) < 0.75 * h
    return (frame["x"][near, 1] + 0.5 * np.sqrt(frame["volume"][near])).max() if near.any() else 0.0


def bui_2008(r):
    run = r.run()
    h = r.scene()["grid"]["cell_size"]
    frame = run.frame()
    error = np.array([surface_height(frame, x, h) - y for x, y in BUI_SURFACE])
    # The experiment's front is its last surveyed point, where 1.52 mm of material lie (a layer of particles has 1.25 mm).
    reach = np.arange(0.2, frame["x"][:, 0].max(), 0.25 * h)
    front = max(x for x in reach if surface_height(frame, x, h) >= BUI_SURFACE[-1][1])
    return [("RMS of the free surface over 0.1 m", None, None, math.sqrt(np.mean(error**2)) / 0.1, 0.04),
            ("front, m", front, 0.442, relative(front, 0.442), 0.04)]


def bingham_rest(r):
    run = r.run()
    volume, tau = 0.1, 20.0
    wanted = (1.5 * volume) ** (2 / 3) * (1000 * G / (2 * tau)) ** (1 / 3)
    found = run.summary["front_position_m"]
    return [("half length at rest, m", found, wanted, relative(found, wanted), 0.05)]


MARTIN_MOYCE = np.array(
    [(.832, 1.217), (1.219, 1.474), (1.997, 2.292), (2.547, 2.995), (3.345, 4.134), (4.034, 4.944), (4.418, 5.881),
     (5.091, 6.980), (5.685, 7.945), (6.306, 8.966), (6.822, 9.986), (7.439, 10.963), (8.031, 11.977)])


def martin_moyce(r):
    run = r.run()
    a = 0.05715
    t = run.front["time_s"] * math.sqrt(2 * G / a)
    z = run.front["robust_front_m"] / a
    data = MARTIN_MOYCE[MARTIN_MOYCE[:, 0] <= t[-1]]
    error = np.interp(data[:, 0], t, z) / data[:, 1] - 1
    return [("RMS of z/a over the experiment's", None, None, math.sqrt(np.mean(error**2)), 0.05)]


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


CHECKS = [rigid_motion, gravity_column, mu_block, incline, cohesive_block, bui_2008, bingham_rest, martin_moyce,
          moving_bar]


AGAINST = {"rigid_motion": "exact", "gravity_column": "closed form", "mu_block": "closed form", "incline": "closed form",
           "cohesive_block": "itself: time step, cell, energy", "bui_2008": "experiment, Bui et al. 2008",
           "bingham_rest": "closed form, shallow limit", "martin_moyce": "experiment, Martin & Moyce 1952",
           "moving_bar": "the bar at rest"}


def main():
    program, scenes, name, output = sys.argv[1:]
    check = {c.__name__: c for c in CHECKS}[name]
    start = time.perf_counter()
    rows = check(Runner(program, scenes, name, output))
    report = []
    for what, found, wanted, error, tolerance in rows:
        holds = bool(error <= tolerance)
        report.append(dict(quantity=what, found=found, wanted=wanted, error=float(error), tolerance=tolerance, holds=holds))
        print(f"{'ok  ' if holds else 'FAIL'} {name}: {what}"
              + (f" {found:.5g} (wanted {wanted:.5g})" if found is not None else "")
              + f" error {error:.3g}, tolerance {tolerance:g}")
    if folder := os.environ.get("TAILRUN_VERIFICATION_DIR"):  # for cases/collect_verification.py
        seconds = time.perf_counter() - start
        entries = [dict(name=f"mpm_{name}", row=name, quantity=row["quantity"], against=AGAINST[name], error=row["error"],
                        ceiling=row["tolerance"], seconds=seconds) for row in report]
        pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
        (pathlib.Path(folder) / f"mpm_{name}.json").write_text(json.dumps(entries, indent=1) + "\n")
    path = pathlib.Path(output) / "summary.json"
    summary = json.loads(path.read_text()) if path.exists() else {"title": name}
    summary["verification"] = report
    path.write_text(json.dumps(summary, indent=2) + "\n")
    sys.exit(0 if all(row["holds"] for row in report) else 1)


if __name__ == "__main__":
    main()
