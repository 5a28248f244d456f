"""How far runs that differ in nothing physical lie apart (make ensemble), beside the numbers of a run."""

import json
from pathlib import Path

# (stage, words in results.py) -> (number in uncertainty.json, factor to the unit shown there, digits)
ROWS = {
    ("FEM", "largest displacement"): ("largest_displacement_fem_m", 1.0, 2),
    ("FEM", "liquefied depth"): ("liquefied_depth_m", 1.0, 1),
    ("FEM", "mean r_u of the tailings"): ("mean_pore_pressure_ratio", 1.0, 2),
    ("MPM", "runout from that toe"): ("runout_m", 1.0, 1),
    ("MPM", "  without gaps"): ("coherent_runout_m", 1.0, 1),
    ("MPM", "front of what flowed, x"): ("flow_front_m", 1.0, 1),
    ("MPM", "mass that flowed, per m of dam"): ("flowed_mass_kg", 1e-3, 0),
    ("MPM", "freeboard lost"): ("freeboard_lost_m", 1.0, 2),
    ("MPM", "largest displacement"): ("largest_displacement_mpm_m", 1.0, 1),
    ("MPM", "energy lost by the scheme"): ("lost_energy_ratio", 100.0, 1),
}


def read(path):
    try:
        return json.loads(Path(path).read_text())
    except (OSError, ValueError):
        return {}


def add(rows, phase):
    """The rows (results.collect) with ` +- standard deviation` where uncertainty.json was made for the run's own input."""
    phase = Path(phase)
    known = read(phase / "uncertainty.json")
    if not known or known.get("of") != read(phase / ".inputs" / "mpm.json").get("key"):
        return rows
    numbers, found = known["numbers"], []
    for stage, what, value, unit in rows:
        name, factor, digits = ROWS.get((stage, what), ("", 1.0, 0))
        if name in numbers and value != "-" and not value.startswith("none"):
            value = f"{value} +- {numbers[name]['standard_deviation'] * factor:.{digits}f}"
        found.append((stage, what, value, unit))
    found.append(("", "+- over", f"{known['members']} runs that differ in nothing physical ({', '.join(known['varied'])})", ""))
    return found
