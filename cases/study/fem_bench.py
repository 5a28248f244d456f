#!/usr/bin/env python3
"""Whole runs of fem_stage, timed: where a step's time goes, by thread count, and how the cost grows as the soil flows.

    fem_bench.py build/bin/fem_stage cases -o out/bench [--points out/bench/pm4sand.json]

Runs the site response column (one thread, best of three, against OpenSees' processor time for the same column) and the main
case's coarse mesh with one and two threads. Writes out/bench/fem.json, together with the benchmark of single material points
when it is given.
"""

import argparse
import json
import os
import pathlib
import resource
import subprocess
import sys

import numpy as np

OPENSEES_COLUMN_SECONDS = 10.03  # processor time of OpenSees 3.8.0 for the column on the same kind of machine


def run(program, case, folder, threads, size=None):
    """Summary, series and processor seconds of a run of all three stages."""
    folder.mkdir(parents=True, exist_ok=True)
    command = [program, "run", str(case), "-o", str(folder), "--quiet", "--threads", str(threads)]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command + (["--size", size] if size else []), check=True, env={"GOMP_SPINCOUNT": "10000", **os.environ})
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    quality = np.genfromtxt(folder / "quality.csv", delimiter=",", names=True, deletechars="")
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return json.loads((folder / "summary.json").read_text()), quality, processor


def shares(summary):
    s = summary["seconds"]
    parts = {"materials": s["materials"], "elements": s["elements_and_materials"] - s["materials"],
             "assembly": s["assembly"], "factorisation": s["factorisation"], "back_solve": s["solve"], "output": s["output"]}
    parts["rest"] = s["total"] - sum(parts.values())
    return {name: value / s["total"] for name, value in parts.items()}


def seconds_per_second(quality, windows):
    wall = quality["wall_s"]
    at = lambda t: float(np.interp(t, quality["time_s"], wall))
    return {f"{a:g}-{b:g} s": (at(b) - at(a)) / (b - a) for a, b in windows}


def row(name, summary, threads):
    counts = summary["counts"]
    return {"name": name, "threads": threads, "elements": summary["elements"], "wall_seconds": summary["seconds"]["total"],
            "steps": counts["steps"], "iterations_per_step": counts["iterations_per_step"],
            "factorisations_per_100_steps": counts["factorisations_per_100_steps"], "step_halvings": counts["step_halvings"],
            "material_substeps": counts["material_substeps"],
            "us_per_material_substep": 1e6 * threads * summary["seconds"]["materials"] / max(1, counts["material_substeps"]),
            "shares": shares(summary)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("cases", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--points", type=pathlib.Path, help="Google Benchmark's JSON for single points")
    arguments = parser.parse_args()
    rows = []
    column = arguments.cases / "verification" / "site_response_pm4sand" / "fem.json"
    runs = [run(arguments.program, column, arguments.output / "column", 1) for _ in range(3)]
    best = min(runs, key=lambda r: r[2])
    rows.append({**row("site response column, 20 s", best[0], 1), "processor_seconds": best[2],
                 "times_faster_than_opensees": OPENSEES_COLUMN_SECONDS / best[2]})
    for threads in (1, 2):
        summary, quality, processor = run(arguments.program, arguments.cases / "mochikoshi" / "fem.json",
                                          arguments.output / f"dam_{threads}", threads, "coarse")
        rows.append({**row("Mochikoshi coarse, 16 s", summary, threads), "processor_seconds": processor,
                     "wall_seconds_per_simulated_second": seconds_per_second(quality, [(0, 5), (5, 8), (8, 12), (12, 16)])})
    rows[-1]["speed_up"] = rows[-2]["wall_seconds"] / rows[-1]["wall_seconds"]
    for r in rows:
        print(f"{r['name']}, {r['threads']} thread(s): {r['wall_seconds']:.2f} s; {r['iterations_per_step']:.1f} iterations a step, "
              f"{r['factorisations_per_100_steps']:.1f} factorisations per 100 steps, {r['us_per_material_substep']:.2f} us per sub-step")
        print("   " + ", ".join(f"{k} {100 * v:.0f} %" for k, v in r["shares"].items()))
        for key in ("times_faster_than_opensees", "speed_up"):
            if key in r:
                print(f"   {key.replace('_', ' ')}: {r[key]:.2f}")
        if "wall_seconds_per_simulated_second" in r:
            print("   wall seconds per simulated second: "
                  + ", ".join(f"{k} {v:.2f}" for k, v in r["wall_seconds_per_simulated_second"].items()))
    points = json.loads(arguments.points.read_text()) if arguments.points else None
    (arguments.output / "fem.json").write_text(json.dumps({"whole_runs": rows, "pm4sand_points": points}, indent=1) + "\n")
    print(arguments.output / "fem.json")
    return 0


if __name__ == "__main__":
    sys.exit(main())
