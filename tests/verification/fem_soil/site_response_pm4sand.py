#!/usr/bin/python3
"""Row site_response_pm4sand: a 30 m column in three PM4Sand soils on a compliant base, against OpenSees.

site_response_pm4sand.py FEM_STAGE SCENES_FOLDER OUTPUT_FOLDER

Surface acceleration: RMS of the difference over 20 s relative to the reference's RMS. r_u = 1 - sigma'_v/sigma'_v0 at
five depths: largest difference at any time. Both at the reference's time step. (Its cost: make bench-fem.)
"""
import pathlib
import sys

import numpy as np

from rows import DATA, MODES, Report, rms, Runner, table

DEPTHS = ("2.5", "5.5", "9.5", "15.5", "25.5")
COLOURS = {"improved": "#c0392b", "opensees": "#2471a3"}


def compatible(scene):
    for material in scene["materials"].values():
        material["compatibility"] = "opensees"
    scene["element"] = {"pressure_quadrature": 1, "hourglass_shape": "opensees"}


def main():
    program, scenes, output = sys.argv[1:]
    report = Report("fem_site_response_pm4sand", "site_response_pm4sand")
    run = Runner(program, pathlib.Path(scenes) / "site_response_pm4sand", output)
    reference = table(DATA / "site_response_pm4_history.csv")
    t, kept = reference["t_s"], {}
    for mode, change in (("improved", None), ("opensees", compatible)):
        folder, _ = run.shake("fem.json", mode, change)
        ours = table(folder / "history.csv")
        acceleration = np.interp(t, ours["time_s"], ours["surface_ax_m_s2"])
        ratio = {}
        for depth in DEPTHS:
            vertical = ours[f"depth_{depth}_effective_stress_yy_Pa"]
            ratio[depth] = np.interp(t, ours["time_s"], 1.0 - vertical / vertical[0])
        kept[mode] = (acceleration, ratio)
        report.add(f"RMS of the surface acceleration over the reference's, {MODES[mode]}",
                   rms(acceleration - reference["a_surf_m_s2"]) / rms(reference["a_surf_m_s2"]), 0.05, "OpenSees")
        for depth in DEPTHS:
            report.add(f"largest difference of r_u at {depth} m, {MODES[mode]}",
                       np.abs(ratio[depth] - reference[f"ru_z{depth}"]).max(), 0.05, "OpenSees")

    def draw(plt):
        figure, axes = plt.subplots(2, 1, figsize=(9, 4.4), sharex=True)
        axes[0].plot(t, reference["a_surf_m_s2"], color="0.6", lw=1.4, label="OpenSees")
        for mode, (acceleration, ratio) in kept.items():
            style = dict(color=COLOURS[mode], lw=0.6, ls="-" if mode == "improved" else "--")
            axes[0].plot(t, acceleration, label=f"tailrun, {MODES[mode]}", **style)
            for depth in DEPTHS:
                axes[1].plot(t, ratio[depth], **style)
        for depth in DEPTHS:
            axes[1].plot(t, reference[f"ru_z{depth}"], color="0.6", lw=1.4, zorder=0)
            axes[1].text(20.1, reference[f"ru_z{depth}"][-1], f"{depth} m", fontsize=7, va="center")
        axes[0].set(ylabel="surface acceleration, m/s$^2$")
        axes[1].set(ylabel="$r_u$", xlabel="time, s", xlim=(0, 21.5))
        axes[0].legend(fontsize=7)
        return figure

    report.picture("site_response_pm4sand.png", "Site response column: tailrun over OpenSees", draw)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
