"""Which parameter moves a headline number: by regression for any design, and Sobol' indices for the design "saltelli" (OpenTURNS).

Regression: y = b0 + sum b_i x_i by least squares, lists of words by one constant for each word. `Effect.low` and `high` are the
changes of y from the mean as one parameter goes to its 10th and 90th percentile (for words: the lowest and the highest mean) and the
others stay, `low_at` and `high_at` say which word is where; `share` is b_i^2 var(x_i) / var(y), the first-order index if the model were linear and the parameters independent. A parameter that is only varied with some choices of another (`only_with`) is at its mean in
the members without it.
"""

from dataclasses import dataclass

import numpy as np


@dataclass
class Effect:
    name: str
    low: float
    high: float
    share: float
    low_at: object = None  # words: the values of the lowest and the highest mean
    high_at: object = None


@dataclass
class Index:
    name: str
    first: float
    first_interval: tuple  # 95 %
    total: float
    total_interval: tuple


def varied(table):
    """The parameters of more than one value; with one alone a sweep fixes what is the same for all its members."""
    return [p for p in table.parameters if len({repr(value) for value in table.values[p["name"]]}) > 1]


def columns_of(table, chosen):
    """[(name, numeric, (members, k) columns)]: a parameter's values, or for words one column for each word but the first."""
    found = []
    for p in varied(table):
        values = [value for value, use in zip(table.values[p["name"]], chosen) if use]
        if p["numeric"]:
            found.append((p["name"], True, np.array(values, float)[:, None]))  # null becomes NaN
        else:
            words = sorted({repr(value) for value in values})
            found.append((p["name"], False, np.array([[float(repr(value) == word) for word in words[1:]] for value in values]).reshape(len(values), -1)))
    return found


def at_mean(column):
    """NaN, where a parameter is not varied, replaced by the mean of the others."""
    known = np.isfinite(column)
    return np.where(known, column, column[known].mean() if known.any() else 0.0)


def regression(table, name):
    """([Effect], R2), or (None, reason) where the members are too few or all alike."""
    chosen = np.isfinite(table.numbers[name])
    y = table.numbers[name][chosen]
    columns = [(name, numeric, at_mean(part) if numeric else part) for name, numeric, part in columns_of(table, chosen)]
    given = {p["name"]: [value for value, use in zip(table.values[p["name"]], chosen) if use] for p in table.parameters}
    terms = 1 + sum(part.shape[1] for _, _, part in columns)
    if len(y) < terms + 3:
        return None, f"{len(y)} members are too few for a regression with {terms} terms"
    if np.ptp(y) <= 1e-12 * max(np.abs(y).max(), 1e-300):
        return None, "it is the same in all members"
    matrix = np.hstack([np.ones((len(y), 1)), *(part for _, _, part in columns)])
    scale = np.where(np.abs(matrix).max(axis=0) > 0.0, np.abs(matrix).max(axis=0), 1.0)
    b = np.linalg.lstsq(matrix / scale, y, rcond=None)[0] / scale
    explained = 1.0 - np.var(y - matrix @ b) / np.var(y)
    effects, at = [], 1
    for parameter, numeric, part in columns:
        own = b[at:at + part.shape[1]]
        at += part.shape[1]
        change = part @ own - (part @ own).mean() if part.shape[1] else np.zeros(len(y))
        share = float(np.var(change) / np.var(y))
        if numeric:
            known = np.array([value for value in given[parameter] if value is not None], float)
            low, high = (own[0] * (np.percentile(known, p) - known.mean()) for p in (10, 90)) if len(known) else (0.0, 0.0)
            effects.append(Effect(parameter, low, high, share))
        else:
            least, most = int(change.argmin()), int(change.argmax())
            effects.append(Effect(parameter, change[least], change[most], share, given[parameter][least], given[parameter][most]))
    return effects, float(explained)


def sobol(table, name, seed=1):
    """([Index], points used) of a "saltelli" design, or (None, reason)."""
    count = len(table.parameters)
    if table.plan["design"] != "saltelli":
        return None, "Sobol' indices need the design \"saltelli\""
    y = table.numbers[name].reshape(-1, count + 2)
    whole = np.isfinite(y).all(axis=1)
    if whole.sum() < 8:
        return None, f"{whole.sum()} complete points are too few for Sobol' indices"
    if np.ptp(y[whole]) <= 1e-12 * max(np.abs(y[whole]).max(), 1e-300):
        return None, "it is the same in all members"
    try:
        import openturns
    except ImportError:
        return None, "Sobol' indices need the package python3-openturns"
    # OpenTURNS takes all points of A, then of B, then of A with column i from B. It reads the inputs' number of columns alone.
    ordered = np.concatenate([y[whole, k] for k in range(count + 2)])
    inputs = openturns.Sample(len(ordered), count)
    openturns.RandomGenerator.SetSeed(seed)
    algorithm = openturns.SaltelliSensitivityAlgorithm(inputs, openturns.Sample(ordered[:, None].tolist()), int(whole.sum()))
    algorithm.setUseAsymptoticDistribution(False)  # intervals by bootstrap
    algorithm.setBootstrapSize(200)
    first, total = algorithm.getFirstOrderIndices(), algorithm.getTotalOrderIndices()
    bounds = [(box.getLowerBound(), box.getUpperBound()) for box in (algorithm.getFirstOrderIndicesInterval(), algorithm.getTotalOrderIndicesInterval())]
    return [Index(p["name"], first[k], (bounds[0][0][k], bounds[0][1][k]), total[k], (bounds[1][0][k], bounds[1][1][k]))
            for k, p in enumerate(table.parameters)], int(whole.sum())
