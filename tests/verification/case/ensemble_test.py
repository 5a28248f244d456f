"""make ensemble: mean and standard deviation over runs that differ in nothing physical, beside a run's numbers as long as they are of its
own input.

Usage: ensemble_test.py SOURCE_FOLDER
"""

import json
import pathlib
import sys
import tempfile

import numpy as np
from stand_in_chain import Clone

with tempfile.TemporaryDirectory() as name:
    clone = Clone(f"{name}/clone", sys.argv[1])
    clone.make("mpm-files", status=0)
    _, ran = clone.make("ensemble-files", "-j2", status=0)
    peaks = sorted(float(line.split("peak_acceleration=")[1]) for line in ran if "shake" in line)
    assert len(peaks) == 10 and np.allclose(peaks[0], 2.5 * (1 - 1e-4), rtol=1e-9) and sum(line.startswith("mpm_stage") for line in ran) == 10, ran
    spread = json.loads((clone.out / "uncertainty.json").read_text())
    number = spread["numbers"]["largest_displacement_fem_m"]
    assert np.isclose(number["standard_deviation"], np.std(peaks, ddof=1), rtol=1e-6) and number["members"] == 10, number
    clone.sweep_file({"design": "grid", "parameters": {"factor": {"key": "mpm:/residual_strength/factor", "values": [0.8, 1.25]}}}, "ensemble")
    clone.make("ensemble-files", status=0)
    spread = json.loads((clone.out / "uncertainty.json").read_text())["numbers"]["runout_m"]
    assert spread["mean"] == 10.25 and np.isclose(spread["standard_deviation"], 4.5 / np.sqrt(2)), spread

    # Sizes: f = 7 m + 4 h over factors that lie less apart than the sizes do.
    clone.sweep_file({"design": "grid", "parameters": {"factor": {"key": "mpm:/residual_strength/factor", "values": [0.999, 1.001]}}}, "ensemble")
    for size in ("coarse", "default", "fine"):
        said = clone.make("ensemble-files", f"SIZE={size}", status=0)[0].stdout
    assert "coarse 11.0 +- 0.0, default 10.0 +- 0.0, fine 8.5 +- 0.0; extrapolated 7.0 (order 1.0)" in said, said
    fine = json.loads((clone.root / "out" / "dam-fine" / "uncertainty.json").read_text())["numbers"]
    assert abs(fine["runout_m"]["extrapolated"] - 7) < 1e-3 and "no more than their members" in fine["flowed_mass_kg"]["not_extrapolated_because"]
    clone.sweep_file({"design": "grid", "parameters": {"factor": {"key": "mpm:/residual_strength/factor", "values": [0.8, 1.25]}}}, "ensemble")
    clone.make("ensemble-files", status=0)

    sys.path.insert(0, str(pathlib.Path(sys.argv[1]) / "cases" / "plot"))
    import results

    sys.path.insert(0, str(pathlib.Path(sys.argv[1]) / "cases" / "what_if"))
    from mesh_study import extrapolated

    assert np.allclose(extrapolated([(h, 7 + 4 * h**2, 0.01) for h in (1.0, 0.75, 0.375)])[:2], [7, 2])
    assert "both signs" in extrapolated([(4, 1.0, 0.0), (2, 2.0, 0.0), (1, 1.5, 0.0)])[2]
    assert "no order" in extrapolated([(4, 1.0, 0.0), (2, 2.0, 0.0), (1, 3.5, 0.0)])[2]
    rows = {what: value for _, what, value, _ in results.collect(clone.out, clone.out)}
    mass = np.std([2e5 / 0.8, 2e5 / 1.25], ddof=1) / 1e3
    assert rows["mass that flowed, per m of dam"] == f"200 +- {mass:.0f}" and "2 runs" in rows["+- over"], rows
    stamp = clone.out / ".inputs" / "mpm.json"
    stamp.write_text(json.dumps({**json.loads(stamp.read_text()), "key": "of another input"}))
    assert "+-" not in "".join(value for _, _, value, _ in results.collect(clone.out, clone.out))
print("a spread beside the number")
