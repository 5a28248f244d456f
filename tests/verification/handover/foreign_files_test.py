"""Files made by others. The example of docs/formats.md that writes a particles file runs as it stands there, and what it
writes is read, judged plausible and computed with. Files of other shapes, types and links end with exit status 1 and a
message that names file and dataset, in every program that reads them. Equal runs make equal bytes.

Usage: foreign_files_test.py TRANSFER_TOOL MPM_STAGE FORMATS.md FOLDER (with import.json and transfer.json)
Exit status 77 where h5py is not installed.
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

try:
    import h5py
    import numpy as np
except ImportError:
    print("python3-h5py is not installed")
    sys.exit(77)

tool, stage, formats, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3]), pathlib.Path(sys.argv[4])

SCENE = """{"grid": {"cell_size": 1}, "time": {"end": 0.2, "rest": {"stop": false}},
 "materials": {"clay": {"model": "tresca", "youngs_modulus": 5e6, "poisson_ratio": 0.49, "cohesion": "from_particles"}},
 "terrain": [{"from_particles": "bed", "friction": 0.35}], "output": {"frame_interval": 0.1}}"""


def called(*arguments):
    return subprocess.run([str(a) for a in arguments], capture_output=True, text=True, errors="replace", timeout=120)


def replace(group, name, values):
    del group[name]
    group[name] = values


def soft_link(f):
    f["tailrun/again"] = h5py.SoftLink("/tailrun")


def hard_cycle(f):
    f["tailrun/again"] = f["tailrun"]


def external_link(f):
    f["tailrun/elsewhere"] = h5py.ExternalLink("other.h5", "/x")


def external_storage(f):
    shape = f["VTKHDF/PointData/velocity"].shape
    del f["VTKHDF/PointData/velocity"]
    f.create_dataset("VTKHDF/PointData/velocity", shape, "f8", external=[("/etc/passwd", 0, h5py.h5f.UNLIMITED)])


# What is done to a sound particles file, and what the message must name.
DAMAGE = {
    "scalar": (lambda f: replace(f, "VTKHDF/PointData/mass", 1.0), "PointData/mass"),
    "null": (lambda f: replace(f, "VTKHDF/PointData/mass", h5py.Empty("f8")), "PointData/mass"),
    "20 dimensions": (lambda f: replace(f, "VTKHDF/Points", np.ones((1,) * 20)), "VTKHDF/Points"),
    "floating ids": (lambda f: replace(f, "VTKHDF/PointData/material_id",
                                       np.full(f["VTKHDF/Points"].shape[0], 0.7)), "material_id"),
    "texts in 2-D": (lambda f: replace(f, "tailrun/material_names", np.array([[b"clay"]])), "material_names"),
    "scalar text": (lambda f: replace(f, "tailrun/material_names", np.bytes_("clay")), "material_names"),
    "array attribute": (lambda f: f["tailrun"].attrs.__setitem__("time_s", np.zeros(5000)), "time_s"),
    "array of texts": (lambda f: f["tailrun"].attrs.__setitem__("format", ["tailrun-particles"] * 3), "format"),
    "nan time": (lambda f: f["tailrun"].attrs.__setitem__("time_s", np.nan), "time_s"),
    "infinite transfer time": (lambda f: f["tailrun"].attrs.__setitem__("transfer_time_s", np.inf), "transfer_time_s"),
    "version 1.5": (lambda f: f["tailrun"].attrs.__setitem__("format_version", 1.5), "version"),
    "nan bed": (lambda f: replace(f, "tailrun/terrain/bed", np.full((2, 2), np.nan)), "terrain/bed"),
    "short bed": (lambda f: replace(f, "tailrun/terrain/bed", np.zeros((1, 2))), "terrain/bed"),
    "soft link": (soft_link, "soft link"),
    "hard cycle": (hard_cycle, "/tailrun"),
    "external link": (external_link, "external link"),
    "external storage": (external_storage, "PointData/velocity"),
    "complex": (lambda f: replace(f, "VTKHDF/PointData/mass", np.ones(f["VTKHDF/Points"].shape[0], "c16")), "mass"),
}


def refused(result, what, named):
    assert result.returncode == 1, f"{what}: exit status {result.returncode}\n{result.stderr[-2000:]}"
    assert named in result.stderr, f"{what}: the message does not name {named}: {result.stderr}"


with tempfile.TemporaryDirectory() as name:
    where = pathlib.Path(name)
    (where / "mpm.json").write_text(SCENE)

    blocks = re.findall(r"```python\n(.*?)```", formats.read_text(), re.S)
    example = next(b for b in blocks if "particles.h5" in b and '"w"' in b)
    subprocess.run([sys.executable, "-c", example], cwd=where, check=True)
    sound = where / "particles.h5"
    info = called(tool, "info", sound)
    assert info.returncode == 0, info.stderr
    run = called(stage, "run", "-q", where / "mpm.json", "--particles", sound, "-o", where / "out")
    assert run.returncode == 0, run.stderr
    assert "warning" not in run.stderr, run.stderr

    for what, (damage, named) in DAMAGE.items():
        damaged = where / "damaged.h5"
        shutil.copy(sound, damaged)
        with h5py.File(damaged, "r+") as f:
            damage(f)
        refused(called(stage, "run", "-q", where / "mpm.json", "--particles", damaged, "-o", where / "no"), what, named)
        shown = called(tool, "info", damaged)
        assert shown.returncode in (0, 1), f"info, {what}: exit status {shown.returncode}"

    made = []
    for k in range(2):
        snapshot, particles, out = where / f"s{k}.h5", where / f"p{k}.h5", where / f"mpm{k}"
        assert called(tool, "import", "-q", folder / "import.json", "-o", snapshot).returncode == 0
        assert called(tool, "run", "-q", folder / "transfer.json", "--snapshot", snapshot, "-o", particles).returncode == 0
        assert called(stage, "run", "-q", where / "mpm.json", "--particles", sound, "-o", out).returncode == 0
        # The name of the snapshot is in the particles' provenance.
        with h5py.File(particles, "r") as f:
            sums = f["tailrun/provenance/input_sha256"][:].tolist()
        made.append([snapshot.read_bytes(), sums, (out / "frames/runout_00001.vtkhdf").read_bytes()])
        time.sleep(1.1)
    assert made[0] == made[1], "equal runs made other bytes"
print(f"the page's example runs; {len(DAMAGE)} kinds of foreign files refused; equal runs make equal bytes")
