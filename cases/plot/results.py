"""Numbers of a case's results, for the report and for the lines that a run ends with."""

import chain_files as chain
import spread


def at_time(table, column, time):
    """Value of a series at `time` (nearest row), None without the series."""
    if table is None or column not in table:
        return None
    return float(table[column][abs(table["time_s"] - time).argmin()])


def first_last(table, column):
    return (float(table[column][0]), float(table[column][-1])) if table is not None and column in table else (None, None)


def show(value, digits=2):
    return "-" if value is None else f"{value:.{digits}f}" if isinstance(value, float) else str(value)


def percent(share):
    return show(None if share is None else 100.0 * share, 1)


def suggestion(window):
    """Value and unit: the time, or why there is none."""
    time = window.get("suggested_transfer_time_s")
    return (show(time), "s") if time is not None else (f"none: {window.get('reason', '-')}", "")


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
    front = chain.series(phase / "mpm" / "front.csv")
    if mpm:
        crest = first_last(front, "crest_y_m")
        rows += [
            ("MPM", "particles", str(mpm.get("particles", "-")), ""),
            ("MPM", "time simulated", show(mpm.get("simulated_time_s"), 1), "s"),
            ("MPM", "ended", mpm.get("stop_reason", "-"), ""),
            ("MPM", "front of all soil, x", show(mpm.get("robust_front_position_m"), 1), "m"),
            ("MPM", "front of what flowed, x", show(mpm.get("flow_front_position_m"), 1), "m"),
            ("MPM", "mass that flowed, per m of dam", show(mpm.get("flowed_mass_kg", 0.0) / 1e3, 0), "t"),
            ("MPM", "largest displacement", show(mpm.get("largest_displacement_m"), 1), "m"),
            ("MPM", "energy lost by the scheme", percent(mpm.get("energy", {}).get("lost_ratio")), "%"),
            ("MPM", "  not in transfer or impacts", percent(mpm.get("energy", {}).get("residual_ratio")), "%"),
            ("MPM", "wall time", show(mpm.get("wall_seconds", {}).get("total"), 1), "s"),
        ]
        if crest[0] is not None:
            rows.insert(-3, ("MPM", "crest sinks by", show(crest[0] - crest[1] + 0.0), "m"))
    geostatic = chain.summary(results / "fem" / "geostatic.json")
    for stage, summaries in (("FEM", (mesh, geostatic, fem)), ("MPM", (mpm,))):
        told = [text for summary in summaries if summary for text in summary.get("warnings", [])]
        rows += [(stage, "warning", text, "") for text in dict.fromkeys(told)]
    return spread.add(rows, phase)
