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
import style  # noqa: E402

assert [style.nice_limit(x) for x in (0.9, 1.0, 1.3, 4.2, 7.0, 130.0)] == [1.0, 1.0, 2.0, 5.0, 10.0, 200.0]
colours = style.material_colours(["liquefied_1", "liquefied_2", "tailings", "embankment", "other"])
assert len(set(colours.values())) == 5, colours

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
