#!/usr/bin/env python3
"""Run time against error of fem_stage: what a shorter step, a finer mesh, a tighter tolerance or another integrator buys.

    fem_work_precision.py build/bin/fem_stage cases -o out/study/fem [--document docs/fem_work_precision.md] [--dam]

The site response column (cases/verification/site_response_pm4sand) is run over time steps, element heights, tolerances
and integrators; errors are against the finest of each row. With --dam the main case's coarse mesh is run over time steps as
well, and all its meshes at the case's own time step. Runs take one thread, times are processor seconds of the whole
program; each configuration is timed once.
"""

import argparse
import json
import pathlib
import re
import resource
import subprocess
import sys

import numpy as np

DEPTH, LAYERS = 30.0, 15  # m; of 2 m, which elements of every height of the study fill exactly
STEPS = (0.02, 0.01, 0.005, 0.002, 0.001, 0.0005)


def read_case(path):
    return json.loads(re.sub(r"(?m)^\s*//.*$", "", path.read_text()))


def series(path):
    data = np.genfromtxt(path, delimiter=",", names=True, deletechars="")
    return {name: data[name] for name in data.dtype.names}


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Column:
    """The site response column with changes; results are kept, so no configuration runs twice."""

    def __init__(self, program, cases, output):
        self.program, self.output = program, output / "column"
        self.folder = cases / "verification" / "site_response_pm4sand"
        self.geometry = (self.folder / "column.geo").read_text()
        self.done = {}

    def run(self, step=0.002, elements=10, tolerance=None, newmark=None, damping=True, element=None, mode=None):
        key = json.dumps([step, elements, tolerance, newmark, damping, element, mode])
        if key in self.done:
            return self.done[key]
        folder = self.output / f"run_{len(self.done):02d}"
        folder.mkdir(parents=True, exist_ok=True)
        scene = read_case(self.folder / "fem.json")
        geometry = self.geometry.replace("Transfinite Curve {200:202, 300:302} = 11;",
                                         f"Transfinite Curve {{200:202, 300:302}} = {elements + 1};")
        (folder / "column.geo").write_text(geometry)
        scene["mesh"] = {"geometry": "column.geo"}
        shake = scene["shake"]
        shake["motion"] = str((self.folder / shake["motion"]).resolve())
        shake["time_step"] = step
        if tolerance:
            shake.setdefault("solver", {})["tolerance"] = tolerance
        if newmark:
            shake["newmark"] = newmark
        if not damping:
            shake.pop("rayleigh_damping", None)
        if element:
            scene["element"] = element
        if mode:
            for material in scene["materials"].values():
                material["compatibility"] = mode
        scene["output"]["history_interval"] = max(0.01, step)
        height = 10.0 / elements
        scene["output"]["elements"] = {f"e{k}": [0.5, DEPTH - (k + 0.5) * height] for k in range(3 * elements)}
        (folder / "fem.json").write_text(json.dumps(scene, indent=1))
        command = [self.program, "run", str(folder / "fem.json"), "-o", str(folder), "--quiet", "--threads", "1"]
        before = processor_seconds()
        failed = subprocess.run(command, capture_output=True).returncode != 0
        result = None
        if not failed:
            summary = json.loads((folder / "summary.json").read_text())
            history = series(folder / "history.csv")
            result = {"seconds": processor_seconds() - before, "history": history, "elements": 3 * elements,
                      "iterations": summary["counts"]["iterations_per_step"],
                      "halvings": summary["counts"]["step_halvings"]}
        self.done[key] = result
        return result


def pore_pressure_ratio(result, times):
    """Means over layers of 2 m (layers, times): elements of another height have their centres at other depths, where r_u is another."""
    history = result["history"]
    vertical = np.array([history[f"e{k}_effective_stress_yy_Pa"] for k in range(result["elements"])])
    layers = (1.0 - vertical / vertical[:, :1]).reshape(LAYERS, -1, vertical.shape[1]).mean(axis=1)
    return np.array([np.interp(times, history["time_s"], layer) for layer in layers])


def errors(result, reference):
    """RMS of surface acceleration and of displacement against the base over the reference's, RMS of r_u over layers and time."""
    t = reference["history"]["time_s"]
    mine, ref = result["history"], reference["history"]
    at = lambda name: np.interp(t, mine["time_s"], mine[name])
    sheared = ref["surface_ux_m"] - ref["base_ux_m"]
    return {
        "acceleration": rms(at("surface_ax_m_s2") - ref["surface_ax_m_s2"]) / rms(ref["surface_ax_m_s2"]),
        "displacement": rms(at("surface_ux_m") - at("base_ux_m") - sheared) / rms(sheared),
        "r_u": rms(pore_pressure_ratio(result, t) - pore_pressure_ratio(reference, t)),
    }


def sweep(title, runs, reference):
    """Rows (label, seconds, iterations per step, errors) of one study; a run that failed has no figures."""
    print(title, flush=True)
    rows = []
    for label, run in runs:
        result = run()
        if result is None:
            rows.append({"label": label, "failed": True})
            print(f"  {label:34s} failed", flush=True)
            continue
        row = {"label": label, "seconds": result["seconds"], "iterations": result["iterations"],
               "halvings": result["halvings"], **errors(result, reference)}
        rows.append(row)
        print(f"  {label:34s} {row['seconds']:7.2f} s  acceleration {row['acceleration']:.4f}  displacement "
              f"{row['displacement']:.4f}  r_u {row['r_u']:.4f}", flush=True)
    return {"title": title, "rows": rows}


def column_studies(column):
    finest = column.run(step=0.00025)
    finest_mesh = column.run(elements=40)
    damped, undamped = {"gamma": 0.6, "beta": 0.3025}, {"gamma": 0.5, "beta": 0.25}
    tight = column.run(tolerance=1e-9)
    studies = [
        sweep("Time step (reference 0.00025 s)",
              [(f"{s:g} s", lambda s=s: column.run(step=s)) for s in STEPS], finest),
        sweep("Time step, compatible mode (the same reference)",
              [(f"{s:g} s", lambda s=s: column.run(step=s, mode="opensees")) for s in (0.01, 0.005, 0.002)], finest),
        sweep("Element height (reference 0.25 m), step 0.002 s",
              [(f"{10 / n:g} m", lambda n=n: column.run(elements=n)) for n in (5, 10, 20)], finest_mesh),
        sweep("Tolerance (reference 1e-9), step 0.002 s",
              [(f"{t:.0e} of the weight", lambda t=t: column.run(tolerance=t)) for t in (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)], tight),
        sweep("Integrator (reference: the damped one at 0.00025 s), step 0.002 s",
              [("gamma 0.6, Rayleigh 1 %", lambda: column.run(newmark=damped)),
               ("gamma 0.5, Rayleigh 1 %", lambda: column.run(newmark=undamped)),
               ("gamma 0.6, no Rayleigh", lambda: column.run(newmark=damped, damping=False)),
               ("gamma 0.5, no Rayleigh", lambda: column.run(newmark=undamped, damping=False))], finest),
        sweep("Pressure quadrature and hourglass shape (reference: default), step 0.002 s",
              [("one point", lambda: column.run(element={"pressure_quadrature": 1})),
               ("one point, OpenSees' hourglass",
                lambda: column.run(element={"pressure_quadrature": 1, "hourglass_shape": "opensees"}))], column.run()),
    ]
    return studies


def dam(program, cases, output, size, step):
    folder = output / f"dam_{size}_{step:g}"
    folder.mkdir(parents=True, exist_ok=True)
    source = cases / "mochikoshi"
    scene = read_case(source / "fem.json")
    for key in ("geometry", "file"):
        if key in scene["mesh"]:
            scene["mesh"][key] = str((source / scene["mesh"][key]).resolve())
    scene["shake"]["motion"] = str((source / scene["shake"]["motion"]).resolve())
    scene["shake"]["time_step"] = step
    scene["output"]["snapshots"] = []
    (folder / "fem.json").write_text(json.dumps(scene, indent=1))
    command = [program, "run", str(folder / "fem.json"), "-o", str(folder), "--quiet", "--size", size, "--threads", "1"]
    before = processor_seconds()
    if subprocess.run(command, capture_output=True).returncode != 0:
        return None
    s = json.loads((folder / "summary.json").read_text())
    return {"size": size, "step": step, "elements": s["elements"], "seconds": processor_seconds() - before,
            "displacement_m": s["largest_displacement_m"], "liquefied_depth_m": s["liquefied_depth_m"],
            "mean_r_u": s["mean_excess_pore_pressure_ratio"], "halvings": s["counts"]["step_halvings"],
            "factorisations_per_100_steps": s["counts"]["factorisations_per_100_steps"]}


def dam_study(program, cases, output):
    rows = []
    for size, step in [("coarse", 0.02), ("coarse", 0.01), ("coarse", 0.005), ("coarse", 0.0025), ("coarse", 0.00125),
                       ("default", 0.005), ("fine", 0.005)]:
        row = dam(program, cases, output, size, step)
        rows.append(row or {"size": size, "step": step, "failed": True})
        print("  " + json.dumps(rows[-1]), flush=True)
    return rows


def cost_exponent(rows):
    """Of seconds over elements between the coarse and the fine mesh at one time step."""
    ends = [next((r for r in rows if r["size"] == s and r["step"] == 0.005 and "seconds" in r), None) for s in ("coarse", "fine")]
    if None in ends:
        return None
    return float(np.log(ends[1]["seconds"] / ends[0]["seconds"]) / np.log(ends[1]["elements"] / ends[0]["elements"]))


def picture(studies, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(12, 5.0), sharex=True)
    for axis, quantity in zip(axes, ("acceleration", "displacement", "r_u")):
        for index, study in enumerate(studies):
            rows = [r for r in study["rows"] if "seconds" in r and r[quantity] > 0.0]
            if not rows:
                continue
            axis.loglog([r["seconds"] for r in rows], [r[quantity] for r in rows], "o-", ms=4, lw=1.0,
                        color=f"C{index}", label=study["title"])
            for r in rows:
                axis.annotate(r["label"], (r["seconds"], r[quantity]), fontsize=5.5, xytext=(3, 2), textcoords="offset points")
        axis.set(xlabel="processor seconds", title={"acceleration": "surface acceleration, RMS (1)",
                 "displacement": "surface displacement, RMS (1)", "r_u": "$r_u$, RMS (1)"}[quantity])
        axis.grid(alpha=0.3, which="both")
    axes[0].set_ylabel("error")
    figure.legend(*axes[0].get_legend_handles_labels(), fontsize=7, loc="lower center", ncol=2)
    figure.tight_layout(rect=(0.0, 0.14, 1.0, 1.0))
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=90)


def document(studies, dam_rows, path):
    lines = ["# Run time against error of the FEM stage", "",
             "Written by `make -f Makefile.cases study-fem`; do not edit. The 30 m column of `cases/verification/site_response_pm4sand`, 20 s, "
             "processor seconds of the whole program, each run timed once. Errors of surface acceleration and of surface displacement against the base are RMS over the reference's RMS; "
             "of r_u = 1 - sigma'_v/sigma'_v0 the RMS difference of means over layers of 2 m. The permanent part of the displacement is a matter of which thin layer slips, "
             "which the last digits decide ([fem.md](fem.md#what-the-last-digits-decide)): motions times 1 +- 1e-3 move it as much as a step does.", "",
             "![errors over run time](pictures/fem_work_precision.png)"]
    for study in studies:
        lines += ["", f"## {study['title']}", "", "| | seconds | iterations per step | acceleration | displacement | r_u |", "|---|---|---|---|---|---|"]
        for r in study["rows"]:
            lines.append(f"| {r['label']} | failed | | | | |" if "failed" in r else
                         f"| {r['label']} | {r['seconds']:.2f} | {r['iterations']:.1f} | {r['acceleration']:.4f} | "
                         f"{r['displacement']:.4f} | {r['r_u']:.4f} |")
    if dam_rows:
        lines += ["", "## Mochikoshi, 16 s of shaking, processor seconds on one thread", "",
                  "| mesh | quadrilaterals | step s | seconds | steps cut | factorisations per 100 steps | largest displacement m | liquefied depth m | mean r_u |",
                  "|---|---|---|---|---|---|---|---|---|"]
        for r in dam_rows:
            lines.append(f"| {r['size']} | | {r['step']:g} | failed | | | | | |" if "failed" in r else
                         f"| {r['size']} | {r['elements']} | {r['step']:g} | {r['seconds']:.1f} | {r['halvings']} | "
                         f"{r['factorisations_per_100_steps']:.1f} | {r['displacement_m']:.2f} | {r['liquefied_depth_m']:.1f} | {r['mean_r_u']:.3f} |")
        exponent = cost_exponent(dam_rows)
        if exponent is not None:
            lines += ["", f"Seconds grow as n^{exponent:.2f} from the coarse to the fine mesh."]
    # Studies whose losers are no longer in the program: figures of the commits that the notes name.
    lines += ["", (pathlib.Path(__file__).parent / "fem_solver_notes.md").read_text().rstrip()]
    path.write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("cases", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--document", type=pathlib.Path)
    parser.add_argument("--dam", action="store_true")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    studies = column_studies(Column(arguments.program, arguments.cases.resolve(), arguments.output))
    dam_rows = dam_study(arguments.program, arguments.cases.resolve(), arguments.output) if arguments.dam else []
    (arguments.output / "work_precision.json").write_text(json.dumps({"column": studies, "dam": dam_rows}, indent=1) + "\n")
    if arguments.document:
        picture(studies, arguments.document.parent / "pictures" / "fem_work_precision.png")
        document(studies, dam_rows, arguments.document)
        print(arguments.document)
    return 0


if __name__ == "__main__":
    sys.exit(main())
