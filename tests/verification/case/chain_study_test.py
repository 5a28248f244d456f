"""The study of the whole chain: means, errors and their chance are those of the members, and the front is of what nothing beats in both time and error.

Usage: chain_study_test.py SOURCE_FOLDER
"""

import math
import pathlib
import sys
import tempfile

source = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(source / "cases" / "study"))
import chain_work_precision as study  # noqa: E402


def members(seconds, *fronts):
    return [{"seconds": seconds, "numbers": {"flow_front_m": front, "flowed_mass_kg": 1e6 * front, "mean_pore_pressure_ratio": 0.5}} for front in fronts]


quick, slow = study.Way("coarse", "coarse"), study.Way("fine", "coarse")
results = {quick: members(10.0, 80.0, 100.0), slow: members(200.0, 85.0, 93.0), study.DEFAULT: members(50.0, 96.0, 100.0), study.FINEST: members(300.0, 99.0, 101.0)}
rows = {row["way"]: row for row in study.rows_of(results)}
mean, deviation, error, chance = rows[quick]["numbers"]["flow_front_m"]
assert mean == 90.0 and math.isclose(error, 10.0)
assert math.isclose(deviation, math.sqrt(200.0)) and math.isclose(chance, math.hypot(10.0, 1.0)), (deviation, chance)
assert rows[study.FINEST]["numbers"]["flow_front_m"][2] == 0.0 and math.isclose(rows[study.FINEST]["numbers"]["flow_front_m"][3], 1.0)
assert [row["way"] for row in study.pareto(list(rows.values()), "flow_front_m")] == [quick, study.DEFAULT]

# A member alone has no chance that is known, and says so.
alone = study.rows_of({way: own[:1] for way, own in results.items()})
assert all(math.isnan(row["numbers"]["flow_front_m"][3]) for row in alone)
assert "nan" not in "\n".join(study.table(alone))

# Members differ in nothing physical; ways with the same shake share it.
chains = study.Study(source / "build", source / "cases" / "mochikoshi", pathlib.Path("out"))
scales = [chains.scale(member) for member in range(5)]
assert len(set(scales)) == 5 and scales[0] == 1.0 and max(abs(scale - 1.0) for scale in scales) < 1e-4
folders = {chains.fem_folder(way, 0) for way in study.WAYS}
assert len(folders) == len({(way.mesh, way.fem) for way in study.WAYS}) < len(study.WAYS)
assert study.DEFAULT in study.WAYS and study.FINEST in study.WAYS

with tempfile.TemporaryDirectory() as name:
    path = pathlib.Path(name) / "study.md"
    study.document(list(rows.values()), path)
    study.picture(list(rows.values()), pathlib.Path(name) / "study.png")
    text = path.read_text()
    assert "**default mesh, default cells**" in text and "90.0 +- 14.1 | 10.0 +- 10.0" in text, text
    assert (pathlib.Path(name) / "study.png").stat().st_size > 5000
print("errors are those of the members")
