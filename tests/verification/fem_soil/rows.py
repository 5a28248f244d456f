"""What every check of this folder shares: running fem_stage, reading its files, reporting errors against ceilings."""
import csv
import json
import math
import os
import pathlib
import subprocess
import time

import numpy as np

MODES = {"improved": "improved mode", "opensees": "compatible mode"}
DATA = pathlib.Path(__file__).resolve().parents[2] / "data" / "opensees"


def table(path):
    """CSV with a header as {column: array}; words become NaN."""
    with open(path) as f:
        rows = list(csv.DictReader(f))

    def number(text):
        try:
            return float(text)
        except ValueError:
            return math.nan

    return {k: np.array([number(r[k]) for r in rows]) for k in rows[0]}


def rms(difference):
    return float(np.sqrt(np.mean(np.square(difference))))


class Report:
    """Errors of one CTest. `finish` prints them, leaves them for the collector and returns the exit status."""

    def __init__(self, name, row):
        self.name, self.row, self.rows, self.pictures = name, row, [], []
        self.start = time.perf_counter()
        folder = os.environ.get("TAILRUN_VERIFICATION_DIR")
        self.folder = pathlib.Path(folder) if folder else None

    def add(self, quantity, error, ceiling, against, found=None, wanted=None, compare="at_most"):
        """compare: "at_most" or "at_least" (then `error` is a figure that must reach `ceiling`)."""
        entry = dict(name=self.name, row=self.row, quantity=quantity, against=against, error=float(error),
                     ceiling=float(ceiling), compare=compare)
        if found is not None:
            entry.update(found=float(found), wanted=float(wanted))
        entry["holds"] = bool(error >= ceiling if compare == "at_least" else error <= ceiling)
        self.rows.append(entry)

    def picture(self, file, caption, draw):
        """`draw` gets matplotlib.pyplot and returns a figure; only where results are collected."""
        if self.folder is None:
            return
        import matplotlib

        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
        from PIL import Image

        plt.rcParams.update({"font.size": 8, "axes.linewidth": 0.6, "legend.frameon": False,
                             "figure.constrained_layout.use": True})
        figure = draw(plt)
        figure.savefig(self.folder / file, dpi=90)
        plt.close(figure)
        Image.open(self.folder / file).convert("RGB").quantize(48).save(self.folder / file, optimize=True)
        self.pictures.append({"file": file, "caption": caption})

    def finish(self):
        seconds = time.perf_counter() - self.start
        for entry in self.rows:
            entry["seconds"] = seconds
            sign = "not under" if entry["compare"] == "at_least" else "ceiling"
            print(f"{'ok  ' if entry['holds'] else 'FAIL'} {self.row}: {entry['quantity']}"
                  + (f" {entry['found']:.5g} (wanted {entry['wanted']:.5g})" if "found" in entry else "")
                  + f" error {entry['error']:.3g}, {sign} {entry['ceiling']:g}")
        if self.folder is not None:
            self.folder.mkdir(parents=True, exist_ok=True)
            if self.pictures and self.rows:
                self.rows[0]["pictures"] = self.pictures
            (self.folder / f"{self.name}.json").write_text(json.dumps(self.rows, indent=1) + "\n")
        return 0 if self.rows and all(entry["holds"] for entry in self.rows) else 1


class Runner:
    def __init__(self, program, scene_folder, output):
        self.program, self.scenes, self.output = program, pathlib.Path(scene_folder), pathlib.Path(output)
        self.output.mkdir(parents=True, exist_ok=True)

    def scene(self, name):
        return json.loads((self.scenes / name).read_text())

    def element(self, name, change=None, mode=None):
        """Runs cases/verification/<row>/<name>, changed by `change(scene)`. Returns the history and the summary."""
        scene = self.scene(name)
        if mode is not None:
            scene["material"]["compatibility"] = mode
        if change is not None:
            change(scene)
        case, rows, summary = (self.output / f for f in ("test.json", "test.csv", "summary.json"))
        case.write_text(json.dumps(scene, indent=1))
        subprocess.run([self.program, "element", str(case), "-o", str(rows), "--summary", str(summary), "--quiet"],
                       check=True, stdout=subprocess.DEVNULL)
        return table(rows), json.loads(summary.read_text())

    def shake(self, name, label, change=None):
        """Runs the whole FEM stage of a scene; returns the results' folder and its wall-clock seconds."""
        scene = self.scene(name)
        scene["mesh"] = {k: str((self.scenes / v).resolve()) if k in ("file", "geometry") else v
                         for k, v in scene["mesh"].items()}
        scene["shake"]["motion"] = str((self.scenes / scene["shake"]["motion"]).resolve())
        if change is not None:
            change(scene)
        folder = self.output / label
        folder.mkdir(parents=True, exist_ok=True)
        for old in folder.glob("*.h5"):
            old.unlink()
        case = folder / "fem.json"
        case.write_text(json.dumps(scene, indent=1))
        start = time.perf_counter()
        subprocess.run([self.program, "run", str(case), "-o", str(folder), "--quiet"], check=True)
        return folder, time.perf_counter() - start
