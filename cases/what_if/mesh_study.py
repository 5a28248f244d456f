"""What the sizes of a case (coarse, default, fine) make of its headline numbers, from the ensembles of each: is there a limit, and where?

f(h) = f0 + c h^p through the means at the three finest cell sizes h (Richardson's extrapolation; Roache 1994). Said only where the means
approach a limit in order: both differences of one sign and beyond the spread of their members, and 0.3 <= p <= 4.
"""

import math
from pathlib import Path

import paths  # noqa: F401
from scipy.optimize import brentq
from stage import read_json
from stages import Chain

ORDERS = (0.3, 4.0)


def extrapolated(points):
    """(limit, order, "") of three points (h, mean, standard error), coarsest first; (None, None, why not)."""
    (h1, f1, e1), (h2, f2, e2), (h3, f3, e3) = points
    first, second = f2 - f1, f3 - f2
    if abs(first) <= 2.0 * math.hypot(e1, e2) or abs(second) <= 2.0 * math.hypot(e2, e3):
        return None, None, "sizes differ by no more than their members do"
    if first * second < 0.0:
        return None, None, "no limit is approached in order: the differences have both signs"

    def mismatch(p):
        return first / second - (h2**p - h1**p) / (h3**p - h2**p)

    if mismatch(ORDERS[0]) * mismatch(ORDERS[1]) > 0.0:
        return None, None, f"no order between {ORDERS[0]:g} and {ORDERS[1]:g} fits the three sizes"
    p = brentq(mismatch, *ORDERS)
    return f3 - second * h3**p / (h3**p - h2**p), p, ""


def folder_of_size(fem, phase, size, other):
    """Folder of the same results at another size."""
    name = Path(fem).name
    stem = name if size == "default" else name.removesuffix(f"-{size}")
    return Path(fem).parent / (stem if other == "default" else f"{stem}-{other}") / Path(phase).relative_to(fem)


def known_sizes(chain, fem, phase):
    """{size: (cell size in m, uncertainty.json)} of the sizes with an ensemble of the input that they have now, coarsest first."""
    found = {}
    for size, options in (chain.content("mpm").get("sizes") or {}).items():
        content = read_json(folder_of_size(fem, phase, chain.size, size) / "uncertainty.json")
        other = Chain(chain.case_dir, chain.bin, size, chain.time, settings=chain.settings)
        if content is not None and "cell_size" in options and content.get("of") == other.record("mpm")["key"]:
            found[size] = (float(options["cell_size"]), content)
    return dict(sorted(found.items(), key=lambda item: -item[1][0]))


def by_size(numbers, sizes):
    """Adds to each number what the sizes say of it."""
    for name, number in numbers.items():
        having = {size: (cell, content["numbers"][name]) for size, (cell, content) in sizes.items() if name in content["numbers"]}
        if len(having) < 2:
            continue
        number["by_size"] = {size: {"cell_size_m": cell, "mean": own["mean"], "standard_deviation": own["standard_deviation"]}
                             for size, (cell, own) in having.items()}
        means = [own["mean"] for _, own in having.values()]
        number["finest_less_next"] = means[-1] - means[-2]
        if len(having) >= 3:
            points = [(cell, own["mean"], own["standard_deviation"] / math.sqrt(own["members"])) for cell, own in list(having.values())[-3:]]
            limit, order, why = extrapolated(points)
            number["extrapolated"], number["order"] = limit, order
            if why:
                number["not_extrapolated_because"] = why


def lines(numbers, headlines):
    """The print of it: a headline number's mean +- standard deviation at each size, and its limit."""
    found = []
    for headline in headlines:
        number = numbers.get(headline.name, {})
        if "by_size" in number:
            means = ", ".join(f"{size} {headline.display(own['mean'])} +- {headline.display(own['standard_deviation'])}"
                              for size, own in number["by_size"].items())
            limit = f"; extrapolated {headline.display(number['extrapolated'])} (order {number['order']:.1f})" if number.get("extrapolated") is not None else ""
            found.append(f"  {headline.label} ({headline.display_unit}): {means}{limit}")
    return found
