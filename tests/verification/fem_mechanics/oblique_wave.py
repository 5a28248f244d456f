#!/usr/bin/python3
"""Waves of a line force meet side and base dashpots at up to 45 degrees: how much energy comes back.

oblique_wave.py FEM_STAGE REPOSITORY OUTPUT_FOLDER

Two scenes, a full space (body waves alone) and a half space (with a Rayleigh wave), are run as they are and with
boundaries so far off that nothing returns in time; the mesh is the same, so the difference of the two is what the
boundaries sent back. Its largest energy is compared with all that the force emitted, and in the full space with Lysmer and Kuhlemeyer's dashpots under plane waves, averaged over the far field of a line force.
"""
import cmath
import json
import math
import os
import pathlib
import sys
import time

import numpy as np

from verify import Runner, State

CEILING = 0.05  # dashpots take 95 % and more of plane waves at such angles
SHEAR, DENSITY = 76e6, 1900.0  # Poisson's ratio 0.25: both Lame constants are G
VS, VP = math.sqrt(SHEAR / DENSITY), math.sqrt(3 * SHEAR / DENSITY)
WIDTH, ELEMENT = 60.0, 1.5


def dashpot_tractions(kx, ky, kind):
    """What is left of the dashpots' balance, sigma_xx + rho V_p v_x and sigma_xy + rho V_s v_y, for a unit plane wave of slowness (kx, ky)."""
    u = (kx * VP, ky * VP) if kind == "p" else (-ky * VS, kx * VS)
    sxx = SHEAR * (kx * u[0] + ky * u[1]) + 2 * SHEAR * kx * u[0]
    sxy = SHEAR * (ky * u[0] + kx * u[1])
    return sxx - DENSITY * VP * u[0], sxy - DENSITY * VS * u[1]


def reflected_share(kind, angle):
    """Energy that a dashpot boundary returns of a plane wave at an angle (rad) from its normal."""
    ky = math.sin(angle) / (VP if kind == "p" else VS)
    kp, ks = cmath.sqrt(1 / VP**2 - ky**2), cmath.sqrt(1 / VS**2 - ky**2)
    incident = dashpot_tractions(kp if kind == "p" else ks, ky, kind)
    columns = np.array([dashpot_tractions(-kp, ky, "p"), dashpot_tractions(-ks, ky, "s")]).T
    p, s = np.linalg.solve(columns, -np.array(incident))
    flux = {"p": VP**2 * kp.real, "s": VS**2 * ks.real}  # an evanescent wave carries none
    return (abs(p) ** 2 * flux["p"] + abs(s) ** 2 * flux["s"]) / flux[kind]


def plane_wave_theory():
    """The far field's flux goes as cos^2/V_p^2 for pressure and sin^2/V_s^2 for shear waves, from the force's direction."""
    returned = emitted = 0.0
    for psi in (np.arange(1000) + 0.5) / 1000 * math.pi / 2:
        for kind, flux in (("p", (math.cos(psi) / VP) ** 2), ("s", (math.sin(psi) / VS) ** 2)):
            returned += flux * reflected_share(kind, min(psi, math.pi / 2 - psi))
            emitted += flux
    return returned / emitted


class Block:
    """The block's part of a state on either mesh, in an order that the two share."""

    def __init__(self, state):
        self.cells = np.flatnonzero((state.centre[:, 0] < WIDTH) & (state.centre[:, 1] > -WIDTH))
        key = lambda xy: np.round(xy / (0.5 * ELEMENT)).astype(int)
        self.cells = self.cells[np.lexsort(key(state.centre[self.cells]).T)]
        self.nodes = np.unique(state.quads[self.cells])
        self.nodes = self.nodes[np.lexsort(key(state.x[self.nodes]).T)]
        self.x = state.x[self.nodes]
        place = np.full(len(state.x), -1)
        place[self.nodes] = np.arange(len(self.nodes))
        self.mass = np.bincount(place[state.quads[self.cells]].ravel()) * DENSITY * ELEMENT**2 / 4

    def field(self, state):
        return state.node["velocity"][self.nodes, :2], state.cell["effective_stress"][self.cells]

    def energy(self, velocity, stress):
        """Kinetic and elastic (plane strain) energy per metre."""
        nu, xx, yy, xy = 0.25, stress[:, 0], stress[:, 1], stress[:, 3]
        strain = ((1 - nu) * (xx**2 + yy**2) - 2 * nu * xx * yy + 2 * xy**2) / (4 * SHEAR)
        return 0.5 * np.sum(self.mass * np.sum(velocity**2, axis=1)) + strain.sum() * ELEMENT**2


def picture(block, times, direct, reflected, fields, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(13, 4))
    for axis, (title, velocity) in zip(axes, fields):
        speed = np.hypot(*velocity.T)
        shown = axis.tripcolor(*block.x.T, speed, shading="gouraud", cmap="viridis")
        figure.colorbar(shown, ax=axis, label="speed, m/s")
        axis.set(title=title, xlabel="x, m", ylabel="y, m", aspect="equal")
    axes[2].semilogy(times, np.maximum(direct, 1e-6), label="in the block, boundaries far off")
    axes[2].semilogy(times, np.maximum(reflected, 1e-6), label="sent back by the dashpots")
    axes[2].axhline(CEILING, color="k", lw=0.8, ls="--", label="ceiling")
    axes[2].set(xlabel="time, s", title="energy over the emitted (1)", ylim=(1e-5, 2))
    axes[2].legend(fontsize=8)
    axes[2].grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(path, dpi=90)


def measure(runner, case):
    """Histories of energy over the emitted, in the block and sent back, and two fields for the picture."""
    near = runner.run(f"oblique_wave/{case}.json", label=case)
    far = runner.run(f"oblique_wave/{case}.json", label=f"{case}_reference", size="reference")
    emitted = json.loads((far / "summary.json").read_text())["energy_J"]["external_work"]
    times, direct, reflected, fields, blocks = [], [], [], [], None
    for path in sorted(near.glob("snapshot_t*.h5")):
        a, b = State(path), State(far / path.name)
        blocks = blocks or (Block(a), Block(b))
        assert np.allclose(blocks[0].x, blocks[1].x)
        (va, sa), (vb, sb) = blocks[0].field(a), blocks[1].field(b)
        times.append(float(path.stem.split("_t")[1]))
        direct.append(blocks[0].energy(vb, sb) / emitted)
        reflected.append(blocks[0].energy(va - vb, sa - sb) / emitted)
        fields.append((va, va - vb))
    worst, early = int(np.argmax(reflected)), int(np.argmin(np.abs(np.array(times) - 0.4)))
    shown = [(f"waves at {times[early]:g} s", fields[early][0]), (f"sent back, {times[worst]:g} s", fields[worst][1])]
    return reflected[worst], (blocks[0], times, direct, reflected, shown)


def main():
    program, root, output = sys.argv[1:]
    runner, folder = Runner(program, root, output), os.environ.get("TAILRUN_VERIFICATION_DIR")
    cases = {"fem": ("full space, pressure and shear waves",
                     f"energy that side and base dashpots send back of the waves of a line force in a full space, over the emitted "
                     f"(plane waves would: {plane_wave_theory():.4f})"),
             "half_space": ("half space, body waves and a Rayleigh wave",
                            "the same of a line force on a half space, with its Rayleigh wave")}
    rows = []
    for case, (title, quantity) in cases.items():
        start = time.time()
        error, shown = measure(runner, case)
        file = f"fem_oblique_wave_{case}.png"
        picture(*shown, pathlib.Path(folder or output) / file)
        rows.append({"name": "fem_oblique_wave", "row": "oblique_wave", "against": "a mesh 2.5 times as large",
                     "quantity": quantity, "error": error, "ceiling": CEILING, "seconds": time.time() - start,
                     "pictures": [{"file": file, "caption": f"A line force at the upper left corner ({title}), what the dashpots of "
                                   "the right side and the base send back, and the energy of both"}]})
    if folder:
        (pathlib.Path(folder) / "fem_oblique_wave.json").write_text(json.dumps(rows, indent=1) + "\n")
    holds = [0.0 < row["error"] <= row["ceiling"] for row in rows]
    for row, ok in zip(rows, holds):
        print(f"{'ok  ' if ok else 'FAIL'} {row['quantity']}: {row['error']:.4g}, ceiling {CEILING:g}")
    sys.exit(0 if all(holds) else 1)


if __name__ == "__main__":
    main()
