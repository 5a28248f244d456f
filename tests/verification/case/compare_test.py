"""make compare: what differs between runs, their headline numbers and differences, in print, CSV, HTML and a picture; unknown runs are
named with the nearest ones.

Usage: compare_test.py SOURCE_FOLDER
"""

import csv
import sys
import tempfile

from stand_in_chain import Clone

with tempfile.TemporaryDirectory() as name:
    clone = Clone(f"{name}/clone", sys.argv[1])
    (clone.root / "cases" / "plot" / "print_summary.py").write_text("")
    assert "two runs at least" in clone.make("compare", status=2)[0].stderr
    clone.make("mpm-files", status=0)
    clone.make("named", "UNTIL=mpm", "RUN=weak", "SET=mpm:/residual_strength/factor=0.5", status=0)
    clone.make("named", "UNTIL=mpm", "RUN=loud", "SET=fem:/shake/peak_acceleration=3 mpm:/residual_strength/factor=2", status=0)
    said = clone.make("compare", "RUNS=base weak loud", status=0)[0].stdout
    folder = clone.out / "compare" / "base+weak+loud"
    rows = {row[0]: row[1:] for row in csv.reader((folder / "numbers.csv").open())}
    assert rows["quantity"] == ["base", "weak", "loud"] and rows["runout_m"] == ["10", "20", "5"], rows
    assert rows["mpm:/residual_strength/factor"] == ["1", "0.5", "2"] and rows["fem:/shake/peak_acceleration"] == ["2.5", "2.5", "3"], rows
    assert not any("title" in key or "SHA" in key for key in rows), "what is the same is not listed"
    assert "+10.0" in said and "-5.0" in said and "peak_acceleration" in said, said
    assert (folder / "compare.png").stat().st_size > 10000 and "data:image/png" in (folder / "compare.html").read_text()
    fronts = list(csv.reader((folder / "fronts.csv").open()))
    assert ["weak", "9", "", "20", "20", "1000", ""] in fronts, fronts  # 1 s after the hand-over at 8 s
    result, _ = clone.make("compare", "RUNS=base waek", status=2)
    assert "'waek' is not there" in result.stderr and "Did you mean weak" in result.stderr and "base, loud, weak" in result.stderr, result.stderr
    (clone.out / "runs" / "weak" / "mpm" / ".run").unlink()
    assert "not complete" in clone.make("compare", "RUNS=base weak", status=2)[0].stderr
print("runs side by side")
