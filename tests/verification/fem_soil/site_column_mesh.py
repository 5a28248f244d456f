#!/usr/bin/python3
"""Row site_column_mesh: r_u in the site response column by the height of its elements, with members.

site_column_mesh.py FEM_STAGE SCENES_FOLDER OUTPUT_FOLDER

Means of r_u = 1 - sigma'_v/sigma'_v0 over layers of 2 m, which elements of 2, 1, 0.5 and 0.25 m fill exactly: the element nearest to a
depth lies at another depth on each mesh, where r_u is another. Differences from the 0.25 m mesh over 20 s and all layers, of means over
three motions (times 1 and 1 +- 1e-3).

Displacement is no quantity of this row: which element of the softening layer takes the slip is decided by the last digits.
"""
import pathlib
import sys

import numpy as np

from rows import Report, rms, Runner, table

LAYERS, DEPTH = 15, 30.0  # of 2 m; m
SCALES = (0.0, 1e-3, -1e-3)  # of the motion, less 1
HEIGHTS = (2.0, 1.0, 0.5, 0.25)  # m


def changed(height, peak_acceleration, folder, scenes):
    """The column with elements of that height, a record for each, and its motion of that peak (m/s2)."""
    rows = round(10.0 / height)

    def change(scene):
        geometry = (scenes / "column.geo").read_text()
        scene["mesh"] = {"geometry": "column.geo"}
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "column.geo").write_text(geometry.replace("Transfinite Curve {200:202, 300:302} = 11;",
                                                            f"Transfinite Curve {{200:202, 300:302}} = {rows + 1};"))
        scene["shake"]["peak_acceleration"] = peak_acceleration
        scene["output"]["elements"] = {f"e{k}": [0.5, DEPTH - (k + 0.5) * height] for k in range(3 * rows)}
    return change


def peak(motion):
    return float(np.abs(np.loadtxt(motion, delimiter=",", skiprows=1)[:, 1]).max())


def layer_means(folder, height):
    """r_u (layers from the top, times)."""
    history = table(folder / "history.csv")
    vertical = np.array([history[f"e{k}_effective_stress_yy_Pa"] for k in range(round(DEPTH / height))])
    return (1.0 - vertical / vertical[:, :1]).reshape(LAYERS, -1, vertical.shape[1]).mean(axis=1)


def main():
    program, scenes, output = sys.argv[1:]
    scenes, output = pathlib.Path(scenes) / "site_response_pm4sand", pathlib.Path(output)
    recorded = peak(scenes / "motion.csv")
    report = Report("fem_site_column_mesh", "site_column_mesh")
    run = Runner(program, scenes, output)
    means, spread = {}, {}
    for height in HEIGHTS:
        members = []
        for scale in SCALES:
            label = f"height_{height:g}{scale:+g}"
            folder, _ = run.shake("fem.json", label, changed(height, recorded * (1.0 + scale), output / label, scenes))
            members.append(layer_means(folder, height))
        means[height], spread[height] = np.mean(members, axis=0), rms(np.std(members, axis=0, ddof=1))
    error = {h: rms(means[h] - means[0.25]) for h in HEIGHTS[:-1]}
    against = "elements of 0.25 m"
    for height, ceiling in ((2.0, 0.15), (1.0, 0.1), (0.5, 0.04)):
        report.add(f"RMS of r_u in layers of 2 m, elements of {height:g} m (members +-{spread[height]:.1g})",
                   error[height], ceiling, against)
    report.add("the same, elements of 1 m over those of 0.5 m", error[1.0] / error[0.5], 2.0, "first order", compare="at_least")

    def draw(plt):
        figure, axis = plt.subplots(figsize=(4.5, 3.4))
        middle = 2.0 * np.arange(LAYERS) + 1.0
        for height in HEIGHTS:
            axis.plot(means[height][:, -1], middle, "o-", ms=3, lw=0.8, label=f"{height:g} m")
        axis.set(xlabel="$r_u$ after 20 s, mean of the layer", ylabel="depth, m", ylim=(DEPTH, 0))
        axis.legend(title="elements", fontsize=7)
        return figure

    report.picture("site_column_mesh.png", "r_u of the site response column by the height of its elements", draw)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
