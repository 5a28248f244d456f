"""A sweep with the real mpm_stage: a block that slides to rest over friction mu has run v0^2 / (2 g mu), its profile holds its volume, and the
frames it was measured from are gone.

Usage: sweep_real_test.py MPM_STAGE SOURCE_FOLDER
"""

import csv
import pathlib
import shutil
import sys
import tempfile

import h5py
import numpy as np
from stand_in_chain import Clone

with tempfile.TemporaryDirectory() as name:
    clone = Clone(f"{name}/clone", sys.argv[2])
    shutil.rmtree(clone.case)
    shutil.copytree(pathlib.Path(sys.argv[2]) / "cases" / "verification" / "mu_block", clone.case)
    frictions = [0.3, 0.5]
    clone.sweep_file({"design": "grid", "parameters": {"friction": {"key": "mpm:/terrain/0/friction", "values": frictions}}})
    clone.make("sweep-files", "-j2", f"BIN={pathlib.Path(sys.argv[1]).resolve().parent}", status=0)
    folder = clone.out / "sweeps" / "sweep"
    rows = list(csv.DictReader((folder / "members.csv").open()))
    for row, friction in zip(rows, frictions):
        slid = 5.0**2 / (2 * 9.81 * friction)
        assert abs(float(row["largest_displacement_mpm_m"]) / slid - 1) < 0.02, (row, slid)
        assert abs(float(row["released_volume_m3"]) / 4.0 - 1) < 0.01, row
    with h5py.File(folder / "members.h5") as file:
        x, depth, surface = (file[f"profiles/{key}"][()] for key in ("x", "depth", "surface"))
        assert np.allclose(depth.sum(axis=1) * np.diff(x[:2]), 4.0, rtol=0.01) and file["profiles/depth"].attrs["unit"] == b"m"
        assert np.allclose(surface.max(axis=1), 1.0, atol=0.03) and np.allclose(surface[:, x < -0.5], 0.0)
    assert {path.name for path in (clone.out / "store").glob("mpm-*/*")} == {"front.csv", "member.json", "profile.csv"}
    assert (folder / "profiles.png").exists()
print("blocks slide as far as friction lets them")
