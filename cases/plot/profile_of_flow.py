"""Where the soil of a plane runout ends: ground surface and depth of what flowed, over x, from the first and last frame."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import chain_files as chain

FLOW_DISTANCE = 1.0  # m; mpm.json's output/flow_distance when it says nothing
COLUMNS = {"x_m": ("x", "m", "middle of the column"),
           "initial_surface_m": ("initial_surface", "m", "highest soil at the hand-over"),
           "surface_m": ("surface", "m", "highest soil at the end"),
           "bed_m": ("bed", "m", "the ground that soil flows over, where it is no soil itself"),
           "flow_depth_m": ("depth", "m", "volume of the soil that moved farther than flow_distance, over the column's width")}


@dataclass
class Flow:
    """Columns of soil of equal width: all arrays have one value a column; NaN where there is no soil."""

    x: np.ndarray  # m
    initial_surface: np.ndarray  # m
    surface: np.ndarray  # m
    bed: np.ndarray  # m
    depth: np.ndarray  # m
    width: float  # m
    released_volume: float  # m3 per metre of dam
    moved_mass: float  # kg per metre of dam: of soil farther than flow_distance from where it was before the motion (released: at the hand-over)
    since: float  # s since the start of the motion at which the runout begins


def column_width(particle_size):
    """m; the nearest to four particles of 1, 1.5, 2, 3, 4, 6, 8 times a power of ten, so that it is the same for runs whose particles are
    nearly of one size."""
    wanted = 4.0 * particle_size
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(min((step * power for step in (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0)), key=lambda width: abs(np.log(width / wanted))))


def highest(column, y, count):
    surface = np.full(count, -np.inf)
    np.maximum.at(surface, column, y)
    return np.where(np.isfinite(surface), surface, np.nan)


def ground(terrain, x):
    """Height (m) of the terrain's lines at x, the highest of them; walls, which are upright or nearly so, are none."""
    height = np.full(len(x), np.nan)
    for line in terrain.values():
        order = np.argsort(line[:, 0], kind="stable")
        if np.ptp(line[:, 0]) > 0.2 * np.ptp(line[:, 1]):
            height = np.fmax(height, np.interp(x, line[order, 0], line[order, 1], np.nan, np.nan))
    return height


def shared_out(place, amount, half, count):
    """Sum of amounts by column: place in units of columns, each amount spread evenly over place -+ half."""
    low, high = place - half, place + half
    first = np.floor(low).astype(int)
    ahead = np.clip((high - (first + 1)) / (2.0 * half), 0.0, 1.0)  # share in the next column
    total = np.bincount(np.clip(first, 0, count - 1), amount * (1.0 - ahead), count)
    return total + np.bincount(np.clip(first + 1, 0, count - 1), amount * ahead, count)


def of_particles(first, last, flow_distance=FLOW_DISTANCE):
    """Flow between two sets of particles (chain_files.Particles). Columns are about four particles wide, two cells of the usual grid, and begin at
    whole multiples of their width, so that runs of the same size share them; a particle's volume is shared out over the columns that
    it lies in. Particles that have left count nowhere; where some have, what moved is told by the displacement since the start of the
    motion."""
    width = column_width(first.size)
    moved = last.data["displacement"][:, :2].copy()
    since_before = np.hypot(moved[:, 0], moved[:, 1]) > flow_distance
    if len(first.position) == len(last.position):
        moved -= first.data["displacement"][:, :2]
    flowed = np.hypot(moved[:, 0], moved[:, 1]) > flow_distance
    edge = [np.floor(p.position[:, 0] / width).astype(int) for p in (first, last)]
    begin = min(e.min() for e in edge)
    count = max(e.max() for e in edge) - begin + 1
    half = 0.5 * first.size
    volume = last.data["volume"]
    depth = shared_out(last.position[flowed, 0] / width - begin, volume[flowed], half / width, count) / width
    x = (begin + np.arange(count) + 0.5) * width
    return Flow(x, highest(edge[0] - begin, first.position[:, 1] + half, count), highest(edge[1] - begin, last.position[:, 1] + half, count),
                ground(last.terrain, x), depth, width, float(volume[flowed].sum()), float(last.data["mass"][since_before].sum()), first.time)


def of_frames(folder, flow_distance=FLOW_DISTANCE):
    """Flow of a results' folder of mpm_stage; None without frames and in three dimensions."""
    folder = Path(folder)
    if not list(folder.glob("frames/*.series")):
        return None
    frames = chain.frames(folder)
    first, last = chain.Particles(frames[0]), chain.Particles(frames[-1])
    if "displacement" not in last.data or last.data["effective_stress"].shape[1] != 4:
        return None
    return of_particles(first, last, flow_distance)


def write(path, flow):
    """CSV of a Flow; empty where there is no soil."""
    columns = [getattr(flow, field) for field, _, _ in COLUMNS.values()]
    lines = [",".join(COLUMNS)]
    lines += [",".join("" if np.isnan(value) else f"{value:.6g}" for value in row) for row in zip(*columns)]
    Path(path).write_text("\n".join(lines) + "\n")
