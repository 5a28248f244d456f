"""Pictures of the rows that people would rather look at, from what their runs left behind; for docs/verification.md."""
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from collapse import BUI_SURFACE, MARTIN_MOYCE  # noqa: E402
from potential_flow import collapse  # noqa: E402
from runner import G, Run  # noqa: E402


def bui_2008(folder, path):
    frame = Run(folder).frame()
    figure, axes = plt.subplots(figsize=(9, 3), layout="constrained")
    axes.scatter(*frame["x"][:, :2].T, s=0.4, color="peru", label="particles at rest")
    axes.plot(*BUI_SURFACE.T, "ko", markersize=4, label="experiment, Bui et al. 2008")
    axes.set(xlabel="x, m", ylabel="y, m", aspect="equal")
    axes.legend()
    figure.savefig(path)
    return "Column of aluminium bars: particles at rest and the experiment's free surface"


def martin_moyce(folder, path):
    front = Run(folder).front
    a = 0.05715
    computed = front["time_s"] * math.sqrt(2 * G / a)
    times, tip = collapse(2.0, MARTIN_MOYCE[MARTIN_MOYCE[:, 0] <= computed[-1]][-1, 0] / math.sqrt(2.0) + 0.02)
    figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
    axes.plot(computed, front["front_m"] / a, label="mpm_stage, outermost particle")
    axes.plot(computed, front["robust_front_m"] / a, ":", color="tab:blue", label="all but 0.5 % of the mass")
    axes.plot(times * math.sqrt(2.0), tip, "--", label="potential flow, boundary elements")
    axes.plot(*MARTIN_MOYCE.T, "ko", markersize=4, label="experiment, Martin & Moyce 1952")
    axes.set(xlabel="t sqrt(2 g / a)", ylabel="front z / a", xlim=(0, 8.2), ylim=(1, 14))
    axes.legend()
    figure.savefig(path)
    return "Dam break: front against time"


def incline(folder, path):
    figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
    angles = np.arange(0, 50, 5)
    fine = np.radians(np.linspace(0, 45, 200))
    for mu, colour in ((0.35, "tab:blue"), (0.6, "tab:orange")):
        found = []
        for angle in angles:
            front = Run(folder / f"mu{mu}_{angle}").front
            beta, t = math.radians(angle), front["time_s"]
            along = front["centre_x_m"] * math.cos(beta) - front["centre_y_m"] * math.sin(beta)
            found.append(2.0 * np.polyfit(t[t >= 0.3], along[t >= 0.3], 2)[0])
        axes.plot(np.degrees(fine), np.maximum(0.0, G * (np.sin(fine) - mu * np.cos(fine))), color=colour)
        axes.plot(angles, found, "o", color=colour, label=f"friction {mu}")
    axes.set(xlabel="angle of the ground to the grid, degrees", ylabel="acceleration, m/s2")
    axes.legend(title="lines: g (sin b - mu cos b), 0 when it sticks")
    figure.savefig(path)
    return "Block on an inclined plane at ten angles to the grid"


def strip_footing(folder, path):
    run = Run(folder)
    history, frame = run.series("bodies.csv"), run.frame()
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.6), layout="constrained")
    push = history["footing_force_y_N"]
    left.plot(-1e3 * history["footing_displacement_y_m"], 1e-3 * push)
    left.set(xlabel="settlement, mm", ylabel="force on half of the footing, kN/m")
    pressure = -1e-3 * frame["effective_stress"][:, :3].mean(axis=1)
    dots = right.scatter(*frame["x"][:, :2].T, c=pressure, s=3, cmap="viridis", vmin=np.quantile(pressure, 0.01),
                         vmax=np.quantile(pressure, 0.99), rasterized=True)
    right.set(xlabel="x, m", ylabel="y, m", aspect="equal")
    figure.colorbar(dots, label="mean stress, kPa (compression)")
    figure.savefig(path)
    return "Strip footing on phi = 0 soil: force over settlement, and mean stress under it at the end"


def cohesive_block(folder, path):
    figure, rows = plt.subplots(3, 1, figsize=(10, 6.4), layout="constrained")
    for axes, label, title in ((rows[0], "nu049_plain", "without averages"), (rows[1], "nu049_averaged", "with averages")):
        frame = Run(folder / label).frame()
        pressure = -1e-3 * frame["effective_stress"][:, :3].mean(axis=1)
        dots = axes.scatter(*frame["x"][:, :2].T, c=pressure, s=1.5, cmap="viridis", vmin=-20, vmax=40, rasterized=True)
        axes.set(title=f"nu = 0.49, {title}", xlabel="x, m", ylabel="y, m", xlim=(-62, 85), ylim=(0, 3.5))
    figure.colorbar(dots, ax=rows[:2], label="mean stress, kPa")
    for cell in (2, 1, 0.5, 0.25):
        front = Run(folder / f"cell{cell:g}").front
        rows[2].plot(front["time_s"], front["robust_front_m"], label=f"{cell:g} m")
    rows[2].set(xlabel="time, s", ylabel="front, m")
    rows[2].legend(title="cells")
    figure.savefig(path)
    return "Cohesive block at rest: mean stress before and after the cure of the checkerboard; its front by cell size"


def of_row(name, output, folder):
    """Draws into `folder` what there is to draw of a row whose runs lie in `output`: a list of file and caption."""
    draw = globals().get(name)
    if draw is None:
        return []
    file = f"mpm_{name}.png"
    with plt.rc_context({"savefig.dpi": 110, "font.size": 9}):
        caption = draw(output, folder / file)
    plt.close("all")
    return [{"file": file, "caption": caption}]
