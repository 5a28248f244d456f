"""Ground motions: PEER AT2 files, response spectra and the intensity measures of a motion's report. numpy only."""

import re
from pathlib import Path

import numpy as np

STANDARD_GRAVITY = 9.81  # m/s2, as everywhere in tailrun


NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?"
# As fem_stage reads them (common/motion_units.cpp), in g; what is not here is refused.
UNITS = (
    (r"(FRACTION OF )?G('S|S)?", 1.0),
    (r"GALS?|CM ?/ ?(S|SEC) ?(/ ?(S|SEC)|(\*\*|\^)? ?2)", 0.01 / STANDARD_GRAVITY),
    (r"M ?/ ?(S|SEC) ?(/ ?(S|SEC)|(\*\*|\^)? ?2)", 1.0 / STANDARD_GRAVITY),
)


def number(word):
    """A number as Fortran or C writes it."""
    return float(word.upper().replace("D", "E"))


def read_at2(path):
    """Acceleration (g) and time step (s) of a PEER AT2 file; values beyond NPTS are dropped, missing ones an error, and so are
    units that are not known. ValueError says which file and line."""
    lines = Path(path).read_text().replace("\r", "").split("\n")
    place = next((i for i, line in enumerate(lines[:12]) if re.search(r"\bNPTS\b", line.upper())), None)
    header = lines[place].upper() if place is not None else ""
    modern = re.search(rf"NPTS\s*=\s*(\d+).*?DT\s*=\s*({NUMBER})\s*(\w*)", header)
    old = re.search(rf"^\s*(\d+)\s+({NUMBER})\s*,?\s+NPTS()", header)
    if not (modern or old):
        raise ValueError(f"{path}: no line with 'NPTS= n, DT= s SEC' or 'n dt NPTS, DT' among the first twelve")
    count, step, unit = (modern or old).groups()
    factors = {"": 1.0, "S": 1.0, "SEC": 1.0, "SECS": 1.0, "SECONDS": 1.0, "MS": 1e-3, "MSEC": 1e-3}
    if unit not in factors:
        raise ValueError(f"{path}: line {place + 1}: {unit} after the time step is no unit of time")
    factor = 1.0
    for i, line in enumerate(lines[:place]):
        stated = re.search(r"\bUNITS?\b\s*(?:OF|IN|ARE|:|=)*\s*[(\[]?\s*(.+)", line.upper())
        if stated:
            known = [f for pattern, f in UNITS if re.match(rf"(?:{pattern})(?![A-Z0-9/])", stated.group(1))]
            if not known or re.search(r"\bVELOCITY|\bDISPLACEMENT", line.upper()):
                raise ValueError(f"{path}: line {i + 1}: not an acceleration in g, cm/s2 or m/s2: {line!r}")
            factor = known[0]
    values = []
    for i, line in enumerate(lines[place + 1 :], place + 2):
        if re.sub(NUMBER, "", line).strip():
            raise ValueError(f"{path}: line {i}: not numbers: {line!r}")
        values += [number(word) for word in re.findall(NUMBER, line)]
    if len(values) < int(count):
        raise ValueError(f"{path}: {len(values)} values, NPTS says {count}")
    return factor * np.array(values[: int(count)]), number(step) * factors[unit]


def write_at2(path, acceleration, step, title):
    """Writes acceleration (g); `title` is two lines."""
    with open(path, "w") as out:
        out.write(title[0] + "\n" + title[1] + "\nACCELERATION TIME SERIES IN UNITS OF G\n")
        out.write(f"NPTS= {acceleration.size:5d}, DT= {step:7.4f} SEC\n")
        for start in range(0, acceleration.size, 5):
            out.write("".join(f"{value:15.7E}" for value in acceleration[start : start + 5]) + "\n")


def integrate(values, step):
    """Trapezoidal integral, 0 at the first point."""
    return np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1])) * step])


def oscillator_coefficients(periods, step, damping):
    """Exact recurrence of linear oscillators under piecewise linear base acceleration (Nigam and Jennings 1969):
    state = A state + B (a_i, a_i+1), per period; shapes (n, 2, 2)."""
    omega = 2.0 * np.pi / np.asarray(periods, dtype=float)
    damped = omega * np.sqrt(1.0 - damping**2)
    decay = np.exp(-damping * omega * step)
    sine, cosine = np.sin(damped * step), np.cos(damped * step)
    ratio = damping / np.sqrt(1.0 - damping**2)
    a = np.empty((omega.size, 2, 2))
    a[:, 0, 0] = decay * (ratio * sine + cosine)
    a[:, 0, 1] = decay * sine / damped
    a[:, 1, 0] = -omega / np.sqrt(1.0 - damping**2) * decay * sine
    a[:, 1, 1] = decay * (cosine - ratio * sine)
    c1 = (2.0 * damping**2 - 1.0) / (omega**2 * step)
    c2 = 2.0 * damping / (omega**3 * step)
    b = np.empty_like(a)
    b[:, 0, 0] = decay * ((c1 + damping / omega) * sine / damped + (c2 + 1.0 / omega**2) * cosine) - c2
    b[:, 0, 1] = -decay * (c1 * sine / damped + c2 * cosine) - 1.0 / omega**2 + c2
    slope_sine, slope_cosine = cosine - ratio * sine, -(damped * sine + damping * omega * cosine)
    b[:, 1, 0] = (
        decay * ((c1 + damping / omega) * slope_sine + (c2 + 1.0 / omega**2) * slope_cosine) + 1.0 / (omega**2 * step)
    )
    b[:, 1, 1] = -decay * (c1 * slope_sine + c2 * slope_cosine) - 1.0 / (omega**2 * step)
    return a, b


def response_spectrum(acceleration, step, periods, damping=0.05):
    """Pseudo-spectral acceleration, in the unit of `acceleration`."""
    periods = np.asarray(periods, dtype=float)
    a, b = oscillator_coefficients(periods, step, damping)
    state = np.zeros((periods.size, 2))
    peak = np.zeros(periods.size)
    for first, second in zip(acceleration[:-1], acceleration[1:]):
        state = np.einsum("nij,nj->ni", a, state) + b[:, :, 0] * first + b[:, :, 1] * second
        peak = np.maximum(peak, np.abs(state[:, 0]))
    return peak * (2.0 * np.pi / periods) ** 2


def husid(acceleration):
    """Share of the Arias intensity that has arrived at each point."""
    energy = np.cumsum(acceleration**2)
    return energy / energy[-1]


def arrival(acceleration, step, share):
    """Time (s) at which `share` of the Arias intensity has arrived."""
    return np.interp(share, husid(acceleration), np.arange(acceleration.size) * step)


def measures(acceleration, step):
    """Intensity measures of an acceleration in g, as {name: (value, unit)}."""
    si = acceleration * STANDARD_GRAVITY
    velocity = integrate(si, step)
    displacement = integrate(velocity, step)
    d5 = arrival(acceleration, step, 0.05)
    return {
        "PGA": (float(np.abs(acceleration).max()), "g"),
        "PGV": (float(np.abs(velocity).max()) * 100.0, "cm/s"),
        "PGD": (float(np.abs(displacement).max()) * 100.0, "cm"),
        "Arias intensity": (float(np.pi / (2.0 * STANDARD_GRAVITY) * np.sum(si**2) * step), "m/s"),
        "D5-75": (float(arrival(acceleration, step, 0.75) - d5), "s"),
        "D5-95": (float(arrival(acceleration, step, 0.95) - d5), "s"),
        "final velocity": (float(velocity[-1]) * 100.0, "cm/s"),
        "final displacement": (float(displacement[-1]) * 100.0, "cm"),
    }


def target_spectrum(path):
    """Periods (s) and PSA/PGA of a two-column CSV with comments and one header line."""
    rows = [line for line in Path(path).read_text().splitlines() if line and line[0].isdigit()]
    table = np.array([[float(word) for word in row.split(",")] for row in rows])
    return table[:, 0], table[:, 1]


def target_at(periods, table):
    """PSA/PGA at `periods`, linear in log-log."""
    return np.exp(np.interp(np.log(periods), np.log(table[0]), np.log(table[1])))
