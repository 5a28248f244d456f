"""A verification scene of mpm_stage as the checks see it: its case file, and what a run of it left behind."""
import csv
import json
import pathlib
import re
import shutil
import subprocess

import h5py
import numpy as np

G = 9.81


class Run:
    """One finished run: its summary, series and frames."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.summary = json.loads((self.folder / "summary.json").read_text())
        self.front = self.series("front.csv")
        self.ledger = self.series("ledger.csv")

    def series(self, name):
        with open(self.folder / name) as f:
            rows = list(csv.DictReader(f))
        return {k: np.array([float(r[k] or "nan") for r in rows]) for k in rows[0]}

    def frames(self):
        return sorted((self.folder / "frames").glob("*.vtkhdf"))

    def frame(self, k=-1):
        """Arrays of frame k in the order of the particles' identities, with positions x and the time."""
        with h5py.File(self.frames()[k]) as f:
            data = {name: f["VTKHDF/PointData"][name][()] for name in f["VTKHDF/PointData"]}
            data["x"] = f["VTKHDF/Points"][()]
            data["time"] = float(f["tailrun"].attrs["time_s"])
        return data


class Runner:
    def __init__(self, program, scenes, name, output):
        self.program, self.name = program, name
        self.case = pathlib.Path(scenes) / name / "mpm.json"
        self.output = pathlib.Path(output)

    def scene(self):
        return json.loads(re.sub(r"^\s*//.*$", "", self.case.read_text(), flags=re.M))

    def run(self, scene=None, label="", particles=None):
        """Runs the scene (changed or as it is) in its own empty folder; `particles` is a file that takes the place of
        its shapes."""
        folder = self.output / label if label else self.output
        folder.mkdir(parents=True, exist_ok=True)
        if (folder / "frames").exists():
            shutil.rmtree(folder / "frames")
        case = self.case
        if scene is not None:
            case = folder / "mpm.json"
            case.write_text(json.dumps(scene, indent=1))
        more = ["--particles", str(particles)] if particles else []
        subprocess.run([self.program, "run", str(case), "-o", str(folder), "--quiet", *more], check=True)
        return Run(folder)

    def particles(self, scene, change):
        """A particles file: the scene's start, after change(dictionary of its arrays) has had its way with them."""
        start = json.loads(json.dumps(scene))
        start["time"]["end"] = 1e-9
        start["output"]["frame_interval"] = 1.0
        path = self.output / "particles.h5"
        self.output.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(self.run(start, "start").frames()[0], path)
        with h5py.File(path, "r+") as f:
            point = f["VTKHDF/PointData"]
            names = ("velocity", "effective_stress", "pore_pressure")
            arrays = {"x": f["VTKHDF/Points"][()], **{name: point[name][()] for name in names}}
            change(arrays)
            f["VTKHDF/Points"][...] = arrays["x"]
            for name in names:
                point[name][...] = arrays[name]
        return path


def relative(found, wanted):
    return abs(found / wanted - 1.0)
