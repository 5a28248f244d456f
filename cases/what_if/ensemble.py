"""How sure a number is: the same case over runs that differ in nothing physical, and their spread.

cases/<case>/ensemble.json, in the format of sweep.json, says which runs; without it the motion is scaled by 1 +- 1e-6 to 1e-4 (cases without
shaking: the Courant number). uncertainty.json beside the case's results has mean and standard deviation of every headline number; the lines
that a run ends with then say value +- standard deviation, as long as the run is computed from the input that the ensemble was made for.
"""

from pathlib import Path

import numpy as np

import paths  # noqa: F401
import members_table
import mesh_study
from case_part import read_case
from design import at_pointer, design_of
from headline import HEADLINES
from json_keys import DesignError
from settings import STAGES as CASE_FILES
from stage import write_json

FACTORS = [1.0 + sign * size for size in (1e-6, 3e-6, 1e-5, 3e-5, 1e-4) for sign in (-1.0, 1.0)]
SCALED = ("fem:/shake/peak_acceleration", "mpm:/time/courant")


def design_for(case_dir):
    """The Design of a case without an ensemble.json."""
    files = {stage: Path(case_dir) / f"{stage}.json" for stage in CASE_FILES}
    contents = {stage: read_case(path) for stage, path in files.items() if path.exists()}
    if "mpm" not in contents:
        raise DesignError(f"{case_dir}: the case has no mpm.json, so that nothing runs out")
    word = SCALED[0] if "fem" in contents else SCALED[1]
    stage, _, pointer = word.partition(":")
    if at_pointer(contents[stage], pointer) is None:
        raise DesignError(f"{files[stage]}: an ensemble scales {pointer}, which is not there: write it into the file with the value that the run has, "
                          f"or say in {Path(case_dir) / 'ensemble.json'} (as sweep.json) what is to be varied")
    name = "motion_scale" if stage == "fem" else "courant_scale"
    content = {"title": f"{Path(case_dir).name}: runs that differ in nothing physical", "design": "grid",
               "parameters": {name: {"key": word, "values": FACTORS, "scales": True}}}
    return design_of(content, Path(case_dir) / "ensemble.json", case_dir, contents)


def write_uncertainty(folder, fem, phase, chain):
    """Exit status; uncertainty.json from a gathered ensemble, with what ensembles of other sizes add (mesh_study.py)."""
    table = members_table.load(folder)
    numbers = {}
    for headline in HEADLINES:
        values = table.numbers[headline.name][np.isfinite(table.numbers[headline.name])]
        if len(values) > 1:
            numbers[headline.name] = {"unit": headline.unit, "mean": float(values.mean()), "standard_deviation": float(values.std(ddof=1)),
                                      "least": float(values.min()), "most": float(values.max()), "members": len(values)}
    if not numbers:
        print(f"{phase}: two members at least make a spread")
        return 2
    path = Path(phase) / "uncertainty.json"
    content = {"of": chain.record("mpm")["key"], "varied": [key for p in table.parameters for key in p["keys"]],
               "members": table.state.count("done"), "asked": len(table.state), "numbers": numbers}
    write_json(path, content)
    mesh_study.by_size(numbers, mesh_study.known_sizes(chain, fem, phase))
    write_json(path, content)
    print("\n".join([*mesh_study.lines(numbers, HEADLINES), f"  {path}"]))
    return 0
