#!/usr/bin/python3
"""Stability matrix of mpm_stage: small scenes along the axes on which explicit particle codes break.

mpm_matrix.py MPM_STAGE OUTPUT_FOLDER [--sample]

Each run must end with finite particles, its mass kept and an energy ledger that closes (no energy from nothing; what the
transfer and the contacts smooth away is reported), or stop with exit status 2 and name a particle, its position, its
material and the time. Anything else fails: a crash, another status, a NaN on disk, a stop that names nobody.
--sample runs the middle scene of each axis.
"""
import argparse
import csv
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

import h5py
import numpy as np

SOIL = {"model": "tresca", "density": 1900, "youngs_modulus": 5e6, "poisson_ratio": 0.33, "cohesion": 3000}
SAND = {"model": "mohr_coulomb", "density": 1700, "youngs_modulus": 5e6, "poisson_ratio": 0.3, "cohesion": 0,
        "friction_angle": 30, "pore_pressure": "total"}


def scene(material=SOIL, **changes):
    """A block of 4 x 2 m that slumps on a flat bed for 1.5 s, 16 x 8 cells."""
    s = {"grid": {"cell_size": 0.25}, "time": {"end": 1.5, "rest": {"stop": False}},
         "materials": {"soil": dict(material)},
         "particles": [{"shape": "box", "low": [0, 0], "high": [4, 2], "material": "soil",
                        "stress": {"kind": "geostatic", "surface": 2, "k0": 0.5}}],
         "terrain": [{"name": "bed", "points": [[-100, 0], [100, 0]], "friction": 0.35}],
         "output": {"frame_interval": 0.5, "series_interval": 0.02}}
    for path, value in changes.items():
        *where, last = path.split("__")
        target = s
        for key in where:
            target = target[int(key)] if isinstance(target, list) else target.setdefault(key, {})
        target[last] = value
    return s


def time_steps():
    for material, name in ((SOIL, "clay"), (SAND, "sand")):
        for factor in (0.1, 0.3, 0.5, 0.8, 1.0, 1.2, 1.5):
            yield f"{name}, dt factor {factor}", scene(material, time__courant=factor)


def points_per_cell():
    for n in (1, 2, 3, 4, 5):
        for placement in ("regular", "random"):
            yield f"{n * n} points per cell, {placement}", scene(particles__0__points_per_cell_side=n,
                                                                 particles__0__placement=placement)


def poisson_ratios():
    for nu in (0.0, 0.3, 0.45, 0.49, 0.499, 0.4999):
        yield f"nu {nu}", scene(materials__soil__poisson_ratio=nu, time__end=0.5)


def strengths():
    for c in (0, 10, 100, 1e3, 1e4, 1e5):
        yield f"s_R {c:g} Pa", scene(materials__soil__cohesion=c)


def stiffness_contrasts():
    for contrast in (1, 1e2, 1e4, 1e5):
        s = scene(time__end=0.2)
        s["materials"]["stiff"] = {"model": "linear_elastic", "density": 1900, "youngs_modulus": 5e5 * contrast,
                                   "poisson_ratio": 0.3}
        s["materials"]["soil"]["youngs_modulus"] = 5e5
        s["particles"].append({"shape": "box", "low": [1, 2], "high": [3, 3], "material": "stiff"})
        yield f"stiffness contrast {contrast:g}", s


def terrains():
    for angle in (0, 10, 20, 30, 45, 60, 70, 80):
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        case = scene(particles__0__rotation=-angle, terrain__0__points=[[-200 * c, 200 * s], [200 * c, -200 * s]])
        del case["particles"][0]["stress"]
        yield f"slope of {angle} deg", case
    for angle in (90, 120, 150, 210, 270):
        # Bed at y = 0 up to x = 5, then a wall that includes `angle` with it (more than 180: an edge to fall over).
        a = math.radians(180 - angle)
        yield f"corner of {angle} deg", scene(particles__0__velocity=[4, 0],
                                              terrain__0__points=[[-100, 0], [5.1, 0],
                                                                  [5.1 + 50 * math.cos(a), 50 * math.sin(a)]])
    yield "wedge of 60 deg", scene(terrain__0__points=[[-28, 50], [0.87, 0], [3, -3.7], [34, 50]])


def detached_particles():
    for shape in ("quadratic", "linear", "cubic", "gimp"):
        s = scene(scheme__shape_function=shape)
        for k in range(4):
            s["particles"].append({"shape": "box", "low": [5.03 + 1.37 * k, 0.5 + 0.8 * k], "high": [5.155 + 1.37 * k, 0.625 + 0.8 * k],
                                   "material": "soil", "velocity": [-3, 0]})
        yield f"single particles in flight, {shape}", s


def impacts():
    for material, name in ((SOIL, "clay"), (SAND, "sand"), ({"model": "newtonian_fluid", "density": 1000, "bulk_modulus": 2e6,
                                                             "viscosity": 1.0}, "water")):
        for direction, v in (("down", [0, -50]), ("along a wall's foot", [50, 0])):
            s = scene(material, time__end=0.5, particles__0__velocity=v,
                      terrain__0__points=[[-500, 0], [12, 0], [12, 500]])
            del s["particles"][0]["stress"]
            s["particles"][0].update(low=[0, 0.5], high=[4, 2.5])
            yield f"{name} hits at 50 m/s, {direction}", s


def standing():
    """Clay that its strength holds: it settles from a start out of balance, and then nothing is made or lost."""
    stands = {**SOIL, "density": 1870, "cohesion": 20000}
    for name, k0, change in (("block, 60 s", 0.49, {"time__end": 60}), ("block, K0 1", 1.0, {}),
                             ("block, K0 1, APIC", 1.0, {"scheme__transfer": "apic"}),
                             ("block, c 15 kPa", 0.49, {"materials__soil__cohesion": 15000}),
                             ("block, c 100 kPa", 0.49, {"materials__soil__cohesion": 100000}),
                             ("block, half the cell", 0.49, {"grid__cell_size": 0.125}),
                             ("block, 4 E", 0.49, {"materials__soil__youngs_modulus": 2e7}),
                             ("block, nu 0.45", 0.49, {"materials__soil__poisson_ratio": 0.45}),
                             ("block, damped", 0.49, {"damping__local": 0.3})):
        s = scene(stands, **{"time__end": 3, "output__series_interval": 0.05, **change})
        s["particles"][0]["stress"]["k0"] = k0
        yield name, s
    s = scene({**stands, "density": 1900, "youngs_modulus": 2e7, "poisson_ratio": 0.45, "cohesion": 30000}, time__end=60,
              grid__cell_size=0.5, output__series_interval=0.25, terrain__0__friction=0.5)
    s["domain"] = {"low": [0, -2], "high": [60, 14], "walls": {"left": {"kind": "slip"}}}
    s["particles"] = [{"shape": "polygon", "points": [[0, 0], [40, 0], [20, 10], [0, 10]], "material": "soil",
                       "stress": {"kind": "geostatic", "surface": 10, "k0": 0.8}}]
    yield "slope of 1 in 2, 60 s", s


def faster_than_sound():
    for v, stiffness in ((80, 5e6), (20, 3e5)):
        for direction, velocity in (("down", [0, -v]), ("along a wall's foot", [v, 0])):
            for courant in (0.5, 0.1):
                s = scene(time__end=0.5, time__courant=courant, materials__soil__youngs_modulus=stiffness,
                          particles__0__velocity=velocity, terrain__0__points=[[-500, 0], [12, 0], [12, 500]])
                del s["particles"][0]["stress"]
                s["particles"][0].update(low=[0, 0.5], high=[4, 2.5])
                yield f"{v} m/s, E {stiffness / 1e6:g} MPa, {direction}, dt {courant}", s


def passing():
    """Two single particles, each within the other's reach and nothing else."""
    for name, scheme in (("default", {}), ("undamped", {"transfer_damping": 0}), ("APIC", {"transfer": "apic"}),
                         ("FLIP", {"transfer": "flip"})):
        s = scene(time__end=0.4, scheme=scheme)
        del s["terrain"]
        s["particles"] = [{"shape": "box", "low": [3, 0.53], "high": [3.125, 0.655], "material": "soil", "velocity": [3, 0]},
                          {"shape": "box", "low": [3.9, 0.9], "high": [4.025, 1.025], "material": "soil", "velocity": [-3, -2]}]
        yield f"two particles, {name}", s


def contact():
    """Weak soil beside strong soil, a velocity field each: a block that slumps on a strong bed under a strong cap, and one
    that runs against a strong block; in three dimensions both are two cells wide."""
    strong = {"model": "linear_elastic", "density": 1900, "youngs_modulus": 5e7, "poisson_ratio": 0.3}
    for dimension in (2, 3):
        for transfer in ("apic", "aflip", "flip", "fmpm"):
            for courant in (0.2, 0.5, 0.9):
                for what in ("under a cap", "against a block"):
                    s = scene(time__courant=courant, time__end=1.5 if dimension == 2 else 0.75, scheme__transfer=transfer)
                    s["materials"]["strong"] = dict(strong)
                    s["terrain"][0]["points"] = [[-100, -1], [100, -1]]
                    bed = {"shape": "box", "low": [-2, -1], "high": [8, 0], "material": "strong",
                           "stress": {"kind": "geostatic", "surface": 0, "k0": 0.43}}
                    other = {"shape": "box", "low": [1, 2], "high": [3, 2.5], "material": "strong"}
                    if what == "against a block":
                        s["particles"][0]["velocity"] = [5] + [0] * (dimension - 1)
                        other.update(low=[5, 0], high=[6, 1.5])
                    s["particles"] += [bed, other]
                    if dimension == 3:
                        s["dimension"] = 3
                        for box in s["particles"]:
                            box["low"], box["high"] = [*box["low"], 0], [*box["high"], 0.5]
                    yield f"{dimension}-D, {transfer}, dt factor {courant}, {what}", s


AXES = [time_steps, points_per_cell, poisson_ratios, strengths, stiffness_contrasts, terrains, detached_particles, impacts, standing,
        faster_than_sound, passing, contact]
NAMES_PARTICLE = re.compile(r"t = \S+ s: particle \d+ of material '[^']+' at \([^)]+\) m")


def finite(folder):
    with h5py.File(sorted((folder / "frames").glob("*.vtkhdf"))[-1]) as f:
        arrays = [f["VTKHDF/Points"][()], *(d[()] for d in f["VTKHDF/PointData"].values())]
    return all(np.isfinite(a).all() for a in arrays if a.dtype.kind == "f")


def outcome(program, folder, case):
    """(holds, word, what)"""
    if folder.exists():
        shutil.rmtree(folder)
    folder.mkdir(parents=True)
    (folder / "mpm.json").write_text(json.dumps(case, indent=1))
    try:
        # One thread: scenes of 500 particles spend more time on handing work round than on the work.
        run = subprocess.run([program, "run", str(folder / "mpm.json"), "-o", str(folder), "--quiet"], capture_output=True,
                             text=True, timeout=120, env={**os.environ, "OMP_NUM_THREADS": "1"})
    except subprocess.TimeoutExpired:
        return False, "hangs", "no end within 120 s"
    message = (run.stderr.strip().splitlines() or [""])[-1]
    if run.returncode == 2:
        return bool(NAMES_PARTICLE.search(message)), "stopped", message.split("failed: ")[-1][:160]
    if run.returncode != 0:
        return False, f"status {run.returncode}", message[:160]
    summary = json.loads((folder / "summary.json").read_text())
    if not finite(folder):
        return False, "not finite", "a frame holds a NaN or an infinity"
    with open(folder / "ledger.csv") as f:
        names, *rows = csv.reader(f)
    mass = [float(row[names.index("mass_kg")]) for row in rows]
    lost, ratio = summary["energy"]["lost_ratio"], summary["energy"]["residual_ratio"]
    kept = abs(mass[-1] / mass[0] - 1) < 1e-12
    closed = lost is not None and -0.02 <= lost <= 1.0
    if case.get("time", {}).get("end") == 60:  # nothing more after it has settled: growth 1e-3, loss 2 % of the turnover
        part = [name + "_J" for name in ("kinetic", "elastic", "gravitational", "plastic", "friction", "damping")]
        total = [sum(float(row[names.index(n)]) for n in part) for row in rows]
        late = (total[-1] - total[len(total) // 3]) / summary["energy"]["turnover_J"]
        closed = closed and -0.02 < late < 1e-3
    return kept and closed, "ended", f"{summary['steps']} steps, of the energy turned over lost by the scheme {lost:.3g}, residual {ratio:.3g}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("output", type=pathlib.Path)
    parser.add_argument("--sample", action="store_true")
    arguments = parser.parse_args()
    failed, count, start = 0, 0, time.perf_counter()
    for axis in AXES:
        cases = list(axis())
        for number, (name, case) in enumerate([cases[len(cases) // 2]] if arguments.sample else cases):
            holds, word, what = outcome(arguments.program, arguments.output / axis.__name__ / str(number), case)
            failed += not holds
            count += 1
            print(f"{'ok  ' if holds else 'FAIL'} {axis.__name__:20s} {name:40s} {word:8s} {what}", flush=True)
    print(f"{count - failed} of {count} as wanted, {time.perf_counter() - start:.0f} s")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
