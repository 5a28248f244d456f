"""Is a run one of a family? Its headline numbers against the spread of the family's members (uncertainty.json of make ensemble): the interval that one more
member of a normal distribution lies in, from as many as were seen. It allows for the spread and nothing else.
"""

import math

import paths  # noqa: F401
from headline import BY_NAME
from scipy.stats import t as student

OUTSIDE = 1e-3  # probability that a member is called none, by one number


def allowed(number, outside=OUTSIDE):
    """(low, high) of one more member of the family with this mean, standard deviation and number of members."""
    count = number["members"]
    reach = student.ppf(1.0 - 0.5 * outside, count - 1) * number["standard_deviation"] * math.sqrt(1.0 + 1.0 / count)
    return number["mean"] - reach, number["mean"] + reach


def strangers(numbers, family):
    """Texts: what of `numbers` ({headline: value}) no member of `family` ({headline: entry of uncertainty.json}) would have."""
    found = []
    for name, entry in family.items():
        headline, value = BY_NAME[name], numbers.get(name)
        low, high = allowed(entry)
        if value is None or not low <= value <= high:
            found.append(f"{headline.label}: {headline.display(value)} {headline.display_unit}, not from {headline.display(low)} to {headline.display(high)} as "
                         f"the {entry['members']} runs of the spread would have it")
    return found
