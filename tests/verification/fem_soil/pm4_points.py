#!/usr/bin/python3
"""Rows pm4sand_point and pm4silt_point: material points against tables of OpenSees' own material driven directly.

pm4_points.py FEM_STAGE SCENES_FOLDER ROW MODE OUTPUT_FOLDER

Undrained means constant volume. The tables count reversals passed (0.25, 0.75, 1.25 ...) when the strain limit is first
exceeded; fem_stage gives the cycle itself, so the last reversal before it is compared.
"""
import math
import pathlib
import sys

import numpy as np

from rows import MODES, Report, Runner

# (CSR, static shear ratio): cycles to 1 % and 3 % shear strain.
SAND_CYCLES = {
    "cyclic_loose.json": {(.08, 0): (21.25, 22.25), (.09, 0): (12.75, 13.25), (.10, 0): (7.75, 8.25),
                          (.12, 0): (3.25, 3.75), (.15, 0): (1.25, 1.75), (.07, .10): (36.75, 44.75)},
    "cyclic_medium.json": {(.12, 0): (27.25, 29.25), (.135, 0): (16.75, 18.75), (.147, 0): (11.75, 13.75),
                           (.16, 0): (8.25, 10.25), (.18, 0): (5.25, 6.25), (.22, 0): (2.25, 3.75),
                           (.16, .05): (7.75, 8.75), (.14, .15): (10.75, 29.75)},
    "cyclic_dense.json": {(.25, 0): (26.25, 30.25), (.28, 0): (15.75, 19.25), (.312, 0): (9.75, 12.75),
                          (.35, 0): (5.25, 8.25), (.40, 0): (2.25, 5.25), (.30, .10): (9.75, 12.75)},
    "cyclic_tailings.json": {(.08, 0): (23.25, 23.25), (.09, 0): (13.75, 13.75), (.10, 0): (8.75, 8.75),
                             (.12, 0): (3.75, 3.75), (.15, 0): (1.25, 1.25), (.06, .10): (60.75, 74.75)},
}
# Cyclic resistance at 15 cycles to 3 % that the default calibration aims at (Idriss & Boulanger 2008).
CRR_15 = {"cyclic_loose.json": .090, "cyclic_medium.json": .147, "cyclic_dense.json": .312}
# sigma'_v0 (kPa): peak and shear stress (kPa) at 1, 2, 5, 10, 20, 30 % strain.
SAND_MONOTONIC = {17: (5.46, 5.224, 4.710, 3.788, 3.092, 2.567, 2.373),
                  50: (14.73, 14.156, 11.850, 7.407, 4.257, 2.855, 2.488),
                  101.3: (28.18, 27.210, 22.386, 12.524, 5.944, 3.102, 2.574),
                  186: (49.14, 48.096, 39.357, 20.286, 8.365, 3.785, 2.989)}
# Stress (kPa, compression positive: xx, yy, xy) after each leg of mixed_path.json.
SAND_PATH = [(200.734, 352.458, 73.803), (408.062, 533.349, -181.876), (413.601, 529.052, 128.316),
             (307.943, 409.666, -184.955), (98.559, 94.705, 59.353), (19.913, 19.913, -12.913)]
SILT_PATH = [(132.594, 217.607, 46.915), (251.554, 267.696, -62.164), (280.567, 300.431, 63.837),
             (190.832, 217.118, -59.721), (111.757, 107.551, 52.706), (97.118, 96.826, -46.501)]
# S_u,cs / sigma'_v0: shear stress (kPa) at 10 % and 30 % strain, sigma'_v0 = 100 kPa.
SILT_MONOTONIC = {.10: (10.05, 10.02), .25: (25.13, 25.05), .50: (50.01, 50.01)}
SILT_CYCLES = {.12: (123.25, 127.25), .14: (58.25, 60.75), .16: (30.25, 31.75), .18: (16.25, 17.75), .20: (9.25, 10.25)}


def last_reversal(cycles):
    return math.floor((cycles - 0.25) / 0.5 + 1e-9) * 0.5 + 0.25


def mixed_path(run, report, mode, expected, ceiling):
    scene = run.scene("mixed_path.json")
    ends = np.cumsum([leg["repeats"] for leg in scene["loading"]["path"]])
    history, _ = run.element("mixed_path.json", mode=mode)
    worst = 0.0
    for step, wanted in zip(ends, np.array(expected)):
        i = int(np.flatnonzero(history["step"] == step)[0])
        columns = ("mean_effective_stress", "vertical_effective_stress", "shear_stress")
        p, yy, xy = (history[k][i] / 1e3 for k in columns)
        found = np.array((2 * p - yy, yy, xy))
        worst = max(worst, np.linalg.norm(found - wanted) / np.linalg.norm(wanted))
    report.add(f"stress after the legs of a path with volume change, {MODES[mode]}", worst, ceiling,
               "OpenSees' material")


def monotonic(run, report, mode, file, change, levels, wanted, what, ceiling):
    _, summary = run.element(file, change, mode)
    found = [e["shear_stress"] / 1e3 for e in summary["shear_stress_at_strain"]
             if any(abs(e["shear_strain"] - level) < 1e-9 for level in levels)]
    if len(wanted) == len(levels) + 1:
        found.insert(0, summary["peak_shear_stress"] / 1e3)
    report.add(f"monotonic simple shear, {what}, {MODES[mode]}",
               np.abs(np.array(found) / np.array(wanted) - 1.0).max(), ceiling, "OpenSees' material")


def cycles_at(run, file, mode, csr, bias=0.0):
    def change(scene):
        scene["loading"]["csr"] = csr
        scene["initial"]["static_shear_ratio"] = bias

    _, summary = run.element(file, change, mode)
    return summary["cycles_to_shear_strain_0.01"], summary["cycles_to_shear_strain_0.03"]


def pm4sand_point(run, report, mode):
    mixed_path(run, report, mode, SAND_PATH, 0.01)
    for vertical, wanted in SAND_MONOTONIC.items():
        def change(scene):
            scene["initial"]["vertical_effective_stress"] = 1e3 * vertical
        monotonic(run, report, mode, "monotonic.json", change, (.01, .02, .05, .1, .2, .3), wanted,
                  f"{vertical:g} kPa", 0.02)
    for file, counts in SAND_CYCLES.items():
        worst, to_3 = 0.0, {}
        for (csr, bias), wanted in counts.items():
            found = cycles_at(run, file, mode, csr, bias)
            worst = max([worst] + [abs(last_reversal(n) - w) for n, w in zip(found, wanted)])
            if bias == 0:
                to_3[csr] = found[1]
        what = file[len("cyclic_"):-len(".json")]
        report.add(f"cycles to 1 % and 3 %, {what}, {MODES[mode]}", worst, 1.0, "OpenSees' material")
        if file in CRR_15:
            levels = sorted(to_3)
            crr = math.exp(np.interp(-math.log(15.0), [-math.log(to_3[c]) for c in levels],
                                     [math.log(c) for c in levels]))
            report.add(f"CSR for 15 cycles to 3 %, {what}, {MODES[mode]}", abs(crr / CRR_15[file] - 1), 0.05,
                       "Idriss & Boulanger (2008)", crr, CRR_15[file])


def pm4silt_point(run, report, mode):
    mixed_path(run, report, mode, SILT_PATH, 0.02)
    for ratio, wanted in SILT_MONOTONIC.items():
        def change(scene):
            scene["material"]["strength_ratio"] = ratio
        monotonic(run, report, mode, "monotonic.json", change, (.1, .3), wanted, f"S_u/sigma'_v0 {ratio:g}", 0.02)
    worst = 0.0
    for csr, wanted in SILT_CYCLES.items():
        for n, w in zip(cycles_at(run, "cyclic.json", mode, csr), wanted):
            # The table says "between this reversal and the next".
            worst = max(worst, max(w - n, n - (w + 0.5), 0.0) / w)
    report.add(f"cycles to 1 % and 3 %, {MODES[mode]}", worst, 0.02, "OpenSees' material")


def main():
    program, scenes, row, mode, output = sys.argv[1:]
    report = Report(f"fem_{row}_{mode}", row)
    check = {"pm4sand_point": pm4sand_point, "pm4silt_point": pm4silt_point}[row]
    check(Runner(program, pathlib.Path(scenes) / row, output), report, mode)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
