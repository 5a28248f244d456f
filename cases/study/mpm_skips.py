#!/usr/bin/env python3
"""What the main case's runout leaves out, switched on and off at the same answer: seconds beside front and displacement.

    mpm_skips.py build/bin cases --snapshot out/mochikoshi/fem/snapshot_t16.000.h5 [--size default] -o out/bench/skips

  sleeping blocks   soil at rest is left out until something moves it; on and off
  rigid bed         the foundation's surface as a line with friction, for a foundation of particles on rock. Soil sticks to
                    soil in the same grid, so the rigid bed is run with the case's friction and as one that sticks too

All runs leave out what lies upstream of transfer_foundation.json's clip. Times are processor seconds of mpm_stage on one
thread, one run each. Writes skips.json and prints the table.
"""

import argparse
import json
import os
import pathlib
import resource
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from case_part import read_case  # noqa: E402

ROCK_ELEVATION = -35.0  # m, base of the finite element mesh
STICKING = 5.0          # coefficient of friction that no soil of the case reaches
FOUNDATION = {"model": "mohr_coulomb", "density": 1900, "youngs_modulus": 1e8, "poisson_ratio": 0.3, "cohesion": 0,
              "friction_angle": 34, "pore_pressure": "frozen"}


def write(path, content):
    path.write_text(json.dumps(content, indent=1) + "\n")
    return path


def run(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([str(part) for part in command], check=True, stdout=subprocess.DEVNULL,
                   env={"GOMP_SPINCOUNT": "10000", **os.environ})
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def scenes(runout):
    """Name to (case of mpm_stage, with foundation particles?)."""
    def bed(friction):
        return [{"from_particles": "bed", "friction": friction}] + runout["terrain"][1:]

    awake = {key: value for key, value in runout.items() if key != "sleep"}
    rock = {"name": "rock", "points": [[-500.0, ROCK_ELEVATION], [600.0, ROCK_ELEVATION]], "friction": 1.0}
    on_rock = [rock] + runout["terrain"][1:] + [{"from_particles": "downstream_wall", "friction": 0.0}]
    soils = {**runout["materials"], "foundation": FOUNDATION}
    return {
        "as the case has it: rigid bed, sleeping blocks": (runout, False),
        "no sleeping blocks": (awake, False),
        "no sleeping blocks, rigid bed that sticks": ({**awake, "terrain": bed(STICKING)}, False),
        "no sleeping blocks, foundation of particles": ({**awake, "terrain": on_rock, "materials": soils}, True),
        "sleeping blocks, foundation of particles": ({**runout, "terrain": on_rock, "materials": soils}, True),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("cases", type=pathlib.Path)
    parser.add_argument("--snapshot", type=pathlib.Path, required=True)
    parser.add_argument("--size", default="default")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    case = arguments.cases / "mochikoshi"
    with_foundation = read_case(case / "transfer_foundation.json")
    rigid = {**read_case(case / "transfer.json"), "clip": with_foundation["clip"]}
    particles = {}
    for name, handed_over in {False: rigid, True: with_foundation}.items():
        path = write(arguments.output / f"transfer_{'foundation' if name else 'rigid'}.json", handed_over)
        particles[name] = path.with_suffix(".h5")
        run([arguments.programs / "transfer_tool", "run", path, "--snapshot", arguments.snapshot, "--size", arguments.size,
             "-o", particles[name], "--quiet"])

    runout = read_case(case / "mpm.json")
    runout["output"]["frame_interval"] = 10.0
    report = []
    for number, (name, (scene, has_foundation)) in enumerate(scenes(runout).items(), 1):
        path = write(arguments.output / f"run{number}.json", scene)
        folder = arguments.output / f"run{number}"
        seconds = run([arguments.programs / "mpm_stage", "run", path, "--particles", particles[has_foundation], "--size",
                       arguments.size, "-o", folder, "--threads", "1", "--quiet"])
        summary = json.loads((folder / "summary.json").read_text())
        report.append({"name": name, "size": arguments.size, "seconds": seconds, "steps": summary["steps"],
                       "particles": summary["particles"], "share_asleep": summary["share_asleep"],
                       "flow_front_m": summary["flow_front_position_m"], "flowed_mass_kg": summary["flowed_mass_kg"],
                       "largest_displacement_m": summary["largest_displacement_m"]})
        line = report[-1]
        print(f"{name:48s} {line['particles']:7d} particles {seconds:7.1f} s  front {line['flow_front_m']:7.2f} m  "
              f"largest displacement {line['largest_displacement_m']:6.2f} m  {line['flowed_mass_kg'] / 1e3:6.0f} t flowed",
              flush=True)
    write(arguments.output / "skips.json", report)


if __name__ == "__main__":
    main()
