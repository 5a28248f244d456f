"""Collapse of a column of water as potential flow: the reference without viscosity, gate or surface tension.

Mixed Eulerian-Lagrangian boundary elements (Longuet-Higgins & Cokelet 1976; direct formulation with straight elements):
nodes are carried along with the free surface, the potential on it follows Bernoulli's equation, and Green's third
identity gives the flux through the surface. Wall (x = 0) and bed (y = 0) are mirrors, so only the surface has elements.
Lengths in widths of the column, times in sqrt(width / g).
"""
import math

import numpy as np


def influence(points, nodes):
    """Integrals over each element, its three mirror images included, seen from the points: of ln r (constant flux), and
    of the normal derivative of ln r times a potential that falls or rises along the element from 1 to 0 or 0 to 1. The
    normal points out of the water; point i lies on element i."""
    start, side = nodes[:-1], np.diff(nodes, axis=0)
    length = np.hypot(side[:, 0], side[:, 1])
    along = side / length[:, None]
    normal = np.stack([-along[:, 1], along[:, 0]], 1)
    single, total, rising = (np.zeros((len(points), len(length))) for _ in range(3))
    for mirror in ((1, 1), (-1, 1), (1, -1), (-1, -1)):
        r = start[None] - points[:, None] * np.array(mirror)
        s1 = np.sum(r * along, axis=2)
        s2 = s1 + length
        distance = np.sum(r * normal, axis=2)
        if mirror == (1, 1):
            np.fill_diagonal(distance, 0.0)
        log1, log2 = (0.5 * np.log(s * s + distance**2) for s in (s1, s2))
        angle = np.arctan2(distance * length, distance**2 + s1 * s2)
        if mirror == (1, 1):
            np.fill_diagonal(angle, 0.0)
        single += s2 * log2 - s1 * log1 - length + distance * angle
        total += angle
        rising += (distance * (log2 - log1) - s1 * angle) / length
    return single, total - rising, rising, along, normal, length


def surface_velocity(x, phi):
    """Velocity of the nodes, flux through the elements and their lengths."""
    single, falling, rising, along, normal, length = influence(0.5 * (x[1:] + x[:-1]), x)
    known = falling @ phi[:-1] + rising @ phi[1:] - 0.5 * math.pi * (phi[1:] + phi[:-1])
    flux = np.linalg.solve(single, known)
    u = (np.diff(phi) / length)[:, None] * along + flux[:, None] * normal
    near = 1.0 / length[:, None]
    v = np.empty_like(x)
    v[1:-1] = (u[1:] * near[1:] + u[:-1] * near[:-1]) / (near[1:] + near[:-1])
    v[0], v[-1] = (0.0, u[0, 1]), (u[-1, 0], 0.0)  # as the mirrors have it
    return v, flux, length


def split_long_elements(x, phi, spacing):
    """A node in the middle (cubic through four nodes) of elements longer than 1.5 times the spacing, which is finer
    towards the tip; nodes between two elements that one could replace are left out, but never two in a row."""
    length = np.hypot(*np.diff(x, axis=0).T)
    middle = 0.5 * (x[1:] + x[:-1])
    longest = 1.5 * spacing * np.clip(0.125 + np.hypot(middle[:, 0] - x[-1, 0], middle[:, 1]), 0.0, 1.0)
    node = np.column_stack([x, phi])
    mirrored = np.vstack([node[1] * [-1, 1, 1], node, node[-2] * [1, -1, 1]])
    kept, left_out = [node[0]], False
    for k in range(len(length)):
        if length[k] > longest[k]:
            kept.append((9 * (mirrored[k + 1] + mirrored[k + 2]) - mirrored[k] - mirrored[k + 3]) / 16)
        last = k + 1 == len(length)
        if not last and k > 0 and not left_out and length[k] + length[k + 1] < 0.8 * min(longest[k], longest[k + 1]):
            left_out = True
            continue
        left_out = False
        kept.append(node[k + 1])
    kept = np.array(kept)
    return kept[:, :2].copy(), kept[:, 2].copy()


def energy(x, phi, flux, length):
    kinetic = 0.5 * np.sum(0.5 * (phi[1:] + phi[:-1]) * flux * length)
    y = x[:, 1]  # of the area under the surface
    return kinetic + np.sum((y[1:] ** 2 + y[1:] * y[:-1] + y[:-1] ** 2) / 6.0 * np.diff(x[:, 0]))


def collapse(height, end, elements=20):
    """Front of a column 1 wide and `height` high on a dry frictionless bed: times and positions of the tip.
    RuntimeError if energy changes by more than 0.2 %."""
    top = np.linspace(0.0, 1.0, elements + 1)
    side = height * np.linspace(1.0, 0.0, round(height * elements) + 1)[1:] ** 1.5  # finer towards the bed
    x = np.vstack([np.column_stack([top, np.full_like(top, height)]), np.column_stack([np.ones_like(side), side])])
    phi = np.zeros(len(x))
    t, times, tips = 0.0, [0.0], [1.0]

    def rates(y, f):
        v = surface_velocity(y, f)[0]
        return v, 0.5 * np.sum(v**2, axis=1) - y[:, 1]

    while t < end:
        v, flux, length = surface_velocity(x, phi)
        change = energy(x, phi, flux, length) / (0.5 * height**2) - 1.0
        if not abs(change) < 2e-3:
            raise RuntimeError(f"potential flow: energy has changed by {change:.1e} at t = {t:.2f}")
        stretch = np.abs(np.diff(v, axis=0)).max(axis=1) / length
        dt = min(0.02, 0.3 * math.sqrt(length.min()), 0.3 / max(stretch.max(), 1e-9))
        k1 = rates(x, phi)
        k2 = rates(x + 0.5 * dt * k1[0], phi + 0.5 * dt * k1[1])
        k3 = rates(x + 0.5 * dt * k2[0], phi + 0.5 * dt * k2[1])
        k4 = rates(x + dt * k3[0], phi + dt * k3[1])
        x = x + dt / 6.0 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
        phi = phi + dt / 6.0 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
        t += dt
        times.append(t)
        tips.append(x[-1, 0])
        x, phi = split_long_elements(x, phi, 1.0 / elements)
    return np.array(times), np.array(tips)
