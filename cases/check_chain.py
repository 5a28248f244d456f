#!/usr/bin/env python3
"""Checks finished results of the chain: each stage's files are there, complete, and hold physics and not noise.

    check_chain.py out/smoke/template out/smoke/mochikoshi-coarse --family out/smoke/mochikoshi-coarse tests/data/mochikoshi_spread.json coarse

--family: the results in that folder are one of the family whose spread the file has for that size (cases/what_if/family.py).
"""

import argparse
import json
import struct
import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parent / folder) for folder in ("plot", "what_if")]
import chain_files as chain  # noqa: E402
import family  # noqa: E402
import headline  # noqa: E402

PICTURES = ["mesh", "velocity", "excess_pore_pressure_ratio", "displacement_fem", "fem_series", "handover"]
PICTURES += ["displacement_mpm", "runout", "runout_front", "energy", "overview"]


def picture_width(path):
    """Width in pixels of a PNG, 0 when it is none."""
    head = path.read_bytes()[:24] if path.exists() else b""
    return struct.unpack(">I", head[16:20])[0] if head[:8] == b"\x89PNG\r\n\x1a\n" else 0


def problems(folder):
    """Everything that is wrong with the results in `folder`."""
    fem = json.loads((folder / "fem" / "summary.json").read_text())
    mpm = json.loads((folder / "mpm" / "summary.json").read_text())
    quality = chain.series(folder / "fem" / "quality.csv")
    particles = chain.Particles(folder / "particles.h5")
    first = chain.Particles(chain.frames(folder / "mpm")[0])
    energy = mpm["energy"]
    used = sum(use["strength_Pa"]["mean"] * use["particles"] for use in mpm.get("residual_strength", []))
    shown = first.data.get("residual_strength", 0.0 * first.data["mass"]).sum()
    lost = abs(1.0 - mpm["mass_kg"] / particles.data["mass"].sum()) if not mpm["particles_removed"] else 0.0
    checks = [
        (fem["finished"], "fem_stage did not finish"),
        (fem["inverted_elements"] == 0 and fem["min_scaled_jacobian"] > 0.0, "elements are inverted"),
        (abs(fem["energy_J"]["residual_of_largest"]) < 0.01, "fem_stage's energy balance is open by more than 1 %"),
        (abs(fem["energy_J"]["hourglass"]) < 0.01 * abs(fem["energy_J"]["external_work"]),
         "hourglass modes took more than 1 % of the work"),
        (quality["mean_excess_pore_pressure_ratio"][0] == 0.0, "there is excess pore pressure before the shaking"),
        (quality["mean_excess_pore_pressure_ratio"][-1] > 0.1, "shaking raised no pore pressure"),
        (quality["largest_displacement_m"][-1] > 0.01, "shaking moved nothing"),
        (abs(particles.time - first.time) < 1e-9, "the first frame is not the hand-over's state"),
        ((particles.data["volume"] > 0.0).all(), "particles without volume"),
        (mpm["stop_reason"] in ("at rest", "flow over", "end time"), f"mpm_stage: {mpm['stop_reason']}"),
        (abs(used - shown) <= 1e-9 * shown, "summary.json and the first frame disagree on the strengths"),
        (lost < 1e-12, f"mpm_stage lost {lost:.1e} of the mass"),
        # The scheme may dissipate energy; it must never make it.
        (energy["lost_ratio"] > -0.02, f"mpm_stage made energy: {-energy['lost_ratio']:.1%} of what turned over"),
    ]
    found = [text for good, text in checks if not good]
    found += [f"no picture {name}.png" for name in PICTURES if picture_width(folder / "figures" / f"{name}.png") < 600]
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", type=Path, nargs="+")
    parser.add_argument("--family", nargs=3, metavar=("FOLDER", "FILE", "SIZE"))
    arguments = parser.parse_args()
    wrong = 0
    for folder in arguments.folders:
        found = problems(folder)
        if arguments.family and folder == Path(arguments.family[0]):
            spread = json.loads(Path(arguments.family[1]).read_text())[arguments.family[2]]["numbers"]
            found += family.strangers(headline.of_run(folder)[0], spread)
        wrong += len(found)
        for text in found:
            print(f"{folder}: {text}", file=sys.stderr)
        if not found:
            print(f"{folder}: chain complete")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
