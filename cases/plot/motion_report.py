#!/usr/bin/env python3
"""One picture and one table of a ground motion: spectrum (against a target), acceleration, velocity, Husid curve.

    motion_report.py MOTION.AT2 [--target target_spectrum.csv] [--pga 0.2] -o motion_report.png
"""

import argparse
import sys
from pathlib import Path

import numpy as np

import style

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "mochikoshi" / "motion"))
import ground_motion as gm  # noqa: E402  (beside the generator, so that it runs with numpy alone)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("motion", type=Path)
    parser.add_argument("--target", type=Path, help="CSV of period (s), PSA/PGA")
    parser.add_argument("--pga", type=float, help="scale to this peak acceleration (g)")
    parser.add_argument("-o", "--output", type=Path, required=True)
    arguments = parser.parse_args()

    plt = style.pyplot()
    try:
        acceleration, step = gm.read_at2(arguments.motion)
    except (OSError, ValueError) as error:
        sys.exit(f"motion_report.py: {error}")
    if arguments.pga:
        acceleration = acceleration * (arguments.pga / np.abs(acceleration).max())
    pga = np.abs(acceleration).max()
    time = np.arange(acceleration.size) * step
    found = gm.measures(acceleration, step)

    figure, axes = plt.subplots(2, 2, figsize=(11, 6.4))
    periods = np.geomspace(0.02, 5.0, 160)
    achieved = gm.response_spectrum(acceleration, step, periods)
    axis = axes[0, 0]
    if arguments.target:
        table = gm.target_spectrum(arguments.target)
        target = pga * gm.target_at(periods, table)
        axis.fill_between(periods, 0.9 * target, 1.1 * target, color="0.85", label="target ± 10 %")
        axis.plot(periods, target, "k", lw=1.2, label="target")
        for name, judged in (
            ("at its periods", table[0][(table[0] >= 0.1) & (table[0] <= 3.0)]),
            ("anywhere", np.geomspace(0.1, 3.0, 1000)),
        ):
            ratio = gm.response_spectrum(acceleration, step, judged) / (pga * gm.target_at(judged, table))
            found[f"spectrum/target {name}, least"] = (float(ratio.min()), "(0.1 to 3 s)")
            found[f"spectrum/target {name}, most"] = (float(ratio.max()), "(0.1 to 3 s)")
    axis.loglog(periods, achieved, style.ACCENT, lw=1.2, label="motion")
    axis.set(xlabel="period (s)", ylabel="PSA, 5 % damping (g)")
    axis.legend()
    axis = axes[0, 1]
    axis.plot(time, acceleration, lw=0.6)
    axis.set(xlabel="time (s)", ylabel="acceleration (g)")
    axis = axes[1, 1]
    velocity = gm.integrate(acceleration * gm.STANDARD_GRAVITY, step)
    axis.plot(time, 100.0 * velocity, lw=0.8)
    axis.set(xlabel="time (s)", ylabel="velocity (cm/s)")
    axis = axes[1, 0]
    axis.plot(time, gm.husid(acceleration))
    for share in (0.05, 0.75, 0.95):
        arrival = gm.arrival(acceleration, step, share)
        axis.plot([arrival, arrival], [0.0, share], "k:", lw=0.8)
        axis.annotate(f"{100 * share:.0f} %, {arrival:.1f} s", (arrival, share), (4, -10), textcoords="offset points")
    axis.set(xlabel="time (s)", ylabel="share of Arias intensity (1)", ylim=(0.0, 1.02))
    parts = [f"{name} {found[name][0]:.3g} {found[name][1]}" for name in ("PGA", "PGV", "Arias intensity", "D5-75", "D5-95")]
    figure.suptitle(arguments.motion.name + ": " + ", ".join(parts))
    style.save(figure, arguments.output)
    print(arguments.motion)
    for name, (value, unit) in found.items():
        print(f"  {name:34s} {value:10.4g} {unit}")


if __name__ == "__main__":
    main()
