"""A grid told as curves: means and spreads are those of the members, null leaves the case file as it is, another size's sweep joins the picture only when it is of the same
input, and what cannot be drawn is refused.

Usage: curves_test.py SOURCE_FOLDER
"""

import csv
import os
import pathlib
import statistics
import sys
import tempfile

from stand_in_chain import Clone

source = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(source / "cases" / "what_if"))
import paths  # noqa: E402, F401
import curve_figures  # noqa: E402
import headline  # noqa: E402
import members_table  # noqa: E402

GRID = {"design": "grid",
        "parameters": {"end": {"key": "mpm:/time/end", "values": [20.0, 21.0]},
                       "factor": {"key": "mpm:/residual_strength/factor", "values": [0.5, 2.0, 1.0]},
                       "shape": {"key": "mpm:/scheme/shape_function", "values": [None, "linear"], "labels": ["as it is", "linear functions"]}},
        "curves": {"over": "factor", "axis": "factor of the strengths", "chance": ["end"], "numbers": ["runout_m", "flowed_mass_kg"]}}

# The hand-over's own number: the shaking's series at that time, nothing beyond it.
with tempfile.TemporaryDirectory() as name:
    quality = pathlib.Path(name) / "quality.csv"
    quality.write_text("time_s,largest_displacement_m\n0,0\n10,1\n20,4\n")
    assert headline.at_handover(quality, 15.0)["largest_displacement_m"] == 2.5
    assert headline.at_handover(quality, 21.0) == headline.at_handover(quality, float("nan")) == headline.at_handover(f"{name}/none.csv", 15.0) == {}

with tempfile.TemporaryDirectory() as name:
    clone = Clone(f"{name}/clone", source, fails_above=1.5)

    def refused(change):
        return clone.refusal(GRID, change)

    for change, words in ((lambda c: c["curves"].update(over="factr"), "Did you mean 'factor'?"),
                          (lambda c: c["curves"].update(over="shape"), "no list of numbers"),
                          (lambda c: c["curves"].update(chance=["factor"]), "what curves are drawn over"),
                          (lambda c: c["curves"].update(chance="end"), "a list of names"),
                          (lambda c: c["curves"].update(numbers=["runot_m"]), "Did you mean 'runout_m'?"),
                          (lambda c: c["curves"].update(number=[]), "Did you mean 'numbers'?"),
                          (lambda c: c["parameters"]["shape"].update(labels=["one"]), "a text of its own for each"),
                          (lambda c: c.update(design="sobol", members=4), "this one is 'sobol'")):
        assert words in refused(change), (words, refused(change))

    clone.sweep_file(GRID)
    result, ran = clone.make("sweep-files", "-j2", status=2)
    runs = [line for line in ran if "mpm_stage" in line]
    assert len(runs) == 12 and sum("shape_function" in line for line in runs) == 6, ran
    folder = clone.out / "sweeps" / "sweep"
    rows = [row for row in csv.DictReader((folder / "curves.csv").open()) if row["number"] == "runout_m"]
    assert [(row["line"], row["factor"], row["members"], row["mean"]) for row in rows] == [
        (line, factor, "0" if factor == "2" else "2", {"0.5": "20", "1": "10", "2": ""}[factor])
        for line in ("as it is", "linear functions") for factor in ("0.5", "1", "2")], rows
    assert (folder / "curves.png").stat().st_size > 5000 and not (folder / "scatter.png").exists()
    assert "20.0 +- 0.0" in result.stdout and "8 of 12 members done, 4 failed" in result.stdout, result.stdout

    # The spread is that of the members; the plan's paths are those of the clone.
    os.chdir(clone.root)
    table = members_table.load(folder)
    table.numbers["runout_m"][table.done] = [float(value) ** 2 for value in range(8)]
    line = curve_figures.lines(table)[0]
    first = [table.numbers["runout_m"][k] for k in range(12) if table.values["factor"][k] == 0.5 and table.values["shape"][k] is None]
    assert len(first) == 2 and line.over == [0.5, 1.0, 2.0]
    assert line.mean("runout_m")[0] == statistics.mean(first) and line.spread("runout_m")[0] == statistics.stdev(first)

    # Another size of the same input is drawn beside it; of another input it is not.
    clone.make("sweep-files", "SIZE=coarse", status=2)
    assert list(curve_figures.sizes(members_table.load(folder), folder)) == ["coarse", "default"]
    text = (clone.case / "mpm.json").read_text()
    (clone.case / "mpm.json").write_text(text.replace("0.05", "0.06"))
    assert (clone.case / "mpm.json").read_text() != text
    clone.make("sweep-files", "-j2", status=2)
    assert list(curve_figures.sizes(members_table.load(folder), folder)) == ["default"]

    # A single line has no name, and its picture no legend.
    clone.sweep_file({**GRID, "parameters": {name: GRID["parameters"][name] for name in ("end", "factor")}})
    (folder / "curves.png").unlink()
    result, ran = clone.make("sweep-files", "-j2", status=2)
    assert not [line for line in ran if "mpm_stage" in line] and (folder / "curves.png").stat().st_size > 5000, result.stdout
print("curves are those of the members")
