"""What a sweep varies: cases/<case>/sweep.json, read and checked, and the members that come of it.

{
  "design": "latin_hypercube",     or "sobol", "saltelli" (for Sobol' indices), "grid" (every combination of lists), "steps" (steps.py)
  "members": 24,                   a list [24, 24]: batches, so that a Latin hypercube can grow; "saltelli": size of its two base samples
  "seed": 1,
  "parameters": {
    "factor": { "key": "mpm:/residual_strength/factor", "distribution": "lognormal", "median": 1, "log_sd": 0.3, "low": 0.4, "high": 2 },
    "friction": { "keys": ["mpm:/terrain/0/friction"], "values": [0.3, 0.35, 0.4] },
    "strengths": { "key": "transfer:/rules/0/residual_strength/strengths", "distribution": "uniform", "low": 0.8, "high": 1.2, "scales": true },
    "motion": { "key": "fem:/shake/motion", "folder": "motion", "pattern": "*.AT2" },
    "model": { "key": "mpm:/residual_strength/model", "values": [null, "weber", "kramer_wang"], "labels": ["bins", "Weber", "Kramer and Wang"] },
    "percentile": { "key": "mpm:/residual_strength/percentile", "distribution": "uniform", "low": 5, "high": 95, "axis": "percentile (%)",
                    "only_with": { "model": ["Weber", "Kramer and Wang"] } }      null, and so not set, with other choices
  },
  "correlations": [ { "between": ["factor", "strengths"], "rank": 0.5 } ]      Spearman's rank correlation
  "reference": { "name": "1978", "numbers": { "runout_m": 800 } },      what pictures draw a line for (steps.py)
  "curves": { "over": "time", "axis": "time of the hand-over (s)", "chance": ["motion_scale"], "numbers": ["runout_m"] }      a grid's picture (curves.py)
}
docs/what_if.md says more.
"""

import itertools
import json
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import paths  # noqa: F401
import settings as what_if
from case_part import read_case
from curves import read_curves
from distributions import Distribution, rounded
from json_keys import DesignError, Keys, near
from sample import copula, sample
from steps import PARAMETER, one_key, read_reference, read_steps

DESIGNS = ("latin_hypercube", "sobol", "saltelli", "grid", "steps")
MOST_MEMBERS = 1000000


@dataclass
class Parameter:
    name: str
    keys: list  # "mpm:/residual_strength/factor"; all take the same value
    base: object  # the case file's own value of the first key
    distribution: Distribution = None
    choices: list = None
    scales: bool = False  # the value multiplies what the case file says
    labels: list = None  # what tables and pictures call the choices
    axis: str = None  # what pictures call the parameter
    only_with: dict = None  # {earlier list's name: its choices with which this one is varied}; with others it is null

    @property
    def numeric(self):
        return self.distribution is not None or all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in self.choices)

    def values(self, u):
        if self.distribution is not None:
            return self.distribution.values(u)
        count = len(self.choices)
        return [self.choices[min(int(part * count), count - 1)] for part in u]

    def varied_in(self, member):
        return all(member[name] in choices for name, choices in (self.only_with or {}).items())

    def base_value(self):
        return 1.0 if self.scales else self.base


@dataclass
class Design:
    title: str
    kind: str
    batches: list
    seed: int
    parameters: list
    members: list  # {parameter: value}, in order
    steps: list = field(default_factory=list)  # steps.Step; the parameter "step" is the name of one
    reference: dict = None  # numbers that are known of elsewhere
    curves: dict = None  # over which parameter numbers are drawn (curves.py)


MISSPELT = 0.7  # of difflib: a key so much like one that is there is not a key of its own


def at_pointer(content, pointer):
    """The value there, None where an object lacks it; KeyError(nearest words) where it cannot be, or looks like another key that is there."""
    way = ""
    for key in (part.replace("~1", "/").replace("~0", "~") for part in pointer.split("/")[1:]):
        known = content.keys() if isinstance(content, dict) else [str(k) for k in range(len(content))] if isinstance(content, list) else []
        if key not in known:
            if isinstance(content, dict) and not near(key, known, MISSPELT):
                return None
            raise KeyError(f"there is no '{key}' at '{way or '/'}'.{near(key, known)} There are: {', '.join(known) or 'none'}")
        content = content[key] if isinstance(content, dict) else content[int(key)]
        way += f"/{key}"
    return content


def file_value(keys, name, word, contents):
    """What the case file says under `fem:/...`, None where it says nothing. A key that is spelt nearly like one that is there is refused; one that
    no program knows is refused by the program, with the nearest that it does know."""
    stage, pointer = one_key(keys, name, word, contents)
    try:
        return at_pointer(contents[stage], pointer)
    except KeyError as error:
        raise DesignError(f"{keys.at(name)}: {word}: in {stage}.json {error.args[0]}") from None


def files_of(keys, case_dir):
    """Names, from the case's folder, of the motions in a folder."""
    folder, pattern = keys.text("folder"), keys.text("pattern", "*")
    place = Path(case_dir) / folder
    if not place.is_dir():
        raise DesignError(f"{keys.at('folder')}: there is no folder {place}")
    found = sorted(path for path in place.glob(pattern) if path.is_file() and not path.name.startswith("."))
    if not found:
        there = ", ".join(sorted(path.name for path in place.iterdir())[:8])
        raise DesignError(f"{keys.at('pattern')}: no file of {place} is like '{pattern}'; there are {there or 'none'}")
    return [str(path.relative_to(case_dir)) for path in found]


def scalable(value):
    numbers = value if isinstance(value, list) else [value]
    return bool(numbers) and all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in numbers)


def read_only_with(keys, earlier):
    """{name: [choices]} of a parameter that has a meaning only with some choices of lists before it, None without."""
    if not keys.has("only_with"):
        return None
    own = Keys(keys.file, f"{keys.pointer}/only_with", keys.content["only_with"])
    lists = {parameter.name: parameter for parameter in earlier if parameter.choices is not None}
    found = {}
    for name in own.content:
        if name not in lists:
            raise DesignError(f"{own.at(name)}: there is no list '{name}' before this parameter.{near(name, lists)} There are {', '.join(lists) or 'none'}")
        asked, choices, labels = own.value(name), lists[name].choices, lists[name].labels or []
        if not isinstance(asked, list) or not asked:
            own.refuse(name, asked, f"a list of choices of '{name}'")
        for word in asked:
            if word not in choices and word not in labels:
                raise DesignError(f"{own.at(name)}: '{name}' has no choice {keys.word(word)}.{near(word, labels or choices)} "
                                  f"There are {', '.join(labels or map(keys.word, choices))}")
        found[name] = [choices[labels.index(word)] if word in labels else word for word in asked]
    return found


def read_parameter(keys, name, case_dir, contents, earlier=()):
    if keys.has("keys") == keys.has("key"):
        raise DesignError(f"{keys.file}: {keys.pointer}: one of 'key' and 'keys' is needed")
    where = "keys" if keys.has("keys") else "key"
    words = keys.content[where] if where == "keys" else [keys.content[where]]
    if not isinstance(words, list) or not words or not all(isinstance(word, str) for word in words):
        keys.refuse(where, keys.content[where], "a key like " + what_if.EXAMPLE.split("=")[0])
    base = [file_value(keys, where, word, contents) for word in words][0]
    parameter = Parameter(name, words, base)
    ways = [way for way in ("distribution", "values", "folder") if keys.has(way)]
    if len(ways) != 1:
        raise DesignError(f"{keys.file}: {keys.pointer}: one of 'distribution', 'values' and 'folder' says what it varies over; "
                          f"{' and '.join(ways) or 'none'} found, with {', '.join(keys.content)}")
    if ways == ["distribution"]:
        parameter.distribution = Distribution(keys)
    elif ways == ["values"]:
        parameter.choices = keys.content["values"]
        if not isinstance(parameter.choices, list) or not parameter.choices:
            keys.refuse("values", parameter.choices, "a list of values")
        if len({json.dumps(value, sort_keys=True) for value in parameter.choices}) != len(parameter.choices):
            keys.refuse("values", parameter.choices, "a list of values that are all different")
    else:
        parameter.choices = files_of(keys, case_dir)
    parameter.labels = keys.value("labels")
    if parameter.labels is not None and not (isinstance(parameter.labels, list) and all(isinstance(label, str) for label in parameter.labels)
                                             and len(set(parameter.labels)) == len(parameter.labels) == len(parameter.choices or [])):
        keys.refuse("labels", parameter.labels, "a list with a text of its own for each of the values")
    parameter.axis = keys.text("axis")
    parameter.only_with = read_only_with(keys, earlier)
    parameter.scales = keys.value("scales", False)
    if not isinstance(parameter.scales, bool):
        keys.refuse("scales", parameter.scales, "true or false")
    for word in words:
        if parameter.scales and not (scalable(file_value(keys, where, word, contents)) and parameter.numeric):
            raise DesignError(f"{keys.at('scales')}: {word} is {keys.word(file_value(keys, where, word, contents) or 'nothing')} in the case file: "
                              "only a number or a list of numbers that the file has can be scaled, by numbers")
    keys.finish()
    return parameter


def rank_correlations(keys, parameters):
    """(n, n) matrix of Spearman's rank correlation."""
    names = [parameter.name for parameter in parameters]
    matrix = np.eye(len(names))
    given = keys.value("correlations", [])
    if not isinstance(given, list):
        keys.refuse("correlations", given, "a list")
    for index, entry in enumerate(given):
        pair = Keys(keys.file, f"/correlations/{index}", entry)
        between = pair.value("between", required=True)
        if not isinstance(between, list) or len(between) != 2 or between[0] == between[1]:
            pair.refuse("between", between, "two names of parameters")
        for name in between:
            if name not in names:
                raise DesignError(f"{pair.at('between')}: there is no parameter '{name}'.{near(name, names)} There are {', '.join(names)}")
            if parameters[names.index(name)].distribution is None:
                raise DesignError(f"{pair.at('between')}: '{name}' is a list; only distributions can be correlated")
        rank = pair.number("rank", required=True)
        if not -1.0 < rank < 1.0:
            pair.refuse("rank", rank, "a number between -1 and 1")
        i, j = map(names.index, between)
        matrix[i, j] = matrix[j, i] = rank
        pair.finish()
    return matrix


def batches_of(keys, kind):
    if kind in ("grid", "steps"):
        if keys.has("members"):
            raise DesignError(f"{keys.at('members')}: a design of lists has as many members as its lists have combinations; take the key out")
        return []
    given = keys.value("members", required=True)
    batches = given if isinstance(given, list) else [given]
    if not batches or not all(isinstance(count, int) and not isinstance(count, bool) and count > 0 for count in batches):
        keys.refuse("members", given, "a whole number above 0, or a list of them,")
    if len(batches) > 1 and kind != "latin_hypercube":
        keys.refuse("members", given, f"one number (a {kind} design grows with it)")
    if sum(batches) > MOST_MEMBERS:
        keys.refuse("members", given, f"no more than {MOST_MEMBERS}")
    return batches


def conditional(values, parameters):
    """A member of these values: null where a parameter is only varied with other choices than the member's."""
    member = {}
    for parameter, value in zip(parameters, values):
        member[parameter.name] = value if parameter.varied_in(member) else None
    return member


def without_repeats(members):
    return list({json.dumps(member, sort_keys=True): member for member in members}.values())


def members_of(kind, batches, seed, parameters, correlations, keys):
    if kind in ("grid", "steps"):
        for parameter in parameters:
            if parameter.choices is None:
                raise DesignError(f"{keys.file}: /parameters/{parameter.name}: the design '{kind}' is made of lists ('values' or 'folder'), not of distributions")
        combinations = itertools.product(*(parameter.choices for parameter in parameters))
        return without_repeats([conditional(values, parameters) for values in combinations])
    if kind == "saltelli" and not np.array_equal(correlations, np.eye(len(parameters))):
        raise DesignError(f"{keys.at('correlations')}: Sobol' indices are for independent parameters; take the correlations out, or the design "
                          "'latin_hypercube'")
    try:
        u = copula(sample(kind, batches, seed, len(parameters)), correlations)
    except np.linalg.LinAlgError:
        raise DesignError(f"{keys.at('correlations')}: these correlations contradict each other (their matrix is not positive definite)") from None
    columns = [parameter.values(u[:, k]) for k, parameter in enumerate(parameters)]
    return [conditional([column[row] for column in columns], parameters) for row in range(len(u))]


def read_design(path, case_dir):
    """The Design of a sweep file. DesignError says what is wrong in it."""
    path = Path(path)
    contents = {stage: read_case(Path(case_dir) / f"{stage}.json") for stage in what_if.STAGES if (Path(case_dir) / f"{stage}.json").exists()}
    if "mpm" not in contents:
        raise DesignError(f"{case_dir}: the case has no mpm.json, so that nothing runs out")
    try:
        content = read_case(path)
    except FileNotFoundError:
        raise DesignError(f"{path}: there is no such file; docs/what_if.md says what it holds") from None
    except ValueError as error:
        raise DesignError(f"{path}: {error}") from None
    return design_of(content, path, case_dir, contents)


def design_of(content, path, case_dir, contents):
    keys = Keys(path, "", content)
    kind = keys.choice("design", DESIGNS, "latin_hypercube")
    title, seed = keys.text("title", ""), keys.count("seed", 1, 0)
    steps, reference = read_steps(keys, contents) if kind == "steps" else [], read_reference(keys)
    given = keys.value("parameters", {} if steps else None, required=not steps)
    if not isinstance(given, dict) or not (given or steps):
        keys.refuse("parameters", given, "an object with a parameter at least")
    parameters = [Parameter(PARAMETER, [], steps[0].name, choices=[step.name for step in steps])] if steps else []
    for name, entry in given.items():
        if steps and name == PARAMETER:
            raise DesignError(f"{path}: /parameters: '{name}' is the name of the steps themselves; choose another")
        if not name.replace("_", "").isalnum() or not name.isascii():
            raise DesignError(f"{path}: /parameters: '{name}' cannot be a parameter's name: letters, digits and _ are allowed")
        parameters.append(read_parameter(Keys(path, f"/parameters/{name}", entry), name, case_dir, contents, parameters))
    words = [word for parameter in parameters for word in parameter.keys]
    for word in words:
        if words.count(word) > 1:
            raise DesignError(f"{path}: /parameters: {word} is varied twice")
        for step in steps:
            if word in step.keys:
                raise DesignError(f"{path}: /parameters: {word} is varied, and set by the step '{step.name}'")
    batches = batches_of(keys, kind)
    correlations = rank_correlations(keys, parameters)
    curves = read_curves(keys, parameters, kind)
    keys.finish()
    members = members_of(kind, batches, seed, parameters, correlations, keys)
    return Design(title, kind, batches, seed, parameters, members, steps, reference, curves)


def scaled(value, factor):
    return [rounded(v * factor) for v in value] if isinstance(value, list) else rounded(value * factor)


def settings_of(design, member, contents):
    """Settings (settings.parse) of a member: {"mpm": ["/residual_strength/factor=0.5"], ...}."""
    own = next((step.settings for step in design.steps if step.name == member[PARAMETER]), {})
    found = {stage: list(texts) for stage, texts in own.items()}
    for parameter in design.parameters:
        for word in parameter.keys:
            stage, _, pointer = word.partition(":")
            value = member[parameter.name]
            if value is None:  # what the case file says, or does not say, stays
                continue
            if parameter.scales:
                value = scaled(at_pointer(contents[stage], pointer), value)
            found.setdefault(stage, []).append(f"{pointer}={json.dumps(value)}")
    return found
