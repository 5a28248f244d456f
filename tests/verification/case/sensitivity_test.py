"""Numbers of a sweep against what is known: Sobol' indices of Ishigami's function, a linear model's regression, Clopper and Pearson's
interval at its ends, and the volume under a profile.

Usage: sensitivity_test.py SOURCE_FOLDER [PICTURE]
"""

import pathlib
import sys
import tempfile
import types

import numpy as np

sys.path.insert(0, str(pathlib.Path(sys.argv[1]) / "cases" / "what_if"))
import paths  # noqa: E402, F401
import profile_of_flow as flow  # noqa: E402
import sensitivity  # noqa: E402
import style  # noqa: E402
import sweep_figures as figures  # noqa: E402
from headline import BY_NAME, of_strengths  # noqa: E402
from members_table import profiles_of  # noqa: E402
from sample import sample  # noqa: E402


def table(design, x, y, words=None):
    values = {f"x{k + 1}": list(column) for k, column in enumerate(x.T)}
    parameters = [{"name": name, "numeric": True, "base": 0.0, "scales": False, "keys": ["mpm:/a"]} for name in values]
    if words is not None:
        values["word"] = words
        parameters.append({"name": "word", "numeric": False, "base": "a", "scales": False, "keys": ["mpm:/b"]})
    state = ["done" if np.isfinite(number) else "failed" for number in y]
    return types.SimpleNamespace(plan={"design": design}, parameters=parameters, values=values, state=state, numbers={
        "runout_m": y, "released_volume_m3": y + 1.0}, done=np.isfinite(y), draws=np.full(len(y), True), profiles={})


# Ishigami and Homma (1990), a = 7, b = 0.1: first order 0.3139, 0.4424, 0; total 0.5576, 0.4424, 0.2437. One member has failed.
x = np.pi * (2.0 * sample("saltelli", [2048], 1, 3) - 1.0)
y = np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
y[12] = np.nan
ishigami = table("saltelli", x, y)
found, points = sensitivity.sobol(ishigami, "runout_m")
assert points == 2047
for index, first, total in zip(found, (0.3139, 0.4424, 0.0), (0.5576, 0.4424, 0.2437)):
    assert abs(index.first - first) < 0.02 and abs(index.total - total) < 0.02, index
    assert index.first_interval[0] < first < index.first_interval[1] and index.total_interval[0] < total < index.total_interval[1], index

# y = 3 x1 - 2 x2 + 4 where the word is "b".
x = sample("latin_hypercube", [200], 1, 2)
words = ["a" if k % 2 else "b" for k in range(200)]
linear = table("latin_hypercube", x, 3 * x[:, 0] - 2 * x[:, 1] + np.array([4.0 if word == "b" else 0.0 for word in words]), words)
effects, explained = sensitivity.regression(linear, "runout_m")
assert abs(explained - 1) < 1e-12 and np.allclose([effects[0].low, effects[0].high], [-1.2, 1.2], atol=0.02), effects
assert np.allclose([effects[2].low, effects[2].high], [-2, 2]) and abs(effects[1].share / effects[0].share - 4 / 9) < 0.02, effects
assert (effects[2].low_at, effects[2].high_at) == ("a", "b")
effects_of_words = effects[2]
# A parameter that only half of the members have is at its mean in the others, and its ends are those of the half.
half = table("latin_hypercube", x, 3 * x[:, 0] + np.where(x[:, 1] > 0.5, 2 * (x[:, 1] - 0.75), 0.0))
half.values["x2"] = [value if value > 0.5 else None for value in half.values["x2"]]
effects, explained = sensitivity.regression(half, "runout_m")
assert abs(explained - 1) < 1e-4 and np.allclose([effects[1].low, effects[1].high], [-0.4, 0.4], atol=0.02), effects
fixed = table("latin_hypercube", np.c_[x, np.full(200, 120.0)], x[:, 0])  # the third is the same in all members
assert [effect.name for effect in sensitivity.regression(fixed, "runout_m")[0]] == ["x1", "x2"]
assert "too few" in sensitivity.regression(table("sobol", x[:4], x[:4, 0]), "runout_m")[1]
assert "the same in all" in sensitivity.regression(table("sobol", x, np.ones(200)), "runout_m")[1]

summary = {"residual_strength": [{"particles": 3, "strength_Pa": {"mean": 2e3}}, {"particles": 1, "strength_Pa": {"mean": 6e3}}, {"particles": 0, "strength_Pa": None}]}
assert of_strengths(summary) == {"mean_strength_Pa": 3e3} and of_strengths({}) == of_strengths(None) == {}

low, high = figures.band([0, 10], 10, 0)
assert np.allclose([low[0], high[0], low[1], high[1]], [0, 1 - 0.025**0.1, 0.025**0.1, 1]), (low, high)
assert np.allclose(figures.band([3], 10, 4), [figures.band([3], 14, 0)[0], figures.band([7], 14, 0)[1]])

# A block of soil, 20 m by 4 m, of which the right half has slid by 7.3 m.
centre = np.stack(np.meshgrid(np.arange(0.5, 20), np.arange(0.5, 4)), -1).reshape(-1, 2)
slid = np.where(centre[:, :1] > 10, [[7.3, 0.0]], [[0.0, 0.0]])
bed = {"bed": np.array([[-50.0, 0.0], [100.0, 0.0]]), "wall": np.array([[-1.0, 0.0], [-1.2, 9.0]])}
first, last = (types.SimpleNamespace(position=centre + move, size=1.0, terrain=bed, time=8.0, data={
    "displacement": 5.0 + move, "volume": np.ones(len(centre)), "mass": np.full(len(centre), 1900.0)}) for move in (0.0 * slid, slid))
run = flow.of_particles(first, last)
assert np.isclose(run.released_volume, 40) and np.isclose(run.depth.sum() * run.width, 40) and run.width == 4.0
assert np.isclose(run.depth[run.x == 22.0], 4.0) and np.allclose(run.bed, 0.0) and np.nanmax(run.surface) == 4.0
assert np.isclose(run.depth[run.x == 18.0], 4 * 2.7 / 4), run.depth

# Two members on valley floors of their own: heights are over each one's bed, and there is no bed of both where they part.
with tempfile.TemporaryDirectory() as name:
    folders = []
    for member, fall in enumerate((0.0, 0.5)):
        folders.append(pathlib.Path(name) / str(member))
        folders[-1].mkdir()
        rows = [f"{x},,{2 - fall * x if x < 6 + 4 * member else ''},{-fall * x},{2 if x < 6 + 4 * member else 0}" for x in (1, 3, 5, 7, 9)]
        (folders[-1] / "profile.csv").write_text("\n".join(["x_m,initial_surface_m,surface_m,bed_m,flow_depth_m", *rows]) + "\n")
    found = profiles_of(folders)
    assert np.allclose(found["height"], [[2, 2, 2, 0, 0], [2, 2, 2, 2, 2]]) and not found["one_bed"]
    assert np.array_equal(np.isnan(found["bed"]), [False, True, True, True, True]) and np.allclose(found["surface"][0], [2, 2, 2, 0, 0])
    assert profiles_of(folders[:1])["one_bed"] and np.allclose(profiles_of(folders[:1])["surface"], [[2, 2, 2, 0, 0]])

with tempfile.TemporaryDirectory() as name:
    picture = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else f"{name}/sensitivity.png")
    figures.sensitivities(style.pyplot(), ishigami, picture)
    assert picture.stat().st_size > 10000
    figures.sensitivities(style.pyplot(), fixed, pathlib.Path(name) / "fixed.png")
    figures.scatter(style.pyplot(), fixed, pathlib.Path(name) / "scatter.png")
    linear.parameters[-1].update(choices=[None, "b", "a"], labels=["as it is", "much", "little"], axis="how much")
    assert figures.words_in_order(linear.parameters[-1], words) == ["much", "little"] and figures.base_choice(linear.parameters[-1]) is None
    assert figures.effect_words(linear, effects_of_words) == "how much:\nlittle \u2192 much" and figures.axis_words(linear.parameters[0]) == "x1"
    linear.plan["reference"] = {"name": "real", "numbers": {"runout_m": 9.0}}
    assert figures.known_elsewhere(linear, BY_NAME["runout_m"]) == ("real", 9.0)
    figures.exceedance(style.pyplot(), linear, pathlib.Path(name) / "exceedance.png")
    for drawn in (linear, half):
        figures.scatter(style.pyplot(), drawn, pathlib.Path(name) / "scatter.png")
print("indices, regression, bands and volumes are what they are known to be")
