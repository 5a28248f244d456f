"""One line about a sweep that is being computed: members done and failed, and the time left.

Each unit that ends adds a line to `finished.tsv` of the sweep's folder; `running.json` says what there was to do at the start.
"""

import json
import os
import sys
import time
from pathlib import Path

EVERY = 10.0  # s between lines where they do not overwrite each other


def begin(folder, units, members, jobs):
    """`units`: stages of what is to be computed, one entry a unit; `members`: how many the sweep has."""
    folder = Path(folder)
    to_do = {stage: sum(1 for unit in units if unit == stage) for stage in dict.fromkeys(units)}
    (folder / "running.json").write_text(json.dumps({"units": to_do, "members": members, "jobs": jobs}))
    (folder / "finished.tsv").write_text("")
    (folder / ".shown").unlink(missing_ok=True)


def in_words(seconds):
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"


def line(running, finished):
    """The line's text. Time left: for each stage the mean time of its units so far times those that are left, over the units at a
    time; not said before a unit of every stage has ended."""
    mine = [entry for entry in finished if entry[0] == "mpm"]
    failed = sum(1 for entry in mine if entry[2] != "1")
    done = running["members"] - running["units"].get("mpm", 0) + len(mine) - failed
    left, known = 0.0, True
    for stage, count in running["units"].items():
        times = [float(entry[3]) for entry in finished if entry[0] == stage]
        known = known and bool(times)
        left += sum(times) / max(len(times), 1) * (count - len(times))
    text = f"sweep: {done} of {running['members']} members done" + (f", {failed} failed" if failed else "")
    open_units = sum(running["units"].values()) - len(finished)
    return text + (f", {in_words(left / running['jobs'])} left" if known and open_units else "")


def note(folder, stage, key, success, seconds):
    """A unit has ended; shows the line."""
    folder = Path(folder)
    try:
        with (folder / "finished.tsv").open("a") as file:
            file.write(f"{stage}\t{key}\t{int(success)}\t{seconds:.3f}\n")
        running = json.loads((folder / "running.json").read_text())
        finished = [text.split("\t") for text in (folder / "finished.tsv").read_text().splitlines()]
    except (OSError, ValueError):
        return  # the line is a comfort; the sweep goes on without it
    show(folder, line(running, finished), len(finished) >= sum(running["units"].values()))


def write(text):
    """In one piece: several units say something at a time."""
    sys.stderr.write(text)
    sys.stderr.flush()


def show(folder, text, last):
    if sys.stderr.isatty():
        write(f"\r\x1b[K{text}" + ("\n" if last else ""))
        return
    shown = folder / ".shown"
    if last or not shown.exists() or time.time() - os.stat(shown).st_mtime > EVERY:
        write(text + "\n")
        try:
            shown.touch()
        except OSError:
            pass
