#!/usr/bin/env python3
"""Run time against error of mpm_stage: what a shape function, a transfer, a smaller cell or a shorter step buys.

    mpm_work_precision.py build/bin/mpm_stage cases tests/verification/mpm -o out/study/mpm
                          [--document docs/mpm_work_precision.md] [--schemes JSON] [--variable NAME=VALUE ...]

Three scenes of cases/verification with known answers or one answer to agree on:
  vortex  (manufactured): an elastic square swings through strains of an eighth; RMS error of the displacement
  bar     (vibrating_bar): small vibration while carried across cells; RMS error of the displacement after 2.2 periods
  block   (cohesive_block): 200 m2 of phi = 0 soil run out and come to rest; the runout, no closed form
Runs take one thread, times are processor seconds of the whole program; each configuration is timed once. --variable sets
an environment variable for every run (for builds that read one); its name and value lead the rows.
"""

import argparse
import json
import math
import os
import pathlib
import resource
import sys

import numpy as np

SCHEMES = {
    "quadratic, AFLIP (default)": {},
    "quadratic, AFLIP, damping 0.1": {"transfer_damping": 0.1},
    "quadratic, APIC": {"transfer": "apic"},
    "quadratic, FLIP 0.99": {"transfer": "flip"},
    "quadratic, PIC": {"transfer": "flip", "flip_share": 0.0},
    "quadratic, FMPM(2)": {"transfer": "fmpm", "fmpm_order": 2},
    "quadratic, FMPM(4)": {"transfer": "fmpm", "fmpm_order": 4},
    "linear, AFLIP": {"shape_function": "linear"},
    "linear, FLIP 0.99": {"shape_function": "linear", "transfer": "flip"},
    "GIMP, AFLIP": {"shape_function": "gimp"},
    "GIMP, FLIP 0.99": {"shape_function": "gimp", "transfer": "flip"},
    "cubic, AFLIP": {"shape_function": "cubic"},
    "cubic, APIC": {"shape_function": "cubic", "transfer": "apic"},
    "cubic, FMPM(2)": {"shape_function": "cubic", "transfer": "fmpm", "fmpm_order": 2},
}


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Study:
    def __init__(self, program, cases, checks, output):
        sys.path.insert(0, str(checks))
        from lagrangian import TaylorGreenSolid
        from runner import Runner

        self.solid, self.runner_of = TaylorGreenSolid, Runner
        self.program, self.scenes, self.output = program, cases / "verification", output
        self.motion = None

    def timed(self, runner, scene, label, particles=None):
        """The run, or None where it fails, and its processor seconds."""
        start = processor_seconds()
        try:
            run = runner.run(scene, label, particles)
        except Exception as failure:  # a scheme that fails is a line of the table
            print(f"  {label}: {failure}", file=sys.stderr)
            run = None
        return run, processor_seconds() - start

    def vortex(self, scheme, cells):
        runner = self.runner_of(str(self.program), self.scenes, "manufactured", self.output / "vortex")
        scene = runner.scene()
        scene["scheme"] = scheme
        scene["grid"]["cell_size"] = 1.0 / cells
        speed, solid = 3.5, scene["materials"]["solid"]
        if self.motion is None:
            exact = self.solid(solid["youngs_modulus"], solid["poisson_ratio"], solid["density"], speed, modes=16)
            self.motion, _ = exact.solve(scene["time"]["end"])

        def start(p):
            x, y = math.pi * p["x"][:, 0], math.pi * p["x"][:, 1]
            p["velocity"][:, 0] = speed * np.sin(x) * np.cos(y)
            p["velocity"][:, 1] = -speed * np.cos(x) * np.sin(y)

        run, seconds = self.timed(runner, scene, f"{cells}", runner.particles(scene, start))
        if run is None:
            return None, seconds
        x0 = run.frame(0)["x"][:, :2]
        moved = self.motion(x0) - x0
        return math.sqrt(np.mean(np.sum((run.frame()["x"][:, :2] - x0 - moved) ** 2, axis=1))
                         / np.mean(np.sum(moved**2, axis=1))), seconds

    def bar(self, scheme, cells):
        runner = self.runner_of(str(self.program), self.scenes, "vibrating_bar", self.output / "bar")
        scene, h = runner.scene(), 8.0 / cells
        scene["scheme"] = scheme
        amplitude, omega = scene["particles"][0]["velocity_wave"]["amplitude"], math.pi / 16.0 * math.sqrt(4e3)
        scene["grid"]["cell_size"] = h
        scene["domain"]["high"][0] = 8.0 + 4 * h
        scene["particles"][0]["high"][1] = 2 * h
        scene["time"].update(end=2.2 * 2 * math.pi / omega, courant=4.0 / cells)
        run, seconds = self.timed(runner, scene, f"{cells}")
        if run is None:
            return None, seconds
        x = run.frame(0)["x"][:, 0]
        exact = amplitude / omega * np.sin(math.pi * x / 16.0) * math.sin(omega * run.summary["simulated_time_s"])
        return math.sqrt(np.mean((run.frame()["x"][:, 0] - x - exact) ** 2)) / (amplitude / omega), seconds

    def block(self, scheme, cell):
        runner = self.runner_of(str(self.program), self.scenes, "cohesive_block", self.output / "block")
        scene = runner.scene()
        scene["scheme"] = scheme
        scene["grid"]["cell_size"] = cell
        run, seconds = self.timed(runner, scene, f"{cell}")
        return None if run is None else run.front["front_m"][-1] - 20.0, seconds


def number(value, digits="{:.3g}"):
    return "fails" if value is None or not math.isfinite(value) else digits.format(value)


def row_of(label, results, percent):
    cells = []
    for value, seconds in results:
        shown = number(100 * value if percent and value is not None else value, "{:.2g}" if percent else "{:.1f}")
        cells += [shown, f"{seconds:.1f}"]
    return f"| {label} | " + " | ".join(cells) + " |"


def table(title, heads, unit, rows):
    columns = " | ".join(f"{h}: {unit} | s" for h in heads)
    return [f"## {title}", "", f"| scheme | {columns} |", "|---" * (1 + 2 * len(heads)) + "|", *rows, ""]


def picture(studies, path):
    """Error over processor seconds, one line per scheme through its cell sizes; runout in place of an error."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(13, 5.6))
    markers = "osD^v<>pPX*hd+x"
    for axis, study in zip(axes, studies):
        for index, (name, results) in enumerate(study["results"].items()):
            points = [(t, e) for e, t in results if e is not None and math.isfinite(e)]
            if not points:
                continue
            dashes = {"linear": ":", "GIMP": "-.", "cubic": "--"}.get(name.split(",")[0], "-")
            axis.plot(*zip(*points), dashes, marker=markers[index % len(markers)], ms=4, lw=1.0, color=f"C{index % 10}",
                      label=name)
        axis.set(xscale="log", xlabel="processor seconds", title=study["title"],
                 ylabel="error, %" if study["percent"] else study["unit"])
        if study["percent"]:
            axis.set_yscale("log")
        axis.title.set_fontsize(9)
        axis.grid(alpha=0.3, which="both")
    figure.legend(*axes[0].get_legend_handles_labels(), fontsize=7, loc="lower center", ncol=5)
    figure.tight_layout(rect=(0.0, 0.12, 1.0, 1.0))
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=90)
    plt.close(figure)


def document(tables, path):
    """Tables between an introduction and what to conclude from them, mpm_scheme_notes.md."""
    lines = ["# Run time against error of the MPM stage", "",
             "Written by `make -f Makefile.cases study-mpm`; do not edit. Three scenes of `cases/verification`:", "",
             "* vortex (`manufactured`): an elastic square swings through strains of an eighth; RMS error of the displacement",
             "* bar (`vibrating_bar`): small vibration while carried across cells; RMS error of the displacement after 2.2 periods",
             "* block (`cohesive_block`): 200 m2 of phi = 0 soil run out and come to rest; the runout, of which no closed form is known",
             "",
             "Processor seconds of the whole program on one thread, each configuration timed once.", "",
             "![errors over run time](pictures/mpm_work_precision.png)", "", *tables,
             (pathlib.Path(__file__).parent / "mpm_scheme_notes.md").read_text().rstrip()]
    path.write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("cases", type=pathlib.Path)
    parser.add_argument("checks", type=pathlib.Path, help="folder with runner.py and lagrangian.py")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--schemes", help="JSON object that takes the place of the list of schemes")
    parser.add_argument("--variable", action="append", default=[])
    parser.add_argument("--write", type=pathlib.Path, help="the tables, as Markdown")
    parser.add_argument("--document", type=pathlib.Path, help="tables and notes, and a picture in pictures/ beside it")
    arguments = parser.parse_args()
    os.environ["OMP_NUM_THREADS"] = "1"
    for pair in arguments.variable:
        os.environ[pair.split("=")[0]] = pair.split("=")[1]
    lead = ", ".join(arguments.variable) + (": " if arguments.variable else "")
    study = Study(arguments.program.resolve(), arguments.cases.resolve(), arguments.checks.resolve(), arguments.output)
    schemes = json.loads(arguments.schemes) if arguments.schemes else SCHEMES
    plan = (("An elastic square in a vortex's velocity field", (16, 32, 64), "error, %", study.vortex, True,
             lambda n: f"{n} cells a side"),
            ("A bar that vibrates while it is carried across cells", (16, 32, 64), "error, %", study.bar, True,
             lambda n: f"{n} cells long"),
            ("A block of phi = 0 soil to rest", (1.0, 0.5, 0.25), "runout, m", study.block, False, lambda h: f"{h:g} m"))
    lines, studies = [], []
    for title, sizes, unit, scene, percent, head in plan:
        rows, found = [], {}
        for name, scheme in schemes.items():
            results = [scene(scheme, size) for size in sizes]
            found[lead + name] = [(100 * e if percent and e is not None else e, t) for e, t in results]
            rows.append(row_of(lead + name, results, percent))
            print(title[:20], rows[-1], flush=True)
        lines += table(title, [head(s) for s in sizes], unit, rows)
        studies.append({"title": title, "unit": unit, "percent": percent, "results": found})
    (arguments.output / "work_precision.json").write_text(json.dumps(studies, indent=1) + "\n")
    if arguments.write:
        arguments.write.write_text("\n".join(lines))
    if arguments.document:
        picture(studies, arguments.document.parent / "pictures" / "mpm_work_precision.png")
        document(lines, arguments.document)
        print(arguments.document)


if __name__ == "__main__":
    main()
