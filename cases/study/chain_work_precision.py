#!/usr/bin/env python3
"""Run time against error of the whole chain: what a finer mesh, a smaller cell, a shorter step or a tighter tolerance buys of the final answer.

    chain_work_precision.py build/bin cases/mochikoshi -o out/study/chain [--members 3] [--jobs 2] [--document docs/chain_work_precision.md]

Each way of computing (WAYS) is one shake a member, handed over at the case's own time, and a runout to its end. Members differ in
nothing physical: motions scaled by 1, 1 + 1e-5, 1 - 1e-5 ... Errors are those of members' means against the mean of the finest way,
with the standard error of both. Stages take one thread, times are their processor seconds (mesh to runout, no pictures). What is there
already is not computed again.
"""

import argparse
import json
import math
import os
import statistics
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "cases" / name) for name in ("run", "plot", "what_if")]
import headline  # noqa: E402
import style  # noqa: E402
from stage import read_json, write_json  # noqa: E402
from stages import Chain, Place  # noqa: E402

NUMBERS = ("flow_front_m", "flowed_mass_kg", "mean_pore_pressure_ratio")


@dataclass(frozen=True)
class Way:
    """Sizes of the mesh and of the runout's cells, by the case's words; further settings of either stage."""

    mesh: str
    cells: str
    fem: tuple = ()
    mpm: tuple = ()
    words: str = ""

    @property
    def name(self):
        return f"{self.mesh} mesh, {self.cells} cells" + (f", {self.words}" if self.words else "")

    @property
    def family(self):
        """Colour in the picture."""
        return self.words or f"{self.mesh} mesh"


MESHES, CELLS = ("coarse", "default", "fine"), ("coarse", "default")
DEFAULT, FINEST = Way("default", "default"), Way("fine", "default")
WAYS = tuple(Way(mesh, cells) for mesh in MESHES for cells in CELLS) + (
    Way("default", "coarse", fem=("/shake/time_step=0.01",), words="steps of the shake 0.01 s"),
    Way("default", "coarse", fem=("/shake/time_step=0.0025",), words="steps of the shake 0.0025 s"),
    Way("default", "coarse", fem=("/shake/solver/tolerance=1e-3",), words="tolerance of the shake 1e-3"),
    Way("default", "coarse", fem=("/shake/solver/tolerance=1e-5",), words="tolerance of the shake 1e-5"),
    Way("default", "coarse", mpm=("/time/courant=0.5",), words="courant 0.5"),
    Way("default", "coarse", mpm=("/time/courant=0.35",), words="courant 0.35"),
)


def processor_seconds(command, log):
    """Of a command that has to succeed."""
    with log.open("w") as file:
        process = subprocess.Popen(command, stdout=file, stderr=subprocess.STDOUT, cwd=ROOT)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise RuntimeError(f"{' '.join(command)}\nended with {process.returncode}; see {log}")
    return used.ru_utime + used.ru_stime


class Study:
    def __init__(self, bin, case, output):
        self.bin, self.case, self.output = bin, case, output
        content = Chain(case, bin).content("fem")
        self.peak = content["shake"]["peak_acceleration"]

    def scale(self, member):
        """1, 1 + 1e-5, 1 - 1e-5, 1 + 2e-5 ..."""
        return 1.0 + (member + 1) // 2 * (1e-5 if member % 2 else -1e-5)

    def fem_folder(self, way, member):
        words = "-".join(text.split("/")[-1].replace("=", "") for text in way.fem)
        return self.output / "-".join(word for word in (way.mesh, words, f"member{member}") if word)

    def stages(self, names, chain, place, folder):
        """Seconds by stage, from an earlier time where the input was the same."""
        key, known = chain.record(names[-1])["key"], read_json(folder / "seconds.json") or {}
        if known.get("key") == key:
            return known["seconds"]
        folder.mkdir(parents=True, exist_ok=True)
        seconds = {name: processor_seconds(chain.command(name, place) + ["--quiet"], folder / f"{name}.log") for name in names}
        write_json(folder / "seconds.json", {"key": key, "seconds": seconds})
        return seconds

    def chain(self, way, member, size):
        settings = {"fem": [f"/shake/peak_acceleration={self.peak * self.scale(member):.12g}", *way.fem], "mpm": list(way.mpm)}
        return Chain(self.case, self.bin, size, threads="1", settings=settings)

    def shake(self, way, member):
        root = self.fem_folder(way, member)
        return self.stages(("mesh", "geostatic", "shake"), self.chain(way, member, way.mesh), Place(root, root), root)

    def runout(self, way, member):
        """{"seconds", "numbers"} of a member whose shake is there."""
        root = self.fem_folder(way, member)
        words = "-".join(text.split("/")[-1].replace("=", "") for text in way.mpm)
        phase = root / "-".join(word for word in (f"{way.cells}_cells", words) if word)
        seconds = self.stages(("transfer", "mpm"), self.chain(way, member, way.cells), Place(root, phase), phase)
        found, _ = headline.of_run(phase, root)
        return {"seconds": sum(seconds.values()) + sum(self.shake(way, member).values()), "numbers": {name: found[name] for name in NUMBERS}}


def mean_and_error(values):
    """Mean, standard deviation and standard error; of one value the latter two are unknown."""
    if len(values) < 2:
        return values[0], math.nan, math.nan
    deviation = statistics.stdev(values)
    return statistics.mean(values), deviation, deviation / math.sqrt(len(values))


def rows_of(results):
    """One a way: {"way", "seconds", "numbers": {name: (mean, deviation, error in %, its standard error in %)}}."""
    finest = {name: mean_and_error([member["numbers"][name] for member in results[FINEST]]) for name in NUMBERS}
    rows = []
    for way, members in results.items():
        numbers = {}
        for name in NUMBERS:
            mean, deviation, error = mean_and_error([member["numbers"][name] for member in members])
            best, _, best_error = finest[name]
            numbers[name] = (mean, deviation, 100.0 * abs(mean / best - 1.0), 100.0 * math.hypot(error, 0.0 if way == FINEST else best_error) / abs(best))
        rows.append({"way": way, "members": len(members), "seconds": statistics.mean(member["seconds"] for member in members), "numbers": numbers})
    return rows


def pareto(rows, name):
    """Ways that none beats in both run time and error, quickest first."""
    front, best = [], math.inf
    for row in sorted(rows, key=lambda row: row["seconds"]):
        error = row["numbers"][name][2]
        if error < best and row["way"] != FINEST:
            front.append(row)
            best = error
    return front


def picture(rows, path):
    plt = style.pyplot()
    figure, axes = plt.subplots(1, len(NUMBERS), figsize=(style.WIDTH, 4.6))
    families = list(dict.fromkeys(row["way"].family for row in rows))
    for axis, name in zip(axes, NUMBERS):
        for row in rows:
            if row["way"] == FINEST:
                continue
            _, _, error, own = row["numbers"][name]
            index = families.index(row["way"].family)
            axis.errorbar(row["seconds"], error, own if math.isfinite(own) else None, fmt="os^Dv<>pPX"[index % 10], color=f"C{index % 10}", capsize=3,
                          mfc="white" if row["way"].cells == "coarse" else None, label=row["way"].family if row["way"].cells == "coarse" else None)
            if row["way"] == DEFAULT:
                axis.plot(row["seconds"], error, "o", ms=16, mfc="none", mec=style.ACCENT)
        front = pareto(rows, name)
        axis.step([row["seconds"] for row in front], [row["numbers"][name][2] for row in front], where="post", color="0.6", lw=1, zorder=0)
        axis.set(xscale="log", xlabel="processor seconds, the whole chain", ylabel="difference from the finest, %", title=headline.BY_NAME[name].label)
        axis.set_ylim(bottom=0.0)
        axis.grid(alpha=0.3, which="both")
    figure.legend(*axes[0].get_legend_handles_labels(), fontsize=8, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncol=5)
    figure.suptitle("open: coarse cells; filled: default cells; ring: what the case takes; bars: standard errors of both means", fontsize=9)
    path.parent.mkdir(parents=True, exist_ok=True)
    style.save(figure, path)


def table(rows):
    lines = ["| mesh and cells | members | processor s | " + " | ".join(f"{headline.BY_NAME[name].label}, {headline.BY_NAME[name].display_unit} | off by, %" for name in NUMBERS) + " |",
             "|---" * (3 + 2 * len(NUMBERS)) + "|"]
    for row in sorted(rows, key=lambda row: row["seconds"]):
        cells = []
        for name in NUMBERS:
            mean, deviation, error, own = row["numbers"][name]
            show = headline.BY_NAME[name].display
            cells += [show(mean) + (f" +- {show(deviation)}" if math.isfinite(deviation) else ""),
                      "-" if row["way"] == FINEST else f"{error:.1f}" + (f" +- {own:.1f}" if math.isfinite(own) else "")]
        mark = "**" if row["way"] == DEFAULT else ""
        lines.append(f"| {mark}{row['way'].name}{mark} | {row['members']} | {row['seconds']:.0f} | " + " | ".join(cells) + " |")
    return lines


def document(rows, path):
    fronts = [f"* {headline.BY_NAME[name].label}: " + "; ".join(f"{row['way'].name} ({row['seconds']:.0f} s, {row['numbers'][name][2]:.1f} %)" for row in pareto(rows, name))
              for name in NUMBERS]
    lines = ["# Run time against error of the whole chain", "",
             "Written by `make -f Makefile.cases study-chain`; do not edit. Mochikoshi from mesh to rest, one thread, no pictures: means and standard deviations of members that differ in nothing",
             "physical (motions scaled by 1 and 1 +- 1e-5), and how far the means are from those of the finest way. Mesh and cells are named by the case's sizes: coarse, default and fine elements;",
             "cells of 2 m (coarse) and 1 m (default). Shake and runout share one line, since one is of no use without the other.", "",
             "![errors over run time](pictures/chain_work_precision.png)", "", *table(rows), "", "Not beaten in both time and error (chance of members aside):", "", *fronts, "",
             (Path(__file__).parent / "chain_notes.md").read_text().rstrip()]
    path.write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", type=Path)
    parser.add_argument("case", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--members", type=int, default=3)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--document", type=Path, help="tables and notes, and a picture in pictures/ beside it")
    arguments = parser.parse_args()
    study = Study(arguments.bin.resolve(), arguments.case.resolve(), arguments.output.resolve())
    runs = [(way, member) for member in range(arguments.members) for way in WAYS]
    shakes = list({study.fem_folder(way, member): (way, member) for way, member in runs}.values())
    with ThreadPoolExecutor(arguments.jobs) as pool:
        for kind, jobs, work in (("shakes", shakes, study.shake), ("runouts", runs, study.runout)):
            done = {}
            for job, result in zip(jobs, pool.map(lambda job, work=work: work(*job), jobs)):
                done[job] = result
                print(f"{kind}: {len(done)} of {len(jobs)}: {job[0].name}, member {job[1]}", flush=True)
    results = {way: [done[way, member] for member in range(arguments.members)] for way in WAYS}
    rows = rows_of(results)
    write_json(arguments.output / "work_precision.json", [{**row, "way": row["way"].name} for row in rows])
    print("\n".join(table(rows)))
    if arguments.document:
        picture(rows, arguments.document.parent / "pictures" / "chain_work_precision.png")
        document(rows, arguments.document)


if __name__ == "__main__":
    main()
