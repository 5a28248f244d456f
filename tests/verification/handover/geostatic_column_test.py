"""What is at rest in the finite elements stays at rest in the particles: a geostatic column (level ground, saturated),
imported, handed over, and run in the particle stage for a second. Speeds stay under 1e-3 m/s and every stress within
1 % of the largest (an elastic wave would need some 0.1 s from top to bottom and back).

Usage: geostatic_column_test.py TRANSFER_TOOL MPM_STAGE FOLDER
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

tool, stage, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])


def report(path):
    return json.loads(subprocess.run([tool, "info", "--json", path], check=True, capture_output=True).stdout)


def field(file_report, name):
    return next(f for f in file_report["fields"] if f["name"].endswith("/" + name))


with tempfile.TemporaryDirectory() as name:
    where = pathlib.Path(name)
    snapshot, particles, out = where / "snapshot.h5", where / "particles.h5", where / "mpm"
    subprocess.run([tool, "import", "-q", folder / "import.json", "-o", snapshot], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([tool, "run", "-q", folder / "transfer.json", "--snapshot", snapshot, "-o", particles], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([stage, "run", "-q", folder / "mpm.json", "--particles", particles, "-o", out], check=True, stdout=subprocess.DEVNULL)
    frames = [report(path) for path in sorted((out / "frames").glob("*.vtkhdf")) + sorted((out / "frames").glob("*.h5"))]

    assert len(frames) >= 4, f"only {len(frames)} frames"
    first = frames[0]
    largest = max(abs(value) for value in field(first, "effective_stress")["min"])
    assert largest > 8e4, f"the column carries no stress: {largest}"
    assert abs(frames[-1]["time_s"] - first["time_s"] - 1.0) < 1e-6, frames[-1]["time_s"]
    speed = max(abs(v) for frame in frames for k in ("min", "max") for v in field(frame, "velocity")[k])
    change = max(abs(a - b) / largest for frame in frames for k in ("min", "mean", "max")
                 for a, b in zip(field(frame, "effective_stress")[k], field(first, "effective_stress")[k]))
print(f"largest speed {speed:.2e} m/s (allowed 1e-3), change of the stress {change:.2e} of the largest (allowed 1e-2)")
if results := os.environ.get("TAILRUN_VERIFICATION_DIR"):
    rows = [{"name": "handover_geostatic_column", "row": "equilibrium", "against": "rest", "quantity": quantity,
             "error": error, "ceiling": ceiling}
            for quantity, error, ceiling in (("largest speed in a second, m/s", speed, 1e-3),
                                             ("largest change of a stress over the largest stress", change, 1e-2))]
    (pathlib.Path(results) / "handover_geostatic_column.json").write_text(json.dumps(rows, indent=1) + "\n")
assert speed <= 1e-3 and change <= 1e-2
