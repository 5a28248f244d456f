#!/usr/bin/python3
"""Runs a verification scene of fem_stage and compares it with a closed form or with OpenSees' tables.

verify.py FEM_STAGE REPOSITORY CHECK OUTPUT_FOLDER

Each check returns one row (row of the verification table, quantity, error, ceiling). It is printed, written to
<test>.json in the folder that TAILRUN_VERIFICATION_DIR names, if any, and the exit status is 1 when the error exceeds
its ceiling. Closed forms are written out here and nowhere in the program.
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


class State:
    """One state file: arrays by name."""

    def __init__(self, path):
        with h5py.File(path) as f:
            self.x = f["VTKHDF/Points"][()][:, :2]
            self.quads = f["VTKHDF/Connectivity"][()].reshape(-1, 4)
            self.node = {name: f["VTKHDF/PointData"][name][()] for name in f["VTKHDF/PointData"]}
            self.cell = {name: f["VTKHDF/CellData"][name][()] for name in f["VTKHDF/CellData"]}
        self.centre = self.x[self.quads].mean(axis=1)


class Runner:
    def __init__(self, program, root, output):
        self.program, self.root, self.output = program, pathlib.Path(root).resolve(), pathlib.Path(output).resolve()

    def scene(self, case):
        return json.loads((self.root / "cases/verification" / case).read_text())

    def table(self, name):
        with open(self.root / "tests/data/opensees" / name) as f:
            return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(f)]

    def empty_folder(self, label):
        folder = self.output / label
        folder.mkdir(parents=True, exist_ok=True)
        for old in folder.glob("*"):
            old.unlink()
        return folder

    def run(self, case, change=None, label="run", size=None):
        """Runs a scene, changed by `change` and with the `size` of its mesh where given. Returns its folder."""
        folder = self.empty_folder(label)
        path = self.root / "cases/verification" / case
        if change is not None:
            scene = self.scene(case)
            change(scene)
            path = folder / "fem.json"
            path.write_text(json.dumps(scene, indent=1))
        command = [self.program, "run", str(path), "-o", str(folder), "--quiet", "--threads", "1"]
        subprocess.run(command + (["--size", size] if size else []), check=True)
        return folder


def snapshots(folder):
    files = sorted(folder.glob("snapshot_t*.h5"), key=lambda p: float(p.stem.split("_t")[1]))
    return [State(p) for p in files]


def history(folder):
    with open(folder / "history.csv") as f:
        rows = list(csv.DictReader(f))
    return {k: np.array([float(r[k]) for r in rows]) for k in rows[0]}


def patch_test(r):
    s = snapshots(r.run("patch_test/fem.json"))[-1]
    scene = r.scene("patch_test/fem.json")
    young, nu = scene["materials"]["soil"]["youngs_modulus"], scene["materials"]["soil"]["poisson_ratio"]
    sxx, syy, sxy = 10e3, -7e3, 4e3  # the scene's tractions
    exx = (1 + nu) / young * ((1 - nu) * sxx - nu * syy)
    eyy = (1 + nu) / young * ((1 - nu) * syy - nu * sxx)
    gamma = 2 * (1 + nu) / young * sxy
    x, y = s.x.T
    wanted = np.stack([exx * x + gamma * y, eyy * y], axis=1)  # the bottom does not turn
    u = np.abs(s.node["displacement"][:, :2] - wanted).max() / np.abs(wanted).max()
    p0, px, py = scene["boundaries"]["held_pressure"][0]["pressure"]
    pressure = p0 + px * x + py * y
    p = np.abs(s.node["pore_pressure"] - pressure).max() / np.abs(pressure).max()
    return "patch_test", "largest error of displacement and pore pressure over their largest values", max(u, p), 1e-12


def tip(s):
    return s.node["displacement"][np.abs(s.x[:, 0] - 10.0) < 1e-9, 1].mean()


def cantilever_timoshenko(r):
    """Plane strain: E' = E/(1 - nu^2); shear factor 5/6."""
    force, length, depth, young, nu = 10e3, 10.0, 2.0, 1e8, 0.3
    inertia, plane, shear = depth**3 / 12, young / (1 - nu**2), young / (2 * (1 + nu))
    wanted = -(force * length**3 / (3 * plane * inertia) + force * length / (5 / 6 * shear * depth))
    found = tip(snapshots(r.run("cantilever/fem.json"))[-1])
    quantity = f"tip deflection, regular mesh: {found:.6g} m for {wanted:.6g} m"
    return "cantilever", quantity, abs(found / wanted - 1), 0.03


def cantilever_opensees(r):
    """Every displacement of both meshes. The scenes have OpenSees' hourglass integrals."""
    worst = 0.0
    for case, table in (("fem", "regular"), ("distorted", "distorted")):
        s = snapshots(r.run(f"cantilever/{case}.json", label=table))[-1]
        peer = {(round(n["x_m"], 6), round(n["y_m"], 6)): (n["ux_m"], n["uy_m"])
                for n in r.table(f"cantilever_{table}_nodes.csv")}
        wanted = np.array([peer[round(x, 6), round(y, 6)] for x, y in s.x])
        worst = max(worst, np.abs(s.node["displacement"][:, :2] - wanted).max() / np.abs(wanted).max())
    return "cantilever", "displacements, regular and distorted, over the tip's", worst, 1e-6


def terzaghi(depth, time_factor, height):
    """Pore pressure over the load, `depth` below the drained face (Terzaghi 1925)."""
    odd = 2 * np.arange(400) + 1
    z = np.asarray(depth)[..., None]
    return np.sum(4 / (math.pi * odd) * np.sin(odd * math.pi * z / (2 * height))
                  * np.exp(-(odd * math.pi) ** 2 * time_factor / 4), axis=-1)


def consolidation_coefficient(young, nu, permeability, fluid_modulus, porosity):
    """c_v with compressible water, and the share of a load that the water takes at first."""
    oedometric = young * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    water = fluid_modulus / porosity
    return permeability / 9810.0 / (1 / oedometric + 1 / water), water / (water + oedometric)


def terzaghi_series(r):
    scene = r.scene("terzaghi/fem.json")
    soil = scene["materials"]["soil"]
    cv, share = consolidation_coefficient(soil["youngs_modulus"], soil["poisson_ratio"], 1e-6,
                                          scene["fluid"]["bulk_modulus"], soil["porosity"])
    error = 0.0
    for s, t in zip(snapshots(r.run("terzaghi/fem.json")), scene["output"]["snapshots"]):
        wanted = share * terzaghi(10.0 - s.x[:, 1], cv * t / 100.0, 10.0)
        error = max(error, np.abs(s.node["pore_pressure"] / 100e3 - wanted).max())
    return "terzaghi", "pore pressure at all nodes and times T_v 0.01 to 1, over the load", error, 0.01


def terzaghi_opensees(r):
    def compatible(scene):
        scene["element"] = {"pressure_quadrature": 1}
        scene["shake"]["newmark"] = {"gamma": 1, "beta": 0.5, "theta": 1}

    error = 0.0
    table = r.table("consolidation_top.csv")
    times = r.scene("terzaghi/fem.json")["output"]["snapshots"]
    for s, t in zip(snapshots(r.run("terzaghi/fem.json", compatible)), times):
        peer = {round(n["y_m"], 4): n["p_kPa"] * 1e3 for n in table if abs(n["t_s"] - t) < 1e-3 * t}
        wanted = np.array([peer[round(y, 4)] for y in s.x[:, 1]])
        error = max(error, np.abs(s.node["pore_pressure"] - wanted).max() / 100e3)
    return "terzaghi", "pore pressure in the compatible mode, over the load", error, 1e-4


def terzaghi_order(r, theta, wanted):
    """From three step lengths: log2 of the ratio of successive changes. The load rises within T_v = 0.1, so that the
    solution is smooth in time."""
    pressures = []
    for steps in (60, 120, 240):
        def smooth(scene, steps=steps):
            scene["loads"][0]["history"] = {"type": "ramp", "duration": 8175}
            scene["shake"].update(duration=24525, time_step=24525 / steps,
                                  newmark={"gamma": theta, "beta": 0.25 * (theta + 0.5) ** 2, "theta": theta},
                                  solver={"tolerance": 1e-12})
            scene["output"] = {"snapshots": [24525], "history_interval": 24525}
        pressures.append(snapshots(r.run("terzaghi/fem.json", smooth, f"steps{steps}"))[-1].node["pore_pressure"])
    a, b, c = pressures
    order = math.log2(np.linalg.norm(a - b) / np.linalg.norm(b - c))
    quantity = f"order in time with theta {theta:g}: {order:.4g}, falls short of {wanted} by"
    return "terzaghi", quantity, wanted - order, 0.1


def terzaghi_order_1(r):
    return terzaghi_order(r, 1.0, 1)


def terzaghi_order_2(r):
    return terzaghi_order(r, 0.5, 2)


def sealed_element(r):
    s = snapshots(r.run("sealed_element/fem.json"))[-1]
    wanted = 10e3 * consolidation_coefficient(1e7, 0.3, 0.0, 2e7, 0.4)[1]  # 7878.8 Pa
    error = np.abs(s.node["pore_pressure"] / wanted - 1).max()
    return "sealed_element", f"pore pressure, {wanted:.1f} Pa wanted", error, 1e-4


def sealed_column(r):
    s = snapshots(r.run("sealed_element/column.json"))[-1]
    cv, share = consolidation_coefficient(1e7, 0.3, 1e-5, 2e7, 0.4)
    t = r.scene("sealed_element/column.json")["shake"]["duration"]
    wanted = 10e3 * share * terzaghi(10.0, cv * t / 100.0, 10.0)  # 7479.4 Pa at T_v = 0.1
    found = s.node["pore_pressure"][s.x[:, 1] < 1e-9].mean()
    return ("sealed_element", f"base pore pressure of 20 elements at T_v 0.1: {found:.1f} Pa for {wanted:.1f} Pa",
            abs(found / wanted - 1), 1e-4)


def hydrostatic(r):
    s = State(r.run("hydrostatic/fem.json") / "geostatic.h5")
    wanted = 9810.0 * (10.0 - s.x[:, 1])
    error = np.abs(s.node["pore_pressure"] - wanted).max() / 98100.0
    return "hydrostatic, k0", "pore pressure over its largest", error, 1e-8


def k0(r):
    s = State(r.run("k0/fem.json") / "geostatic.h5")
    y = s.centre[:, 1]
    buoyant = np.where(y > 10, 870 * (15 - y), 870 * 5 + 1000 * (10 - y))
    vertical = np.abs(-s.cell["effective_stress"][:, 1] / (9.81 * buoyant) - 1).max()
    ratio = np.abs(s.cell["effective_stress"][:, 0] / s.cell["effective_stress"][:, 1] / 0.45 - 1).max()
    return "hydrostatic, k0", "vertical effective stress and its K0", max(vertical, ratio), 1e-6


def wave_absorption(r):
    """The surface has twice the incident 0.1 m/s; a reflection by the base would come back after 2 H/V_s = 0.6 s."""
    h = history(r.run("wave_absorption/fem.json"))
    t, v = h["time_s"], h["surface_vx_m_s"]
    return "wave_absorption", "reflected shear wave over the incident", np.abs(v[t > 1.0]).max() / 0.2, 0.01


def wave_absorption_p(r):
    """Down from the surface; a reflection by the base would come back after 2 H/V_p = 0.32 s."""
    h = history(r.run("wave_absorption/p_wave.json"))
    t, v = h["time_s"], h["surface_vy_m_s"]
    incident = 10e3 / (1900 * 200 * math.sqrt(3.5))
    error = np.abs(v[t > 0.36]).max() / 2 / incident
    return "wave_absorption", "reflected pressure wave over the incident", error, 0.01


def amplifications(r, case):
    """Surface over outcrop motion, found and wanted, up to 20 Hz = 10 elements per wavelength: a layer with stiffness
    proportional damping on elastic rock (Kelvin-Voigt: G (1 + i w a1))."""
    h = history(r.run(case))
    motion = np.genfromtxt(r.root / "cases/verification/site_transfer/motion.csv", delimiter=",", skip_header=1)
    dt, n = h["time_s"][1] - h["time_s"][0], 1 << 15
    outcrop = np.interp(h["time_s"], motion[:, 0], motion[:, 1], right=0.0)
    f = np.fft.rfftfreq(n, dt)
    band = (f >= 0.3) & (f <= 20.0)
    found = np.abs(np.fft.rfft(h["surface_ax_m_s2"], n))[band] / np.abs(np.fft.rfft(outcrop, n))[band]
    f = f[band]
    a1 = 2 * 0.03 / (2 * math.pi * 5)
    velocity = np.sqrt(76e6 * (1 + 2j * math.pi * f * a1) / 1900)
    k, impedance = 2 * math.pi * f / velocity, 1900 * velocity / (2400 * 760)
    return found, 1 / np.abs(np.cos(k * 20) + 1j * impedance * np.sin(k * 20))


def site_transfer(r):
    found, wanted = amplifications(r, "site_transfer/fem.json")
    error = np.abs(found - wanted).max() / wanted.max()
    return "site_transfer", "amplification of the surface over the outcrop, over its largest", error, 0.02


def site_transfer_averaged(r):
    found, wanted = amplifications(r, "site_transfer/averaged.json")
    error = np.abs(found / wanted - 1).max()
    quantity = "averaged mass, no numerical damping: amplification, relative at every frequency"
    return "site_transfer", quantity, error, 0.02


def pond(r):
    s = State(r.run("hydrostatic/pond.json") / "geostatic.h5")
    wanted = 9810.0 * (15.0 - s.x[:, 1])
    water = np.abs(s.node["pore_pressure"] - wanted).max() / wanted.max()
    soil = np.abs(-s.cell["effective_stress"][:, 1] / (9.81 * 900 * (10 - s.centre[:, 1])) - 1).max()
    return "hydrostatic, k0", "pore pressure and vertical effective stress under a pond", max(water, soil), 1e-8


def free_field(r):
    """Surface, side and depth of a block move as the column beside it does."""
    h = history(r.run("free_field/fem.json"))
    error = max(np.abs(h[f"{a}_{v}_m_s"] - h[f"{b}_{v}_m_s"]).max() / np.abs(h[f"{b}_vx_m_s"]).max()
                for a, b in (("side", "column"), ("middle", "column"), ("middle_depth", "column_depth"))
                for v in ("vx", "vy"))
    return "free_field", "velocity between side dashpots, over the free field's largest", error, 0.01


def consolidation(r):
    """The consolidate command from T_v 0.01 to 0.3 against the series that terzaghi_series uses."""
    def short(scene):
        scene["shake"]["duration"] = 817.5
        scene["output"]["snapshots"] = [817.5]
        scene["consolidation"] = {"duration": 24525 - 817.5, "first_step": 20, "largest_step": 400, "growth": 1.5,
                                  "ratio_limit": 0}

    folder = r.run("terzaghi/fem.json", short)
    after = r.empty_folder("consolidation")
    subprocess.run([r.program, "consolidate", str(folder / "fem.json"), "--mesh", str(folder / "mesh.msh"), "--from",
                    str(folder / "snapshot_t817.500.h5"), "-o", str(after), "--quiet", "--threads", "1"], check=True)
    s = State(after / "consolidated.h5")
    soil = r.scene("terzaghi/fem.json")["materials"]["soil"]
    cv, share = consolidation_coefficient(soil["youngs_modulus"], soil["poisson_ratio"], 1e-6, 2.2e9, soil["porosity"])
    wanted = share * terzaghi(10.0 - s.x[:, 1], cv * 24525 / 100.0, 10.0)
    error = np.abs(s.node["pore_pressure"] / 100e3 - wanted).max()
    return "terzaghi", "pore pressure after the consolidate command at T_v 0.3, over the load", error, 0.01


def restart(r):
    """A run in a piece against one that goes on from its snapshot: elastic, so that nothing magnifies rounding."""
    error = 0.0
    for base in ("lysmer_dashpot", "rigid"):
        def halves(scene, base=base):
            if base == "rigid":
                scene["boundaries"]["base"] = {"line": "bottom", "type": "rigid"}
            scene["shake"].update(motion=str(r.root / "cases/verification/wave_absorption/motion.csv"), duration=1,
                                  large_displacement=True, solver={"tolerance": 1e-9})
            scene["output"] = {"snapshots": [0.6, 1], "history_interval": 0.1}

        whole = r.run("wave_absorption/fem.json", halves, base)
        rest = r.empty_folder(f"{base}_rest")
        subprocess.run([r.program, "shake", str(whole / "fem.json"), "--mesh", str(whole / "mesh.msh"), "--from",
                        str(whole / "snapshot_t00.600.h5"), "-o", str(rest), "--quiet", "--threads", "1"], check=True)
        a, b = State(whole / "snapshot_t01.000.h5"), State(rest / "snapshot_t01.000.h5")
        for name in ("displacement", "velocity"):
            error = max(error, np.abs(a.node[name] - b.node[name]).max() / np.abs(a.node[name]).max())
    return "restart", "displacement and velocity of a run cut in two, over their largest", error, 1e-6


def soft_modulus(scene):
    s = scene["above_phreatic_line"]["saturation"]
    return 1 / (s / 2.2e9 + (1 - s) / 101325)


def soft_fluid_squeeze(r):
    """Undrained 1-D: each half takes its share K/n / (K/n + M) of the load. Nodes 2.5 m and more from the line, where
    the pressure field turns from one share to the other."""
    scene, load, water = r.scene("soft_fluid/fem.json"), 10e3, 2.2e9
    start, end = snapshots(r.run("soft_fluid/fem.json"))
    rise = end.node["pore_pressure"] - start.node["pore_pressure"]
    oedometric = 1e7 * 0.75 / (1.25 * 0.5)
    error = 0.0
    for half, modulus in ((end.x[:, 1] >= 7.5, soft_modulus(scene)), (end.x[:, 1] <= 2.5, water)):
        wanted = load * modulus / 0.4 / (modulus / 0.4 + oedometric)
        error = max(error, np.abs(rise[half] / wanted - 1).max())
    return "soft_fluid", "rise of pore pressure above and below the line, squeezed undrained", error, 1e-4


def risen(r):
    """States at rest, on the way and at the end of the consolidation that lets the water level rise."""
    folder, case = r.empty_folder("rise"), str(r.root / "cases/verification/soft_fluid/rise.json")
    for command in (["mesh"], ["geostatic"], ["consolidate", "--from", str(folder / "geostatic.h5")]):
        subprocess.run([r.program, command[0], case, *command[1:], "-o", str(folder), "--quiet", "--threads", "1"],
                       check=True)
    return [State(folder / "geostatic.h5")] + snapshots(folder) + [State(folder / "consolidated.h5")]


def soft_fluid_rise(r):
    """The water level in the end, found from the volume of water alone: what the skeleton gave is what the pores took."""
    scene, load, water, oedometric = r.scene("soft_fluid/rise.json"), 50e3, 2.2e9, 1e7 * 0.75 / (1.25 * 0.5)
    end = risen(r)[-1]
    y = (np.arange(100000) + 0.5) * 1e-4
    before = np.maximum(9810 * (5 - y), 0.0)

    def surplus(level):
        after = 9810 * (level - y)
        strain = (-load + np.maximum(after, 0) - before) / oedometric
        return np.mean(strain + 0.4 / np.where(y > 5, soft_modulus(scene), water) * (after - before))

    low, high = 5.0, 10.0
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if surplus(middle) < 0 else (low, middle)
    found = end.node["pore_pressure"][end.x[:, 1] < 1e-9].mean() / 9810
    quantity = f"rise of the water level into the dry zone: {found - 5:.4f} m for {low - 5:.4f} m"
    return "soft_fluid", quantity, abs((found - 5) / (low - 5) - 1), 0.01


def soft_fluid_conservation(r):
    """All along: water in the pores plus the room that the skeleton gave, over what has crossed the line."""
    scene = r.scene("soft_fluid/rise.json")
    start, *later = risen(r)
    error = 0.0
    for s in later:
        x, u = s.x[s.quads], s.node["displacement"][:, :2][s.quads]
        area = lambda q: 0.5 * np.sum(q[:, :, 0] * np.roll(q[:, :, 1], -1, 1) - np.roll(q[:, :, 0], -1, 1) * q[:, :, 1], 1)
        volume = area(x)
        small = 1e-3  # the small-strain volume change from a scaled displacement
        swelling = (area(x + small * u) - area(x - small * u)) / (2 * small)
        above = s.centre[:, 1] > 5
        change = (s.node["pore_pressure"] - start.node["pore_pressure"])[s.quads].mean(axis=1)
        gain = swelling + volume * 0.4 / np.where(above, soft_modulus(scene), 2.2e9) * change
        error = max(error, abs(gain.sum()) / gain[above].sum())
    return "soft_fluid", "water lost or made, over what has risen across the phreatic line", error, 1e-6


# What each check compares with.
SERIES = "Terzaghi's (1925) series, compressible water"
CHECKS = {
    patch_test: "linear fields, closed form",
    cantilever_timoshenko: "Timoshenko beam, plane strain",
    cantilever_opensees: "OpenSees, SSPquad, same meshes",
    terzaghi_series: SERIES,
    terzaghi_opensees: "OpenSees, SSPquadUP, same mesh",
    terzaghi_order_1: "order of the theta method",
    terzaghi_order_2: "order of the theta method",
    sealed_element: "undrained share of the load, closed form",
    sealed_column: SERIES,
    hydrostatic: "water's weight, closed form",
    k0: "buoyant weight and prescribed K0, closed form",
    wave_absorption: "no reflection",
    wave_absorption_p: "no reflection",
    site_transfer: "damped layer on elastic rock, closed form",
    site_transfer_averaged: "damped layer on elastic rock, closed form",
    pond: "water's and buoyant weight, closed form",
    free_field: "the column beside it",
    consolidation: SERIES,
    restart: "the run in one piece",
    soft_fluid_squeeze: "undrained share of the load, closed form",
    soft_fluid_rise: "volume of water, closed form",
    soft_fluid_conservation: "volume of water",
}


def main():
    program, root, name, output = sys.argv[1:]
    check = next(c for c in CHECKS if c.__name__ == name)
    start = time.time()
    row, quantity, error, ceiling = check(Runner(program, root, output))
    record = {"name": f"fem_{name}", "row": row, "quantity": quantity, "against": CHECKS[check],
              "error": float(error), "ceiling": ceiling, "seconds": time.time() - start}
    folder = os.environ.get("TAILRUN_VERIFICATION_DIR")
    if folder:
        (pathlib.Path(folder) / f"fem_{name}.json").write_text(json.dumps(record, indent=1) + "\n")
    holds = bool(error <= ceiling)
    print(f"{'ok  ' if holds else 'FAIL'} {name}: {quantity}: error {error:.3g}, ceiling {ceiling:g}")
    sys.exit(0 if holds else 1)


if __name__ == "__main__":
    main()
