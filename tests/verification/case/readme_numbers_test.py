"""README's numbers of the main case are value +- spread as make ensemble measured them (tests/data/mochikoshi_spread.json), and whether a run is one of that
family is told by the spread and nothing else. make smoke holds CI's own run against it.

Usage: readme_numbers_test.py SOURCE_FOLDER
"""

import json
import pathlib
import re
import sys

import numpy as np

source = pathlib.Path(sys.argv[1])
sys.path[:0] = [str(source / "cases" / "what_if"), str(source / "cases" / "plot")]
import family  # noqa: E402
import spread as shown  # noqa: E402
from headline import BY_NAME  # noqa: E402

kept = json.loads((source / "tests" / "data" / "mochikoshi_spread.json").read_text())

# README's sample: a run whose values are within its family, beside that family's standard deviations.
text = (source / "README.md").read_text()
block = re.search(r"^out/mochikoshi-coarse:\n(.*?)^```", text, re.MULTILINE | re.DOTALL).group(1)
found = re.findall(r"^  (FEM|MPM)  (.*?)  +(-?[\d.]+) \+- ([\d.]+)", block, re.MULTILINE)
assert len(found) >= 6, block
for stage, what, value, deviation in found:
    name, factor, digits = next(entry for (own, words), entry in shown.ROWS.items() if own == stage and words.strip() == what.strip())
    entry = kept["coarse"]["numbers"][name]
    low, high = family.allowed(entry)
    assert low <= float(value) / factor <= high, f"README: {what} {value} is no member's: {low * factor:g} to {high * factor:g}"
    assert deviation == f"{entry['standard_deviation'] * factor:.{digits}f}", f"README: {what}: +- {deviation}, measured {entry['standard_deviation'] * factor:g}"
members = re.search(r"\+- over +(\d+) runs", block)
assert members and int(members.group(1)) == kept["coarse"]["numbers"]["runout_m"]["members"], block

# The case's table: mean +- standard deviation.
table = (source / "cases" / "mochikoshi" / "README.md").read_text()
rows = re.findall(r"^\| ([^|]*?) \((\S+)\) \| (-?[\d.]+) \+- ([\d.]+) \|", table, re.MULTILINE)
assert len(rows) >= 6, rows
for label, unit, mean, deviation in rows:
    headline = next(own for own in BY_NAME.values() if own.label == label and own.display_unit == unit)
    entry = kept["coarse"]["numbers"][headline.name]
    assert (mean, deviation) == (headline.display(entry["mean"]), headline.display(entry["standard_deviation"])), (label, mean, deviation, entry)

# The interval is that of one more member, whatever the number of members it was made of.
draws = np.random.default_rng(1)
for count in (3, 10):
    outside = 0
    for _ in range(4000):
        values = draws.normal(5.0, 2.0, count + 1)
        low, high = family.allowed({"mean": values[1:].mean(), "standard_deviation": values[1:].std(ddof=1), "members": count}, 0.1)
        outside += not low <= values[0] <= high
    assert 0.08 < outside / 4000 < 0.12, (count, outside)
entry = {"mean": 90.0, "standard_deviation": 2.0, "members": 10}
assert family.strangers({"runout_m": 95.0}, {"runout_m": entry}) == []
assert "runout: 110.0 m, not from 80.0 to 100.0 as the 10 runs" in family.strangers({"runout_m": 110.0}, {"runout_m": entry})[0]
assert "runout: - m" in family.strangers({}, {"runout_m": entry})[0]
print("README's numbers are its family's")
