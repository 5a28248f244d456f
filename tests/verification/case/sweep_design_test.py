"""sweep.json: what it means is what it says, wrong entries are refused with the place and the nearest word, and designs grow.

Usage: sweep_design_test.py SOURCE_FOLDER
"""

import copy
import json
import pathlib
import sys
import tempfile

import numpy as np

source = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(source / "cases" / "what_if"))
import paths  # noqa: E402, F401
import design  # noqa: E402
import sweep  # noqa: E402
from sample import copula, sample  # noqa: E402
from scipy.stats import lognorm, spearmanr  # noqa: E402

case = source / "cases" / "template"
good = {"members": 64, "parameters": {
    "factor": {"key": "mpm:/residual_strength/factor", "distribution": "lognormal", "median": 1, "log_sd": 0.5, "low": 0.4, "high": 2},
    "friction": {"key": "mpm:/terrain/0/friction", "distribution": "triangular", "low": 0.2, "mode": 0.3, "high": 0.6},
    "angle": {"key": "mpm:/materials/tailings/friction_angle", "distribution": "normal", "mean": 33, "sd": 1},
    "bins": {"key": "transfer:/rules/0/residual_strength/strengths", "distribution": "uniform", "low": 0.8, "high": 1.2, "scales": True},
    "cap": {"key": "transfer:/rules/0/residual_strength/drained_cap", "values": [True, False]}}}

# Cores, memory and what make was asked for.
for found, wanted in ((sweep.share(1000, 11730, 16, 0), (16, 1)), (sweep.share(1000, 400000, 16, 0), (2, 8)), (sweep.share(3, 11730, 16, 0), (3, 5)),
                      (sweep.share(1000, 11730, 16, 4), (4, 4)), (sweep.share(9, 11730, 16, 0, 1000.0, 300.0), (3, 5)), (sweep.share(9, 0, 2, 1), (1, 2)),
                      (sweep.share(9, 0, 8, 0, own=2), (4, 2))):
    assert found == wanted, (found, wanted)
for flags, jobs in (("w -j2 --jobserver-auth=3,4", 2), ("kw -j", 0), ("w", 1), (" -- CASE=a -j9", 1), ("w -j16 -- BIN=b", 16)):
    assert sweep.jobs_asked(flags) == jobs, flags

with tempfile.TemporaryDirectory() as name:
    path = pathlib.Path(name) / "sweep.json"

    def read(content):
        path.write_text(json.dumps(content))
        return design.read_design(path, case)

    def changed(way, value):
        content = copy.deepcopy(good)
        at = content
        for key in way[:-1]:
            at = at[key]
        at[way[-1]] = value
        return content

    made = read(good)
    values = {name: [member[name] for member in made.members] for name in good["parameters"]}
    # One member in each of 64 strata of the cut distribution.
    law = lognorm(0.5)
    u = (law.cdf(values["factor"]) - law.cdf(0.4)) / (law.cdf(2) - law.cdf(0.4))
    assert sorted(np.floor(64 * u).astype(int)) == list(range(64)), "no Latin hypercube"
    assert 0.4 <= min(values["factor"]) and max(values["factor"]) <= 2 and abs(np.mean(values["angle"]) - 33) < 0.05
    assert values["cap"].count(True) == 32
    contents = {stage: design.read_case(case / f"{stage}.json") for stage in ("fem", "transfer", "mpm")}
    settings = design.settings_of(made, made.members[0], contents)
    strengths = json.loads(settings["transfer"][0].split("=")[1])
    assert np.allclose(np.array(strengths) / [1500, 2500, 3500], values["bins"][0], rtol=1e-10), strengths
    # The same again; more members leave those that there are.
    assert read(good).members == made.members
    assert read(changed(["members"], [64, 8])).members[:64] == made.members
    for kind in ("sobol", "saltelli"):
        few, many = sample(kind, [8], 3, 4), sample(kind, [16], 3, 4)
        assert np.array_equal(few, many[: len(few)]) and len(many) == 16 * (6 if kind == "saltelli" else 1)
    points = copula(sample("latin_hypercube", [4000], 1, 2), np.array([[1, -0.6], [-0.6, 1]]))
    assert abs(spearmanr(*points.T)[0] + 0.6) < 0.04

    P = "parameters"
    for way, value, words in (
            ([P, "factor", "log_sd"], -0.5, "log_sd: -0.5 found, a number above 0"), ([P, "friction", "low"], 0.7, "low = 0.7 is not below high = 0.6"),
            ([P, "friction", "mode"], 0.9, "from low = 0.2 to high = 0.6"), ([P, "angle", "std"], 1, "unknown key 'std'. Did you mean 'sd'?"),
            ([P, "factor", "distribution"], "lognrmal", "Did you mean 'lognormal'?"), ([P, "angle", "sd"], "1", "a finite number"),
            ([P, "factor", "key"], "mpm:/residual_strength/facto", "Did you mean 'factor'?"),
            ([P, "factor", "key"], "mpm:/residul_strength/factor", "Did you mean 'residual_strength'?"),
            ([P, "factor", "key"], "mmp:/residual_strength/factor", "Did you mean 'mpm:'?"),
            ([P, "factor", "key"], "import:/time", "has no import.json"), ([P, "angle", "key"], good[P]["factor"]["key"], "varied twice"),
            ([P, "cap", "scales"], True, "only a number"), ([P, "cap", "values"], [1, 1], "all different"), ([P, "cap", "values"], [], "a list of values"),
            ([P, "factor", "low"], 1e9, "not below"), (["members"], 0, "above 0"), (["desing"], "grid", "Did you mean 'design'?"),
            (["design"], "sobbol", "Did you mean 'sobol'?"), (["correlations"], [{"between": ["factor", "angel"], "rank": 0.5}], "Did you mean 'angle'?"),
            (["correlations"], [{"between": ["factor", "cap"], "rank": 0.5}], "only distributions"),
            (["correlations"], [{"between": [a, b], "rank": -0.9} for a, b in (("factor", "angle"), ("angle", "bins"), ("factor", "bins"))], "contradict"),
            ([P, "motion"], {"key": "fem:/shake/motion", "folder": "nowhere"}, "there is no folder"),
            ([P, "motion"], {"key": "fem:/shake/motion", "folder": ".", "pattern": "*.AT2"}, "no file of"),
            ([P, "cap"], {"key": "mpm:/damping/local", "values": [1.0], "scales": True}, "mpm:/damping/local is \"nothing\" in the case file"),
            ([P, "cap", "key"], "mpm:/terrain/7/friction", "there is no '7' at '/terrain'"), ([P, "cap", "axis"], 3, "a text is needed"),
            ([P, "cap", "only_with"], {"factor": [1]}, "there is no list 'factor' before this parameter"),
            ([P, "model"], {"key": "mpm:/a", "values": [1, 2], "only_with": {"cap": [None]}}, "'cap' has no choice null. There are true, false"),
            ([P, "model"], {"key": "mpm:/a", "values": [1, 2], "only_with": {"cap": True}}, "a list of choices of 'cap' is needed"),
            (["reference"], {"name": "real", "numbers": {"runot_m": 800}}, "Did you mean 'runout_m'?")):
        try:
            read(changed(way, value))
        except design.DesignError as error:
            assert words in str(error) and str(path) in str(error), (way, str(error))
        else:
            raise AssertionError(f"{way} = {value} was taken")
    # A key that the file lacks: the run without it has the program's default, which nobody here knows.
    lacking = read({"design": "grid", "parameters": {"damping": {"key": "mpm:/damping/local", "values": [0.0, 0.05]}}})
    assert lacking.parameters[0].base is None and design.settings_of(lacking, lacking.members[1], contents) == {"mpm": ["/damping/local=0.05"]}
    assert design.what_if.case_with(case / "mpm.json", ["/damping/local=0.05"])["damping"] == {"local": 0.05}
    # A percentile belongs to the models that have one: elsewhere it is not set, and a grid has no member twice.
    models = {"model": {"key": "mpm:/residual_strength/model", "values": [None, "weber", "ratio"], "labels": ["as given", "Weber", "of stress"]},
              "percentile": {"key": "mpm:/residual_strength/percentile", "values": [16, 50], "axis": "percentile (%)", "only_with": {"model": ["Weber"]}},
              "cap": {"key": "mpm:/residual_strength/drained_cap", "values": [True], "only_with": {"percentile": [16], "model": ["weber"]}}}
    grid = read({"design": "grid", "parameters": models})
    assert [tuple(member.values()) for member in grid.members] == [(None, None, None), ("weber", 16, True), ("weber", 50, None), ("ratio", None, None)]
    assert design.settings_of(grid, grid.members[0], contents) == {} and "/residual_strength/percentile=16" in design.settings_of(grid, grid.members[1], contents)["mpm"]
    models["percentile"] = {**models["percentile"], "distribution": "uniform", "low": 10, "high": 90}
    del models["percentile"]["values"], models["cap"]
    drawn = read({"design": "sobol", "members": 16, "parameters": models, "reference": {"name": "real", "numbers": {"runout_m": 800}}})
    assert all((member["percentile"] is None) == (member["model"] != "weber") for member in drawn.members) and drawn.reference["numbers"] == {"runout_m": 800}
    folder = read({"design": "grid", "parameters": {"motion": {"key": "fem:/shake/motion", "folder": ".", "pattern": "*.csv"}}})
    assert folder.members == [{"motion": "motion.csv"}], folder.members
print("sweep files mean what they say")
