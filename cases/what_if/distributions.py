"""Distributions of a sweep's parameters (scipy.stats), given as sweep.json gives them; each may be cut off at `low` and `high`.

A cut distribution is the conditional one: F(x) = (F0(x) - F0(low)) / (F0(high) - F0(low)).
"""

import numpy as np
from scipy import stats

from json_keys import DesignError

NAMES = ("uniform", "normal", "lognormal", "triangular")
DIGITS = 12  # significant digits that values keep, so that their text, and with it the member's key, is the same on every machine


def rounded(value):
    return float(f"{value:.{DIGITS}g}")


def limits(keys, required=False):
    low, high = keys.number("low", required=required), keys.number("high", required=required)
    if low is not None and high is not None and not low < high:
        raise DesignError(f"{keys.at('low')}: low = {low:g} is not below high = {high:g}")
    return low, high


class Distribution:
    """Values of a continuous parameter."""

    def __init__(self, keys):
        name = keys.choice("distribution", NAMES)
        if name == "uniform":
            low, high = limits(keys, True)
            self.law = stats.uniform(low, high - low)
        elif name == "triangular":
            low, high = limits(keys, True)
            mode = keys.number("mode", required=True)
            if not low <= mode <= high:
                raise DesignError(f"{keys.at('mode')}: {mode:g} found, a number from low = {low:g} to high = {high:g} is needed")
            self.law = stats.triang((mode - low) / (high - low), low, high - low)
        elif name == "normal":
            low, high = limits(keys)
            self.law = stats.norm(keys.number("mean", required=True), keys.number("sd", required=True, above=0.0))
        else:
            low, high = limits(keys)
            # ln X is normal with mean ln(median) and standard deviation log_sd.
            self.law = stats.lognorm(keys.number("log_sd", required=True, above=0.0), scale=keys.number("median", required=True, above=0.0))
        self.name = name
        self.below = self.law.cdf(low) if low is not None else 0.0
        self.upto = self.law.cdf(high) if high is not None else 1.0
        self.low, self.high = low, high
        # Beyond some eight standard deviations nothing is left to draw from.
        if not self.upto - self.below > 1e-12:
            raise DesignError(f"{keys.at('low')}: between low and high lies no part of the {name} distribution")

    def values(self, u):
        """Values at probabilities u in (0, 1), an array."""
        found = self.law.ppf(self.below + np.asarray(u) * (self.upto - self.below))
        if self.low is not None or self.high is not None:
            found = np.clip(found, self.low, self.high)  # round-off at the ends
        return [rounded(value) for value in found]
