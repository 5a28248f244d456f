"""Readers of the chain's files for pictures: snapshots, particles and frames (HDF5), series (CSV), summaries (JSON)."""

import json
import re
import sys
from pathlib import Path

import h5py
import numpy as np


def fail(message):
    """Bad input, as everywhere in tailrun: a message and exit status 1."""
    print(message, file=sys.stderr)
    sys.exit(1)


def open_file(path, wanted):
    path = Path(path)
    if not path.exists():
        fail(f"{path}: no such file")
    try:
        file = h5py.File(path, "r")
    except OSError as error:
        fail(f"{path}: not a readable HDF5 file ({error})")
    found = file["tailrun"].attrs.get("format", "") if "tailrun" in file else ""
    found = found.decode() if isinstance(found, bytes) else str(found)
    if found.rstrip("\0") != wanted:
        fail(f"{path}: /tailrun says format '{found}', a {wanted} file is needed")
    return file


def texts(dataset):
    return [value.decode().rstrip("\0") for value in dataset[()]]


class Snapshot:
    """State of the finite elements at one time; fields as in docs/formats.md, loaded when first asked for."""

    def __init__(self, path):
        self.path = Path(path)
        self.file = open_file(path, "tailrun-snapshot")
        self.time = float(self.file["tailrun"].attrs["time_s"])
        self.imported = bytes(self.file["tailrun/provenance"].attrs.get("program", b"")) == b"transfer_tool"
        self.position = self.file["VTKHDF/Points"][:, :2]
        self.quads = self.file["VTKHDF/Connectivity"][()].reshape(-1, 4)
        self.region_names = texts(self.file["tailrun/region_names"])
        self.region_id = self.file["VTKHDF/CellData/region_id"][()]
        self.base_velocity = self.file["tailrun/base_velocity"][()].ravel()[:2]
        line = self.file["tailrun/phreatic_line"][()]
        self.phreatic_line = line.reshape(-1, 2)

    def nodal(self, name):
        values = self.file["VTKHDF/PointData/" + name][()]
        return values[:, :2] if values.ndim == 2 and values.shape[1] == 3 else values

    def cell(self, name):
        return self.file["VTKHDF/CellData/" + name][()]

    def in_regions(self, wanted):
        """Mask of the elements whose region's name satisfies `wanted`."""
        return np.array([wanted(name) for name in self.region_names])[self.region_id]

    def base_displacement(self):
        """Mean displacement of the base, so that pictures show deformation and not the ground's motion."""
        base = self.file.get("tailrun/lines/base")
        if base is None:
            return np.zeros(2)
        return self.nodal("displacement")[np.unique(base[()])].mean(axis=0)

    def deformed(self):
        return self.position + self.nodal("displacement") - self.base_displacement()


class Particles:
    """Particles of the hand-over or of one frame."""

    def __init__(self, path):
        self.path = Path(path)
        with open_file(path, "tailrun-particles") as file:
            self.time = float(file["tailrun"].attrs["time_s"])
            self.size = float(file["tailrun"].attrs["particle_size_m"])
            self.position = file["VTKHDF/Points"][:, :2]
            self.data = {name: file["VTKHDF/PointData/" + name][()] for name in file["VTKHDF/PointData"]}
            self.material_names = texts(file["tailrun/material_names"])
            self.terrain = {name: file["tailrun/terrain/" + name][()] for name in file["tailrun/terrain"]}

    def material(self):
        return self.data["material_id"]


def latest_time(path):
    """Time in a snapshot's name, snapshot_t16.000.h5 -> 16.0."""
    return float(re.search(r"_t([0-9.]+)\.h5$", Path(path).name).group(1))


def snapshots(folder):
    """Snapshot files of a stage's folder by time."""
    return sorted(Path(folder).glob("snapshot_t*.h5"), key=latest_time)


def snapshot_at(folder, time=None):
    """The snapshot nearest to `time` (the last one without)."""
    found = snapshots(folder) or ([Path(folder) / "snapshot.h5"] if (Path(folder) / "snapshot.h5").exists() else [])
    if not found:
        fail(f"{folder}: no snapshot there")
    if time is None or len(found) == 1:
        return Snapshot(found[-1])
    return Snapshot(min(found, key=lambda path: abs(latest_time(path) - time)))


def frames(folder):
    """Paths of the runout's frames, in order."""
    folder = Path(folder)
    index = next(iter(sorted(folder.glob("frames/*.series")) + sorted(folder.glob("*.series"))), None)
    if index is None:
        fail(f"{folder}: no frames there (output/frame_interval of mpm.json)")
    listed = json.loads(index.read_text())["files"]
    return [index.parent / entry["name"] for entry in sorted(listed, key=lambda entry: entry["time"])]


def series(path):
    """Columns of a CSV with one header line, or None when the file is missing."""
    path = Path(path)
    if not path.exists():
        return None
    with path.open() as file:
        names = file.readline().strip().split(",")
        rows = [line.strip().split(",") for line in file if line.strip()]
    table = np.array([[float(word) if word else np.nan for word in row] for row in rows]).reshape(-1, len(names))
    return {name: table[:, column] for column, name in enumerate(names)}


def summary(path):
    path = Path(path)
    return json.loads(path.read_text()) if path.exists() else {}


def plot_options(case_folder):
    """plot.json of a case: {"dam_view": [x0, x1, y0, y1], "runout_view": [...], "displacement_scale": m}, all optional."""
    path = Path(case_folder) / "plot.json" if case_folder else None
    options = json.loads(path.read_text()) if path and path.exists() else {}
    unknown = set(options) - {"dam_view", "runout_view", "displacement_scale"}
    if unknown:
        fail(f"{path}: unknown key {sorted(unknown)}; known are dam_view, runout_view, displacement_scale")
    return options
