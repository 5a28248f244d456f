"""A way of steps: choices add up, each step's mean, spread and change are those of its members, a step without members breaks nothing; and the ways of
the main case end at the cases that they say.

Usage: steps_test.py SOURCE_FOLDER
"""

import csv
import json
import pathlib
import sys
import tempfile

from stand_in_chain import Clone

source = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(source / "cases" / "what_if"))
import paths  # noqa: E402, F401
import design  # noqa: E402
import settings  # noqa: E402

WAY = {"design": "steps", "reference": {"name": "elsewhere", "numbers": {"runout_m": 12}},
       "parameters": {"end": {"key": "mpm:/time/end", "values": [20.0, 21.0]}},
       "steps": [{"name": "as it is"}, {"name": "strong", "set": {"mpm:/residual_strength/factor": 2.0}},
                 {"name": "too strong", "set": {"mpm:/residual_strength/factor": 9.0}},
                 {"name": "weak, fast", "set": {"mpm:/residual_strength": {"factor": 0.5}, "mpm:/scheme/shape_function": "linear"}}]}


def contents(folder, changes=None):
    """Case files as the programs see them, without titles; files of the main case by their names there."""
    found = {}
    for stage in ("fem", "transfer", "mpm"):
        content = settings.case_with(folder / f"{stage}.json", (changes or {}).get(stage, []))
        content.pop("title", None)
        found[stage] = json.loads(json.dumps(content).replace("../mochikoshi/", ""))
    return found


main = source / "cases" / "mochikoshi"
for way, other, name in (("to_the_paper", "mochikoshi_paper", "foundation: elastic particles"),
                         ("to_softening", "mochikoshi_softening", "other tailings: 30 to 0 deg, 5 kPa")):
    steps = design.read_design(main / f"{way}.json", main).steps
    step = next(step for step in steps if step.name == name)
    assert contents(main, step.settings) == contents(source / "cases" / other), f"{way}.json does not lead to cases/{other}"
    before = steps[steps.index(step) - 1]
    assert contents(main, before.settings) != contents(source / "cases" / other)

with tempfile.TemporaryDirectory() as name:
    clone = Clone(f"{name}/clone", source, fails_above=3.0)

    def refused(change):
        return clone.refusal(WAY, change)

    for change, words in ((lambda c: c["steps"].append({"name": "weak, fast", "set": {"mpm:/a": 1}}), "is there twice"),
                          (lambda c: c["steps"].append({"name": "x", "set": {"mmp:/a": 1}}), "Did you mean 'mpm:'?"),
                          (lambda c: c["steps"].append({"name": "x", "set": {"import:/a": 1}}), "the case has no import.json"),
                          (lambda c: c["steps"].append({"name": "x"}), "an object with a key"),
                          (lambda c: c["steps"].append({"name": "x", "sets": {}, "set": {"mpm:/a": 1}}), "Did you mean 'set'?"),
                          (lambda c: c.update(steps=[{"name": "x"}]), "two steps at least"),
                          (lambda c: c["reference"]["numbers"].update(runot_m=1), "Did you mean 'runout_m'?"),
                          (lambda c: c["parameters"].update(step={"key": "mpm:/time/end", "values": [1]}), "is the name of the steps themselves"),
                          (lambda c: c["steps"][1]["set"].update({"mpm:/time/end": 3}), "is varied, and set by the step 'strong'"),
                          (lambda c: c.update(members=3), "take the key out")):
        assert words in refused(change), (words, refused(change))

    clone.sweep_file(WAY)
    result, ran = clone.make("sweep-files", "-j2", status=2)
    assert sum("mpm_stage" in line for line in ran) == 8, ran
    assert any("/residual_strength={\"factor\": 0.5}" in line and "/scheme/shape_function=\"linear\"" in line and "factor=2.0" not in line for line in ran), ran
    folder = clone.out / "sweeps" / "sweep"
    rows = {row["step"]: row for row in csv.DictReader((folder / "steps.csv").open()) if row["number"] == "runout_m"}
    assert [(row["members"], row["mean"], row["change"]) for row in rows.values()] == [
        ("2", "10", ""), ("2", "5", "-5"), ("0", "", ""), ("2", "10", "5")], rows  # the stand-in knows the key, not the whole object
    assert (folder / "waterfall.png").stat().st_size > 5000 and not (folder / "exceedance.png").exists()
    assert "weak, fast" in result.stdout and "5.0 +- 0.0" in result.stdout and "6 of 8 members done, 2 failed" in result.stdout, result.stdout
print("steps add up")
