"""The pictures' tools: colours, limits, case files with comments, and readers that refuse what is no file of the chain.

Usage: plots_test.py SOURCE_FOLDER
"""

import pathlib
import subprocess
import sys
import tempfile

import numpy as np

source = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(source / "cases" / "plot"))
sys.path.insert(0, str(source / "cases"))
import case_part  # noqa: E402
import chain_files  # noqa: E402
import results  # noqa: E402
import runout_marks  # noqa: E402
import runout_plot  # noqa: E402
import style  # noqa: E402
from palette import Palette  # noqa: E402

assert [style.nice_limit(x) for x in (0.9, 1.0, 1.3, 4.2, 7.0, 130.0)] == [1.0, 1.0, 2.0, 5.0, 10.0, 200.0]


class Soil:
    """Six particles: two of tailings, four of liquefied soil."""

    def __init__(self, strength):
        self.material_names = ["liquefied", "tailings"]
        self.position = np.zeros((6, 2))
        self.data = {"material_id": np.array([1, 1, 0, 0, 0, 0]), "residual_strength": np.array(strength)}

    def material(self):
        return self.data["material_id"]


# Few strengths have a colour each, and the legend says the strength that the frame carries.
soil = Soil([0.0, 0.0, 1600.0, 1600.0, 2660.0, 4550.0])
palette = Palette(soil)
colours = palette.colours(soil)
assert len(set(colours)) == 4 and colours[2] == colours[3] and colours[0] == style.region_colour("tailings"), colours
labels = [label for label, _ in palette.labels(soil)]
assert labels == ["liquefied, $s_R$ 1.6 kPa", "liquefied, $s_R$ 2.66 kPa", "liquefied, $s_R$ 4.55 kPa", "tailings"], labels
assert [colour for _, colour in palette.labels(soil)][:3] == [colours[2], colours[4], colours[5]]
# Many are put into classes of the same number, and nothing falls between them.
many = Soil([0.0, 0.0, 1.0, 1.0, 1.0, 1.0])
many.position, many.data = np.zeros((1000, 2)), {"material_id": np.zeros(1000, int), "residual_strength": np.linspace(1e3, 9e3, 1000)}
classes = Palette(many).classes(many)
assert np.bincount(classes).tolist() == [200] * 5 and (np.diff(classes) >= 0).all(), np.bincount(classes)
assert Palette(many).labels(many)[0][0] == "liquefied, $s_R$ 1 to 2.59 kPa", Palette(many).labels(many)

# The report's words for a law, and its rows of the runout.
law = {"model": "weber", "blow_count": 6.0, "percentile": 33.0, "factor": 0.9}
assert results.law_in_words({"from": "hand-over", "law": law, "factor": 1.0}) == "weber (N 6), percentile 33, factor 0.9 of the hand-over"
assert results.law_in_words({"from": "mpm.json", "law": {"model": "ratio"}, "factor": 0.5}) == "ratio, factor 0.5, chosen at the runout"
assert results.law_in_words({"from": "hand-over", "law": None, "factor": 1.0}) == "not known"
spread = {"smallest": 1600.0, "mean": 3000.0, "largest": 4550.0}
rows = results.strengths({"residual_strength": [{"material": "liquefied", "from": "hand-over", "law": None, "factor": 0.5, "strength_Pa": spread}]})
assert rows[0] == ("MPM", "strength, liquefied", "1.60 to 4.55, mean 3.00", "kPa"), rows
rows = results.runout({"initial_toe_m": 88.0, "runout_m": None, "runout_quantiles": [0.999, 0.9], "freeboard_lost_m": 2.5, "flow_distance_m": 1.0,
                       "ground_before_m": 24.25, "ground_after_m": 21.75})
assert [row[2] for row in rows] == ["88.0", "none, nothing moved by more than 1 m", "2.50 (24.2 to 21.8)"], rows
rows = results.runout({"initial_toe_m": 88.0, "runout_m": -26.0, "runout_quantiles": [0.999, 0.9], "freeboard_lost_m": 0.2, "flow_distance_m": 1.0})
assert ("MPM", "runout from that toe", "none, what flowed ends 26.0 m short of it", "") in rows, rows
assert results.runout({"runout_m": 1.0}) == []  # of an earlier version, which meant something else

# The ground before the motion leaves out what hangs above it, and goes back by the displacement.
many.position = np.array([[0.25 + 2.0, 0.25], [0.25 + 2.0, 0.75], [0.75 + 2.0, 1.25], [0.25 + 2.0, 9.0], [1.25 + 2.0, 0.25]])
many.size, many.data = 0.5, {"displacement": np.array([[2.0, 0.0, 0.0]] * 5)}
x, y = runout_marks.ground_line(many)
assert x.tolist() == [0.5, 1.5] and y.tolist() == [1.5, 0.5], (x, y)

# A drop kilometres ahead does not shrink the picture; a front without one is shown to its end.
row = np.linspace(0.0, 100.0, 201)
assert runout_plot.extent(row) == (0.0, 100.0) and runout_plot.extent(np.append(row, 5000.0))[1] < 160.0

# The front's mark stands where the runout ends, not where the foremost soil does.
mark = runout_marks.Marks.__new__(runout_marks.Marks)
mark.toe, mark.start, mark.sign = 88.0, 16.0, 1.0
mark.series = {"time_s": np.array([0.0, 1.0, 2.0]), "flow_front_m": np.array([np.nan, 90.0, 3000.0]), "runout_m": np.array([np.nan, 2.0, 12.0])}
assert mark.front_at(16.0) is None and mark.front_at(18.1) == 100.0

case = case_part.without_comments('{"a": "http://b", /* c */ "d": 1 // "e"\n, "f\\"//": [2]}')
assert case_part.json.loads(case) == {"a": "http://b", "d": 1, 'f"//': [2]}, case
for path in sorted((source / "cases").glob("*/*.json")):
    case_part.read_case(path)

with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    (folder / "series.csv").write_text("time_s,front_m\n0,1.5\n0.5,nan\n1,3\n")
    table = chain_files.series(folder / "series.csv")
    assert list(table) == ["time_s", "front_m"] and np.isnan(table["front_m"][1]) and table["front_m"][2] == 3.0
    assert chain_files.series(folder / "missing.csv") is None
    for index, content in enumerate((None, b"no HDF5 file at all")):
        path = folder / f"snapshot_t{index:06.3f}.h5"
        if content:
            path.write_bytes(content)
        code = f"import sys; sys.path.insert(0, {str(source / 'cases' / 'plot')!r}); import chain_files; chain_files.Snapshot({str(path)!r})"
        result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        assert result.returncode == 1 and path.name in result.stderr and "Traceback" not in result.stderr, result.stderr
    (folder / "plot.json").write_text('{"dam_veiw": [0, 1, 0, 1]}')
    code = f"import sys; sys.path.insert(0, {str(source / 'cases' / 'plot')!r}); import chain_files; chain_files.plot_options({name!r})"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert result.returncode == 1 and "dam_veiw" in result.stderr, result.stderr
