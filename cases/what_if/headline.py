"""The headline numbers of a run: the one list that comparisons, sweeps and ensembles have.

A number is looked for in the summaries under each of its places in turn; a run that lacks it has None there. Volumes that no
summary has come from the frames (profile_of_flow.py).
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import paths  # noqa: F401
import profile_of_flow as flow
from chain_files import series
from stage import read_json


@dataclass(frozen=True)
class Headline:
    name: str  # column of tables; its end is the unit
    label: str
    unit: str  # SI, of the number in tables
    places: tuple  # (file, key of the file with slashes) of the number, the first that there is
    shown: str = ""  # unit in print and pictures; the same when empty
    factor: float = 1.0  # from `unit` to `shown`
    digits: int = 1

    def display(self, value):
        """The number as print and pictures give it, without its unit."""
        if value is None or not math.isfinite(value):
            return "-"
        return f"{value * self.factor:.{self.digits}f}"

    @property
    def display_unit(self):
        return self.shown or self.unit


MEASURE = 2  # to be raised when a number or the profile is measured in another way: members of sweeps are then computed anew
FEM, MPM, FLOW, HANDOVER, STRENGTH = "fem/summary.json", "mpm/summary.json", "flow", "fem/quality.csv", "strength"
HEADLINES = (
    Headline("runout_m", "runout", "m", ((MPM, "runout_m"),)),
    Headline("runout_of_body_m", "runout of the flow's body", "m", ((MPM, "runout_of_body_m"),)),
    Headline("coherent_runout_m", "runout without gaps", "m", ((MPM, "coherent_runout_m"),)),
    Headline("flow_front_m", "front of what flowed, x", "m", ((MPM, "flow_front_position_m"),)),
    Headline("released_volume_m3", "released volume", "m3", ((MPM, "flowed_volume_m3"), (FLOW, "released_volume_m3")), digits=0),
    Headline("mean_strength_Pa", "mean strength of liquefied soil", "Pa", ((STRENGTH, "mean_strength_Pa"),), "kPa", 1e-3, 2),
    Headline("flowed_mass_kg", "mass that flowed", "kg", ((MPM, "flowed_mass_kg"),), "t", 1e-3, 0),
    Headline("moved_mass_kg", "mass moved since before the motion", "kg", ((FLOW, "moved_mass_kg"),), "t", 1e-3, 0),
    Headline("freeboard_lost_m", "freeboard lost", "m", ((MPM, "freeboard_lost_m"),), digits=2),
    Headline("largest_displacement_mpm_m", "largest displacement, runout", "m", ((MPM, "largest_displacement_m"),)),
    Headline("final_rms_speed_m_s", "speed at the end (root mean square)", "m/s", ((MPM, "final_rms_speed_m_s"),), digits=3),
    Headline("simulated_time_s", "time of runout simulated", "s", ((MPM, "simulated_time_s"),)),
    Headline("lost_energy_ratio", "energy lost by the scheme", "1", ((MPM, "energy/lost_ratio"),), "%", 100.0),
    Headline("largest_displacement_fem_m", "largest displacement, shaking", "m", ((FEM, "largest_displacement_m"),), digits=2),
    Headline("displacement_at_handover_m", "largest displacement at the hand-over", "m", ((HANDOVER, "largest_displacement_m"),), digits=2),
    Headline("liquefied_depth_m", "liquefied depth", "m", ((FEM, "liquefied_depth_m"),)),
    Headline("liquefied_depth_at_handover_m", "liquefied depth at the hand-over", "m", ((HANDOVER, "liquefied_depth_m"),)),
    Headline("mean_pore_pressure_ratio", "mean r_u of the tailings", "1", ((FEM, "mean_excess_pore_pressure_ratio"),), digits=3),
)
BY_NAME = {headline.name: headline for headline in HEADLINES}


def number_at(content, key):
    """The finite number under a key with slashes, or None."""
    for part in key.split("/"):
        if not isinstance(content, dict) or part not in content:
            return None
        content = content[part]
    if isinstance(content, bool) or not isinstance(content, (int, float)) or not math.isfinite(content):
        return None
    return float(content)


def numbers(contents):
    """{name: number or None} of {file: content}."""
    found = {}
    for headline in HEADLINES:
        values = (number_at(contents.get(file) or {}, key) for file, key in headline.places)
        found[headline.name] = next((value for value in values if value is not None), None)
    return found


def of_flow(measured):
    """What the frames say (a Flow, None without), as numbers() reads it."""
    return {"released_volume_m3": measured.released_volume, "moved_mass_kg": measured.moved_mass} if measured else {}


def of_strengths(summary):
    """The mean over the particles of liquefied soil, factors included and before any softening, of a runout's summary, as numbers() reads it."""
    used = [entry for entry in (summary or {}).get("residual_strength", []) if entry["particles"]]
    count = sum(entry["particles"] for entry in used)
    return {"mean_strength_Pa": sum(entry["particles"] * entry["strength_Pa"]["mean"] for entry in used) / count} if count else {}


def at_handover(quality, time):
    """What the shaking's series (fem/quality.csv) says of the time of the hand-over (s), as numbers() reads it; empty without one, or where the
    shaking ended before."""
    rows = series(quality)
    if rows is None or time is None or not rows["time_s"][0] <= time <= rows["time_s"][-1] + 1e-9:
        return {}
    return {name: float(np.interp(time, rows["time_s"], values)) for name, values in rows.items()}


def of_run(root, fem=None):
    """Headline numbers of a run's folder (`fem`: where fem/ lies, if elsewhere), and its Flow (None without frames)."""
    root = Path(root)
    measured = flow.of_frames(root / "mpm")
    summary = read_json(root / MPM)
    contents = {MPM: summary, STRENGTH: of_strengths(summary), FEM: read_json(Path(fem or root) / FEM), FLOW: of_flow(measured),
                HANDOVER: at_handover(Path(fem or root) / HANDOVER, measured.since if measured else None)}
    return numbers(contents), measured
