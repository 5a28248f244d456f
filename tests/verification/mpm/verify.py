#!/usr/bin/python3
"""Runs a verification scene of mpm_stage and compares it with a closed form, a reference solution or an experiment.

verify.py MPM_STAGE SCENES_FOLDER NAME OUTPUT_FOLDER

Each check returns rows (quantity, found, wanted, error, tolerance). They are printed and added to the run's summary.json
under "verification"; the exit status is 1 when an error exceeds its tolerance.
"""
import json
import os
import pathlib
import sys
import time

import collapse
import contact
import elastic
import friction
import grains
import pictures
import strength
import water
from runner import Runner

AGAINST = {"rigid_motion": "exact", "spinning_square": "exact", "vibrating_bar": "closed form",
           "manufactured": "Fourier series in the body's coordinates", "gravity_column": "closed form",
           "moving_bar": "the bar at rest", "cantilever_large": "elastica with shear and stretch (Reissner 1972)",
           "mu_block": "closed form", "clay_slab": "closed form", "slab_safety": "closed form", "short_slab": "closed form", "softened_band": "closed form",
           "incline": "closed form", "incline_3d": "closed form",
           "mohr_coulomb_point": "bisection, 1e6 random trials", "strip_footing": "(2 + pi) c, Prandtl 1920",
           "vertical_cut": "3.83 c / gamma, Taylor 1937", "cohesive_block": "itself: time step, cell, energy",
           "bingham_rest": "closed form, shallow limit", "bingham_slab": "one-dimensional solution", "bingham_drain": "closed form", "bui_2008": "an independent MPM code; experiment, Bui et al. 2008",
           "martin_moyce": "experiment, Martin & Moyce 1952; potential flow", "column_3d": "experiments, Lube et al. 2004",
           "contact_block": "the block on rigid ground, same cell",
           "contact_slab": "the slab on rigid ground along the grid, same cell", "contact_stack": "at rest",
           "contact_incline": "closed form", "contact_impact": "closed form, waves in bars", "weak_layer": "closed form",
           "pond_slope": "closed form; the buoyant weight alone", "pond_dam": "closed form", "pond_drawdown": "closed form",
           "pond_3d": "closed form, Archimedes",
           "bagnold": "closed form, Bagnold's profile", "bui_mu_i": "experiment, Bui et al. 2008"}


def check_of(name):
    return next(getattr(module, name) for module in (elastic, friction, strength, collapse, contact, grains, water)
                if hasattr(module, name))


def main():
    program, scenes, name, output = sys.argv[1:]
    check = check_of(name)
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
        folder = pathlib.Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        if drawn := pictures.of_row(name, pathlib.Path(output), folder):
            entries[0]["pictures"] = drawn
        (folder / f"mpm_{name}.json").write_text(json.dumps(entries, indent=1) + "\n")
    path = pathlib.Path(output) / "summary.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    summary = json.loads(path.read_text()) if path.exists() else {"title": name}
    summary["verification"] = report
    path.write_text(json.dumps(summary, indent=2) + "\n")
    sys.exit(0 if all(row["holds"] for row in report) else 1)


if __name__ == "__main__":
    main()
