"""What the runout's panels are measured by: the ground before the motion, the toe there, and the front of what has flowed."""

from pathlib import Path

import numpy as np

import chain_files as chain

TOE, FRONT = "#222222", "#c0392b"


def ground_line(particles):
    """x and y of the ground before the motion: in columns two particles wide, the highest of what is not apart from the rest."""
    before = particles.position - particles.data.get("displacement", np.zeros((len(particles.position), 3)))[:, :2]
    width = 2.0 * particles.size
    column = np.floor(before[:, 0] / width).astype(int)
    order = np.lexsort((before[:, 1], column))
    column, y = column[order], before[order, 1]
    starts = np.flatnonzero(np.diff(column, prepend=column[0] - 1))
    x, tops = [], []
    for start, end in zip(starts, np.append(starts[1:], len(column))):
        heights = y[start:end]
        gaps = np.flatnonzero(np.diff(heights) > 2.0 * width)
        x.append((column[start] + 0.5) * width)
        tops.append(heights[gaps[0] if len(gaps) else -1] + 0.5 * particles.size)
    return np.array(x), np.array(tops)


class Marks:
    """Of one run: its first frame, and the summary and series in its folder."""

    def __init__(self, first, folder):
        summary = chain.summary(Path(folder) / "summary.json")
        self.series = chain.series(Path(folder) / "front.csv")
        self.toe = summary.get("initial_toe_m")
        self.start = first.time
        self.along_x = summary.get("front_direction", "+x")[1] == "x"
        self.sign = -1.0 if summary.get("front_direction", "+x")[0] == "-" else 1.0
        self.x, self.y = ground_line(first)

    def runout(self, column):
        """m, of a column of positions in front.csv."""
        return self.sign * (self.series[column] - self.toe)

    def front_at(self, time):
        """m, position that the runout reaches at a frame's time; None when nothing has flowed."""
        if self.series is None or self.toe is None or "runout_m" not in self.series:
            return None
        runout = self.series["runout_m"][np.abs(self.start + self.series["time_s"] - time).argmin()]
        return float(self.toe + self.sign * runout) if np.isfinite(runout) else None

    def draw_ground(self, axis, **options):
        axis.plot(self.x, self.y, **{"color": TOE, "lw": 0.9, "ls": (0, (4, 3)), **options})

    def draw(self, axis, time, view):
        """The ground before, the toe, and the front with the runout."""
        self.draw_ground(axis)
        if self.toe is None or not self.along_x:
            return
        base = self.y[np.abs(self.x - self.toe).argmin()]
        self.draw_mark(axis, self.toe, base, view, 0.93, TOE, "toe before")
        front = self.front_at(time)
        if front is not None:
            runout = self.sign * (front - self.toe)
            words = f"runout {runout:.1f} m" if runout >= 0.0 else f"{-runout:.1f} m short of it"
            self.draw_mark(axis, front, base, view, 0.76, FRONT, f"front, {words}")

    @staticmethod
    def draw_mark(axis, x, base, view, level, colour, words):
        """A line from the ground up to its words at a share `level` of the panel's height."""
        top = view[2] + level * (view[3] - view[2])
        left = x > view[0] + 0.75 * (view[1] - view[0])
        axis.plot([x, x], [base, top], color=colour, lw=0.9)
        axis.annotate(words, (x, top), xytext=(-4 if left else 4, 0), textcoords="offset points", color=colour, fontsize=9,
                      ha="right" if left else "left", va="top")
