"""Points in the unit cube for the members of a sweep (scipy.stats.qmc), all from a seed."""

import warnings

import numpy as np
from scipy.stats import norm, qmc


def sample(kind, batches, seed, dimension):
    """(members, dimension) points in (0, 1).

    latin_hypercube  batches one after another, each a Latin hypercube of its own: a further batch leaves the earlier ones
    sobol            a scrambled Sobol' sequence (Owen): more members leave the earlier ones
    saltelli         A, B and, for each parameter i, A with its column i from B: n (dimension + 2) points, with A and B from one Sobol'
                     sequence in 2 dimension dimensions (Saltelli et al. 2010); ordered point by point, so that it grows too
    """
    if kind == "latin_hypercube":
        return np.concatenate([qmc.LatinHypercube(dimension, seed=np.random.default_rng([seed, k])).random(count)
                               for k, count in enumerate(batches)])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # scipy reminds of powers of two; the balance is lost, not the sample
        if kind == "sobol":
            return inside(qmc.Sobol(dimension, seed=np.random.default_rng(seed)).random(batches[0]))
        both = inside(qmc.Sobol(2 * dimension, seed=np.random.default_rng(seed)).random(batches[0]))
    a, b = both[:, :dimension], both[:, dimension:]
    points = []
    for row in range(len(both)):
        points += [a[row], b[row]]
        for k in range(dimension):
            mixed = a[row].copy()
            mixed[k] = b[row, k]
            points.append(mixed)
    return np.array(points)


def inside(u):
    """Off the ends, where distributions without bounds have no value."""
    return np.clip(u, 1e-9, 1.0 - 1e-9)


def copula(u, rank):
    """The points with Spearman's rank correlations, each column's distribution kept (Gaussian copula; Pearson's correlation of its normal
    scores is 2 sin(pi rank / 6)). np.linalg.LinAlgError where the matrix is none."""
    if np.array_equal(rank, np.eye(len(rank))):
        return u
    pearson = 2.0 * np.sin(np.pi * rank / 6.0)
    factor = np.linalg.cholesky(pearson)
    return inside(norm.cdf(norm.ppf(inside(u)) @ factor.T))
