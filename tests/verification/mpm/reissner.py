"""A clamped beam of rectangular section under its own weight, by Reissner's (1972) beam: the elastica with shear and
stretch, plane strain with Poisson's ratio 0 (EI, EA and 5/6 GA of the section)."""
import math

import numpy as np


def hanging_beam(length, depth, modulus, weight):
    """Position (x, y) of the free end, m, of a beam clamped along +x at the origin. `weight` N/m3, per metre of width."""
    EI, EA, GA, w = modulus * depth**3 / 12.0, modulus * depth, 5.0 / 6.0 * 0.5 * modulus * depth, weight * depth

    def slope(s, q):
        # Unknowns theta, M, x, y along the unloaded arc; the force on a section is the weight of what hangs beyond it.
        force = -w * (length - s)
        stretch, shear = 1.0 + force * math.sin(q[0]) / EA, force * math.cos(q[0]) / GA
        dx = stretch * math.cos(q[0]) - shear * math.sin(q[0])
        dy = stretch * math.sin(q[0]) + shear * math.cos(q[0])
        return np.array([q[1] / EI, -force * dx, dx, dy])

    def march(moment, steps=400):
        q, ds = np.array([0.0, moment, 0.0, 0.0]), length / steps
        for i in range(steps):
            a = slope(i * ds, q)
            b = slope((i + 0.5) * ds, q + 0.5 * ds * a)
            c = slope((i + 0.5) * ds, q + 0.5 * ds * b)
            q = q + ds / 6.0 * (a + 2 * b + 2 * c + slope((i + 1) * ds, q + ds * c))
        return q

    # The root's moment for which the end is free of one, by bisection: between that of the straight beam and none.
    low, high = -0.51 * w * length**2, 0.0
    if not march(low)[1] < 0.0 < march(high)[1]:
        raise ArithmeticError("the root's moment is not between none and the straight beam's")
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if march(middle)[1] < 0.0 else (low, middle)
    end = march(0.5 * (low + high))
    return float(end[2]), float(end[3])
