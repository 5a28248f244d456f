"""The template case at its coarse size, stage by stage, for the tests of what happens to files; and what a sound results'
folder is.

A test takes four arguments: FEM_STAGE TRANSFER_TOOL MPM_STAGE CASES.
"""
import csv
import json
import pathlib
import subprocess
import sys
import time

import h5py

fem, transfer, mpm = sys.argv[1:4]
template = pathlib.Path(sys.argv[4]) / "template"
CASE = ["--size", "coarse", "-q", "--threads", "1"]
RUNOUT = ["--set", "/time/end=3", "--set", '/time/rest={"stop": false}', "--set", "/output/frame_interval=0.1"]


def command(stage, folder, *more):
    """The stage's command line; all files of a chain lie in one folder."""
    folder = pathlib.Path(folder)
    if stage in ("mesh", "geostatic", "shake"):
        line = [fem, stage, template / "fem.json", "-o", folder / "fem", *CASE]
        line += ["--set", "/shake/duration=2", "--set", "/output/snapshots=[0.5, 1, 1.5, 2]"]
    elif stage == "transfer":
        line = [transfer, "run", template / "transfer.json", *CASE, "--snapshot", folder / "fem/snapshot_t02.000.h5",
                "-o", folder / "particles.h5"]
        line += ["--set", "/transfer_time=2", "--set", '/rules/0/when={"region": "tailings"}']
    else:
        line = [mpm, "run", template / "mpm.json", *CASE, "--particles", folder / "particles.h5", "-o", folder / "mpm",
                *RUNOUT]
    return [str(part) for part in (*line, *more)]


STAGES = ("mesh", "geostatic", "shake", "transfer", "mpm")


def run(stage, folder, *more, **options):
    return subprocess.run(command(stage, folder, *more), capture_output=True, text=True, errors="replace", timeout=300,
                          **options)


def start(stage, folder, *more):
    return subprocess.Popen(command(stage, folder, *more), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                            errors="replace")


def results(folder):
    """Contents of every file under its final name, by name: datasets, rows, JSON. Raises where one is not whole. What
    counts wall-clock time or names files is left out."""
    found = {}
    for path in sorted(pathlib.Path(folder).rglob("*")):
        name = str(path.relative_to(folder))
        if not path.is_file() or path.suffix == ".part" or path.name == ".tailrun_lock":
            continue
        if path.suffix in (".h5", ".vtkhdf"):
            data = {}
            with h5py.File(path) as f:
                f.visititems(lambda n, o: data.update({n: o[()].tobytes()}) if isinstance(o, h5py.Dataset) else None)
            found[name] = {n: d for n, d in data.items() if "provenance" not in n and "notes" not in n}
        elif path.suffix == ".csv":
            rows = list(csv.reader(path.open()))
            assert rows and all(len(row) == len(rows[0]) for row in rows), f"{name}: rows of different lengths"
            clock = [k for k, n in enumerate(rows[0]) if "wall" in n]
            found[name] = [[x for k, x in enumerate(row) if k not in clock] for row in rows]
        elif path.suffix == ".json" or path.suffix == ".series":
            found[name] = json.loads(path.read_text()) if path.suffix == ".series" else bool(json.loads(path.read_text()))
        else:
            found[name] = path.read_bytes()
    return found


def undisturbed(folder):
    """A whole chain in `folder`: how long each stage took (s), and the results."""
    lasted = {}
    for stage in STAGES:
        since = time.perf_counter()
        done = run(stage, folder)
        assert done.returncode == 0, f"{stage}: exit status {done.returncode}\n{done.stderr}"
        lasted[stage] = time.perf_counter() - since
    return lasted, results(folder)
