#!/usr/bin/python3
"""Row pm4sand_opensees: undrained simple shear histories of OpenSees' PM4Sand in one SSPquad element.

pm4sand_opensees.py FEM_STAGE SCENES_FOLDER OUTPUT_FOLDER

Cyclic, until r_u = 0.95 or the soil flows (from there on the cycle number stands still): r_u at equal cycle number, and
the distance of the curves in the plane of shear strain (over the largest reached in that part) and shear stress (over
the amplitude), each point of the reference against ours of the same cycle, within 0.02.
Monotonic: shear stress over the peak and r_u at equal strain, to 50 %.
"""
import pathlib
import sys

import numpy as np

from rows import DATA, MODES, Report, rms, Runner, table

# History, and cycles to r_u = 0.95 and to a shear strain of 3 % (the tailings pass 0.95 only while flowing).
CYCLIC = {"loose": ("cyclic_loose_csr0.090.csv", 13.498, 13.742),
          "embankment": ("cyclic_embankment_csr0.160.csv", 8.507, 10.688),
          "foundation": ("cyclic_foundation_csr0.320.csv", 9.508, 12.697),
          "tailings": ("cyclic_tailings_csr0.120.csv", None, 4.199)}
MONOTONIC = ("tailings_sv17", "tailings_sv186", "loose_sv100")
COLOURS = {"improved": "#c0392b", "opensees": "#2471a3"}


def curve_distance(ours, reference, count, amplitude):
    """Of the reference's first `count` points from our curve; units: the largest strain, the amplitude."""
    gamma, tau, n = (reference[k][:count] for k in ("gamma", "tau_kPa", "N_cycles"))
    largest, out = np.abs(gamma).max(), []
    x, y = ours["shear_strain"] / largest, ours["shear_stress"] / 1e3 / amplitude
    first = np.searchsorted(ours["cycle"], n - 0.02)
    last = np.searchsorted(ours["cycle"], n + 0.02, side="right")
    for i in range(count):
        part = slice(max(first[i] - 1, 0), last[i] + 1)
        out.append(np.hypot(x[part] - gamma[i] / largest, y[part] - tau[i] / amplitude).min())
    return np.array(out)


def cyclic(run, report, kept):
    for name, (file, *counts) in CYCLIC.items():
        reference = table(DATA / file)
        csr = run.scene(f"cyclic_{name}.json")["loading"]["csr"]
        last = reference["N_cycles"][-1]
        over = np.flatnonzero((reference["ru"] >= 0.95) | (reference["N_cycles"] >= last))[0]
        n = reference["N_cycles"][:over]
        for mode in MODES:
            ours, found = run.element(f"cyclic_{name}.json",
                                      lambda scene: scene.update(output={"every": 1}), mode)
            kept[name, mode] = (ours, reference)
            against = "OpenSees, SSPquad"
            what = f"{name}, CSR {csr:g}, {MODES[mode]}"
            ru = np.interp(n, ours["cycle"], ours["excess_pore_pressure_ratio"])
            report.add(f"RMS of r_u, {what}", rms(ru - reference["ru"][:over]), 0.02, against)
            report.add(f"RMS distance of stress-strain curves, {what}",
                       rms(curve_distance(ours, reference, over, 100.0 * csr)), 0.02, against)
            for key, wanted in zip(("cycles_to_ru_0.95", "cycles_to_shear_strain_0.03"), counts):
                if wanted is not None:
                    report.add(f"{key.replace('_', ' ')}, {what}", abs(found[key] / wanted - 1), 0.03, against,
                               found[key], wanted)


def monotonic(run, report, kept):
    for name in MONOTONIC:
        reference = table(DATA / f"monotonic_{name}.csv")
        peak = np.abs(reference["tau_kPa"]).max()
        for mode in MODES:
            ours, _ = run.element(f"monotonic_{name}.json", None, mode)
            kept[name, mode] = (ours, reference)
            tau = np.interp(reference["gamma"], ours["shear_strain"], ours["shear_stress"]) / 1e3
            ru = np.interp(reference["gamma"], ours["shear_strain"], ours["excess_pore_pressure_ratio"])
            report.add(f"RMS of shear stress over the peak, {name}, {MODES[mode]}",
                       rms(tau - reference["tau_kPa"]) / peak, 0.02, "OpenSees, SSPquad")
            report.add(f"RMS of r_u, {name}, {MODES[mode]}", rms(ru - reference["ru"]), 0.02, "OpenSees, SSPquad")


def draw_cyclic(kept):
    def draw(plt):
        figure, axes = plt.subplots(2, 4, figsize=(10, 4.4))
        for column, name in enumerate(CYCLIC):
            reference = kept[name, "improved"][1]
            upper, lower = axes[:, column]
            upper.plot(100 * reference["gamma"], reference["tau_kPa"], color="0.6", lw=1.6, label="OpenSees")
            lower.plot(reference["N_cycles"], reference["ru"], color="0.6", lw=1.6)
            for mode in MODES:
                ours = kept[name, mode][0]
                style = dict(color=COLOURS[mode], lw=0.6, ls="-" if mode == "improved" else "--")
                upper.plot(100 * ours["shear_strain"][::4], ours["shear_stress"][::4] / 1e3,
                           label=f"tailrun, {MODES[mode]}", **style)
                lower.plot(ours["cycle"][::4], ours["excess_pore_pressure_ratio"][::4], **style)
            upper.set(title=name, xlabel="shear strain, %", ylabel="shear stress, kPa" if column == 0 else "")
            lower.set(xlabel="cycles", ylabel="$r_u$" if column == 0 else "", ylim=(-0.1, 1.05))
        axes[0, 0].legend(fontsize=6, loc="lower right")
        return figure
    return draw


def draw_monotonic(kept):
    def draw(plt):
        figure, axes = plt.subplots(1, 3, figsize=(10, 2.5))
        for axis, name in zip(axes, MONOTONIC):
            reference = kept[name, "improved"][1]
            axis.plot(100 * reference["gamma"], reference["tau_kPa"], color="0.6", lw=2, label="OpenSees")
            for mode in MODES:
                ours = kept[name, mode][0]
                axis.plot(100 * ours["shear_strain"], ours["shear_stress"] / 1e3, color=COLOURS[mode], lw=0.8,
                          ls="-" if mode == "improved" else "--", label=f"tailrun, {MODES[mode]}")
            axis.set(title=name.replace("_sv", ", ") + " kPa", xlabel="shear strain, %", ylabel="shear stress, kPa")
        axes[0].legend(fontsize=6)
        return figure
    return draw


def main():
    program, scenes, output = sys.argv[1:]
    report = Report("fem_pm4sand_opensees", "pm4sand_opensees")
    run, kept = Runner(program, pathlib.Path(scenes) / "pm4sand_opensees", output), {}
    cyclic(run, report, kept)
    monotonic(run, report, kept)
    report.picture("pm4sand_cyclic.png", "Undrained cyclic simple shear, 100 kPa: tailrun over OpenSees",
                   draw_cyclic(kept))
    report.picture("pm4sand_monotonic.png", "Undrained monotonic simple shear: tailrun over OpenSees",
                   draw_monotonic(kept))
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
