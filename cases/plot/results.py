"""Numbers of a case's results, for the report and for the lines that a run ends with."""

import chain_files as chain
import spread


def at_time(table, column, time):
    """Value of a series at `time` (nearest row), None without the series."""
    if table is None or column not in table:
        return None
    return float(table[column][abs(table["time_s"] - time).argmin()])


def show(value, digits=2):
    return "-" if value is None else f"{value:.{digits}f}" if isinstance(value, float) else str(value)


def percent(share):
    return show(None if share is None else 100.0 * share, 1)


def suggestion(window):
    """Value and unit: the time, or why there is none."""
    time = window.get("suggested_transfer_time_s")
    return (show(time), "s") if time is not None else (f"none: {window.get('reason', '-')}", "")


def law_in_words(use):
    """Model, percentile and factors of one entry of summary.json's residual_strength."""
    law, factor = use.get("law") or {}, use.get("factor", 1.0)
    model = law.get("model", "not known" if use["from"] == "hand-over" else use["from"])
    said = [model + (f" (N {law['blow_count']:g})" if "blow_count" in law and model not in ("bins", "table", "ratio", "constant") else "")]
    if "percentile" in law:
        said.append(f"percentile {law['percentile']:g}")
    if law.get("factor", 1.0) != 1.0:
        said.append(f"factor {law['factor']:g} of the hand-over")
    if factor != 1.0:
        said.append(f"factor {factor:g}")
    return ", ".join(said + (["chosen at the runout"] if use["from"] == "mpm.json" else []))


def strengths(mpm):
    """The strengths that the runout computed with, a row for each material and law."""
    rows = []
    for use in mpm.get("residual_strength", []):
        found = use["strength_Pa"]
        low, high = found["smallest"] / 1e3, found["largest"] / 1e3
        value = show(low, 2) if low == high else f"{low:.2f} to {high:.2f}, mean {found['mean'] / 1e3:.2f}"
        rows.append(("MPM", f"strength, {use['material'].replace('_', ' ')}", value, "kPa"))
        rows.append(("MPM", "  its law", law_in_words(use), ""))
    return rows


def energy_shares(mpm):
    """Of what turned over; where next to nothing flowed, shares of the little that settling turns over say nothing."""
    return mpm.get("energy", {}) if mpm.get("flowed_mass_kg", 1.0) > 0.01 * mpm.get("mass_kg", 0.0) else {}


def runout(mpm):
    """Runout from the toe and freeboard lost, as mpm_stage defines them (docs/mpm.md)."""
    if "initial_toe_m" not in mpm:
        return []
    body = mpm["runout_quantiles"][1]
    before, after = mpm.get("ground_before_m"), mpm.get("ground_after_m")
    said = f"{show(mpm.get('freeboard_lost_m'))}" + (f" ({before:.1f} to {after:.1f})" if None not in (before, after) else "")
    ran = [
        ("MPM", "runout from that toe", show(mpm.get("runout_m"), 1), "m"),
        ("MPM", f"  of {100.0 * body:g} % of what flowed", show(mpm.get("runout_of_body_m"), 1), "m"),
        ("MPM", "  without gaps", show(mpm.get("coherent_runout_m"), 1), "m"),
    ]
    if (mpm.get("runout_m") or 0.0) < 0.0:
        ran = [("MPM", "runout from that toe", f"none, what flowed ends {-mpm['runout_m']:.1f} m short of it", "")]
    if mpm.get("runout_m") is None:
        ran = [("MPM", "runout from that toe", f"none, nothing moved by more than {mpm['flow_distance_m']:g} m", "")]
    return [("MPM", "toe before the motion, x", show(mpm["initial_toe_m"], 1), "m"), *ran, ("MPM", "freeboard lost", said, "m")]


def collect(results, phase):
    """Rows (stage, what, value, unit) from the summaries and series of a case; missing ones are left out."""
    rows = []
    mesh = chain.summary(results / "fem" / "mesh.json")
    fem = chain.summary(results / "fem" / "summary.json")
    quality = chain.series(results / "fem" / "quality.csv")
    if mesh:
        rows.append(("FEM", "quadrilaterals", str(mesh.get("elements", "-")), ""))
    if fem:
        rows += [
            ("FEM", "shaking computed", show(fem.get("end_time_s")), "s"),
            ("FEM", "largest displacement", show(fem.get("largest_displacement_m")), "m"),
            ("FEM", "liquefied depth", show(fem.get("liquefied_depth_m"), 1), "m"),
            ("FEM", "mean r_u of the tailings", show(fem.get("mean_excess_pore_pressure_ratio")), "1"),
            ("FEM", "mean r_u at 5 s", show(at_time(quality, "mean_excess_pore_pressure_ratio", 5.0)), "1"),
            ("FEM", "smallest scaled Jacobian", show(fem.get("min_scaled_jacobian")), "1"),
            ("FEM", "suggested hand-over", *suggestion(fem.get("transfer_window", {}))),
            ("FEM", "wall time", show(fem.get("seconds", {}).get("total"), 1), "s"),
        ]
    mpm = chain.summary(phase / "mpm" / "summary.json")
    if mpm:
        rows += [
            ("MPM", "particles", str(mpm.get("particles", "-")), ""),
            ("MPM", "time simulated", show(mpm.get("simulated_time_s"), 1), "s"),
            ("MPM", "ended", mpm.get("stop_reason", "-"), ""),
            ("MPM", "root mean square speed then", show(mpm.get("final_rms_speed_m_s"), 3), "m/s"),
            ("MPM", "speed of the front then", show(mpm.get("final_front_speed_m_s"), 3), "m/s"),
            ("MPM", "front of all soil, x", show(mpm.get("robust_front_position_m"), 1), "m"),
            ("MPM", "front of what flowed, x", show(mpm.get("flow_front_position_m"), 1), "m"),
            ("MPM", "mass that flowed, per m of dam", show(mpm.get("flowed_mass_kg", 0.0) / 1e3, 0), "t"),
            *runout(mpm),
            ("MPM", "largest displacement", show(mpm.get("largest_displacement_m"), 1), "m"),
            ("MPM", "energy lost by the scheme", percent(energy_shares(mpm).get("lost_ratio")), "%"),
            ("MPM", "  not in transfer or impacts", percent(energy_shares(mpm).get("residual_ratio")), "%"),
            *strengths(mpm),
            ("MPM", "wall time", show(mpm.get("wall_seconds", {}).get("total"), 1), "s"),
        ]
    geostatic = chain.summary(results / "fem" / "geostatic.json")
    for stage, summaries in (("FEM", (mesh, geostatic, fem)), ("MPM", (mpm,))):
        told = [text for summary in summaries if summary for text in summary.get("warnings", [])]
        rows += [(stage, "warning", text, "") for text in dict.fromkeys(told)]
    return spread.add(rows, phase)
