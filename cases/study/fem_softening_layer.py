#!/usr/bin/env python3
"""Residual strength and softening by element height where a slip is one-dimensional: tailings under a stiff cap that carries a static shear.

    fem_softening_layer.py build/bin/fem_stage cases -o out/study/layer [--variants off floor both_1.5 ...] [--heights 3 1.5 0.75 0.375]

12 m of the main case's tailings, 10 m of elastic cap, water to the top, 10 kPa along the top from the start, the main case's motion
for 16 s. Nothing but the softening of the tailings and the height of their elements decides how far the cap goes. Variants as in
fem_liquefied_strength.py; three members each, motion times 1 and 1 +- 1e-3; a run takes half a second. Prints a table: displacement of
the top against the base (m) and largest shear strain.
"""

import argparse
import json
import pathlib
import subprocess
import sys

import h5py
import numpy as np
from fem_liquefied_strength import changed, mean, read_case

TIMES = (5, 8, 10, 12, 16)
LAYER, CAP, BASE = 12.0, 10.0, 2.0  # m
SHEAR = 10e3  # Pa


def scene(cases, height, variant, scale):
    source = cases / "mochikoshi"
    dam, transfer = read_case(source / "fem.json"), read_case(source / "transfer.json")
    top = BASE + LAYER + CAP
    layers = [{"region": "rock", "height": BASE, "rows": 2}, {"region": "tailings", "height": LAYER, "rows": round(LAYER / height)},
              {"region": "cap", "height": CAP, "rows": 5}]
    out = {
        "title": "Tailings under a stiff cap that carries a static shear",
        "mesh": {"rectangle": {"width": 1.0, "columns": 1, "layers": layers}},
        "fluid": dam["fluid"],
        "phreatic_line": [[-1, top], [2, top]],
        "materials": {"tailings": dam["materials"]["tailings"],
                      "cap": {"model": "linear_elastic", "shear_modulus": 68.58e6, "density": 1890},
                      "rock": {"model": "linear_elastic", "shear_modulus": 150e6, "density": 2000}},
        "regions": {"tailings": dam["regions"]["tailings"], "cap": {"material": "cap", "permeability": [1e-6]},
                    "rock": {"material": "rock", "permeability": [1e-6]}},
        "boundaries": {"base": {**dam["boundaries"]["base"], "line": "bottom", "tied": True}, "periodic_lines": ["left", "right"]},
        "loads": [{"line": "top", "traction": [SHEAR, 0]}],
        "geostatic": dam["geostatic"],
        "shake": {**dam["shake"], "motion": str((source / dam["shake"]["motion"]).resolve()),
                  "peak_acceleration": dam["shake"]["peak_acceleration"] * (1.0 + scale)},
        "output": {"history_interval": 0.02, "snapshots": [TIMES[-1]], "points": {"top": [0, top], "base": [0, 0]}},
    }
    return changed(out, variant, transfer)


def run(program, cases, output, height, variant, scale):
    """Displacements (m) of the top against the base at TIMES, and the largest shear strain at the end."""
    folder = output / f"{variant}_{height:g}_{scale:+g}"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "fem.json").write_text(json.dumps(scene(cases, height, variant, scale), indent=1))
    subprocess.run([program, "run", str(folder / "fem.json"), "-o", str(folder), "--quiet", "--threads", "1"], check=True)
    history = np.genfromtxt(folder / "history.csv", delimiter=",", names=True)
    slip = np.interp(TIMES, history["time_s"], history["top_ux_m"] - history["base_ux_m"])
    with h5py.File(folder / f"snapshot_t{TIMES[-1]:06.3f}.h5") as f:
        return [*slip, f["VTKHDF/CellData/shear_strain"][()].max()]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("cases", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--variants", nargs="+", default=["off", "floor", "both_0.75", "both_1.5", "both_3"])
    parser.add_argument("--heights", nargs="+", type=float, default=[3.0, 1.5, 0.75, 0.375], help="m, of the tailings' elements")
    arguments = parser.parse_args()
    print("| | element m | " + " | ".join(f"{t} s" for t in TIMES) + " | strain |")
    print("|---" * (3 + len(TIMES)) + "|")
    for variant in arguments.variants:
        for height in arguments.heights:
            rows = np.array([run(arguments.program, arguments.cases.resolve(), arguments.output, height, variant, scale)
                             for scale in (0.0, 1e-3, -1e-3)])
            print(f"| {variant} | {height:g} | " + " | ".join(mean(rows[:, k], 3 if k < 2 else 2) for k in range(len(TIMES)))
                  + f" | {rows[:, -1].mean():.1f} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
