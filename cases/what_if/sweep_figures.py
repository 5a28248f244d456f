"""Pictures of a sweep: exceedance, sensitivity, profiles along the flow, headline numbers against parameters."""

import math
import textwrap

import numpy as np
from scipy.stats import beta

import paths  # noqa: F401
import sensitivity
import style
from headline import BY_NAME
from members_table import WANTED, text_of_choice

SHOWN = ("runout_m", "released_volume_m3")
CONFIDENCE = 0.95
BLUE, RED = "#2b6ca3", style.ACCENT


def shown_headlines(table):
    return [BY_NAME[name] for name in SHOWN if np.isfinite(table.numbers[name][table.draws]).any()]


def band(exceeding, done, failed):
    """Clopper and Pearson's interval for a probability, from how many of the `done` independent members exceed; pointwise. What `failed`
    members would have come to is not known: the lower end counts them as not exceeding, the upper end as exceeding."""
    tail, count = 0.5 * (1.0 - CONFIDENCE), done + failed
    least, most = np.asarray(exceeding, float), np.asarray(exceeding, float) + failed
    with np.errstate(invalid="ignore"):
        low = np.where(least > 0, beta.ppf(tail, least, count - least + 1), 0.0)
        high = np.where(most < count, beta.ppf(1.0 - tail, most + 1, count - most), 1.0)
    return low, high


def band_words(failed):
    words = f"{100 * CONFIDENCE:.0f} % confidence at each point (Clopper-Pearson)"
    return words + (f",\n{failed} failed member{'s' if failed > 1 else ''} counted either way" if failed else "")


def failed_draws(table):
    return int(sum(state == "failed" for state, draw in zip(table.state, table.draws) if draw))


def axis_words(p):
    """What pictures call a parameter."""
    return p.get("axis") or p["name"].replace("_", " ") + (" (factor on the file's value)" if p["scales"] else "")


def known_elsewhere(table, headline):
    """(name, number as shown) that the sweep file's `reference` has of a headline number, or None."""
    reference = table.plan.get("reference") or {"numbers": {}}
    number = reference["numbers"].get(headline.name)
    return None if number is None else (reference["name"], number * headline.factor)


def exceedance(plt, table, output):
    headlines, failed = shown_headlines(table), failed_draws(table)
    figure, axes = plt.subplots(1, len(headlines), figsize=(style.WIDTH, 4.6), squeeze=False)
    for axis, headline in zip(axes[0], headlines):
        values = np.sort(table.numbers[headline.name][table.draws & np.isfinite(table.numbers[headline.name])]) * headline.factor
        count = len(values)
        span = max(np.ptp(values), 1e-3 * max(abs(values[-1]), 1e-9))
        steps = np.concatenate([[values[0] - 0.08 * span], values, [values[-1] + 0.08 * span]])
        more = np.concatenate([[count], np.arange(count - 1, -1, -1), [0]])
        low, high = band(more, count, failed)
        axis.fill_between(steps, low, high, step="post", color=BLUE, alpha=0.18, lw=0, label=band_words(failed))
        axis.step(steps, more / count, where="post", color=BLUE, label=f"share of the {count} members done")
        known = known_elsewhere(table, headline)
        if known:
            axis.axvline(known[1], color=RED, lw=1.2, ls="--", label=f"{known[0]}: {known[1]:g} {headline.display_unit}")
            steps[0], steps[-1] = min(steps[0], known[1] - 0.08 * span), max(steps[-1], known[1] + 0.08 * span)
        axis.set(xlabel=f"{headline.label} ({headline.display_unit})",
                 ylabel="share of members with more" if table.plan["design"] == "grid" else "probability of more",
                 ylim=(0.0, 1.0), xlim=(steps[0], steps[-1]), title=headline.label)
        axis.grid(alpha=0.3)
        axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), fontsize=8)
    style.save(figure, output)


def in_order(table, headline):
    """The regression's effects, the largest last (it is drawn on top), and what it explains."""
    effects, explained = sensitivity.regression(table, headline.name)
    return (sorted(effects, key=lambda effect: abs(effect.high - effect.low)) if effects else None), explained


def effect_words(table, effect):
    """What its bar is called; of a list of words with those of the lowest and the highest mean."""
    p = next(p for p in table.parameters if p["name"] == effect.name)
    return axis_words(p) + ("" if p["numeric"] else f":\n{text_of_choice(p, effect.low_at)} \u2192 {text_of_choice(p, effect.high_at)}")


def tornado(axis, table, headline):
    effects, explained = in_order(table, headline)
    if effects is None:
        axis.text(0.5, 0.5, explained, ha="center", va="center", wrap=True, transform=axis.transAxes)
        axis.set_axis_off()
    else:
        rows = np.arange(len(effects))
        words = any(effect.low_at is not None or effect.high_at is not None for effect in effects)
        for row, effect in zip(rows, effects):
            for change, colour, share, choice in ((effect.low, BLUE, "10th", "first"), (effect.high, RED, "90th", "second")):
                label = f"at its {share} percentile" + (f",\nor the {choice} of two choices" if words else "")
                axis.barh(row, change * headline.factor, color=colour, height=0.6, label=label if row == 0 else None)
        axis.axvline(0.0, color="0.3", lw=0.8)
        axis.set_yticks(rows, [effect_words(table, effect) for effect in effects], fontsize=8)
        axis.set_xlabel(f"change ({headline.display_unit}), linear regression, $R^2$ = {explained:.2f}")
        axis.grid(alpha=0.3, axis="x")
        axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.06 - 0.45 / max(len(effects), 2)), fontsize=8, ncol=2)
    axis.set_title(f"{headline.label}: one parameter at a time")


def indices(axis, table, headline):
    found, said = sensitivity.sobol(table, headline.name)
    if found is not None:
        found = sorted(found, key=lambda index: index.total)
        names = [axis_words(next(p for p in table.parameters if p["name"] == index.name)) for index in found]
        rows = np.arange(len(names))
        for offset, colour, label, parts in ((0.18, BLUE, "first order", [(i.first, i.first_interval) for i in found]),
                                             (-0.18, RED, "total", [(i.total, i.total_interval) for i in found])):
            value = np.array([part[0] for part in parts])
            error = np.abs(np.array([part[1] for part in parts]).T - value)
            axis.barh(rows + offset, value, height=0.34, color=colour, label=label, xerr=error, ecolor="0.3")
        axis.set(title=f"{headline.label}: Sobol' indices", xlabel=f"share of the variance, with 95 % by bootstrap; {said} points (Saltelli)")
        axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.06 - 0.45 / max(len(names), 2)), fontsize=8, ncol=2)
    else:
        effects, explained = in_order(table, headline)
        if effects is None:
            axis.set_axis_off()
            return
        names = [axis_words(next(p for p in table.parameters if p["name"] == effect.name)) for effect in effects]
        rows = np.arange(len(names))
        axis.barh(rows, [effect.share for effect in effects], height=0.6, color=BLUE)
        axis.set(title=f"{headline.label}: first-order shares by regression", xlabel=f"$b_i^2$ var($x_i$) / var(y); explained together: {explained:.2f}")
    axis.set_yticks(rows, names, fontsize=8)
    axis.set_xlim(left=min(0.0, axis.get_xlim()[0]), right=max(1.0, axis.get_xlim()[1]))
    axis.grid(alpha=0.3, axis="x")


def sensitivities(plt, table, output):
    headlines = shown_headlines(table)
    height = 2.3 + 0.45 * max(len(sensitivity.varied(table)), 2)
    figure, axes = plt.subplots(len(headlines), 2, figsize=(style.WIDTH, height * len(headlines)), squeeze=False)
    for row, headline in zip(axes, headlines):
        tornado(row[0], table, headline)
        indices(row[1], table, headline)
    style.save(figure, output)


def profiles(plt, table, output):
    p = table.profiles
    have, failed = table.done & table.draws & ~np.isnan(p["depth"]).all(axis=1), failed_draws(table)
    depth, one_bed = p["depth"][have], p["one_bed"]
    surface, initial = (p[name][have] for name in (("surface", "initial_surface") if one_bed else ("height", "initial_height")))
    some = np.flatnonzero((depth > 0.0).any(axis=0))
    some = some if len(some) else np.arange(len(p["x"]))
    margin = max(int(0.06 * (some[-1] - some[0])), 3)
    part = slice(max(some[0] - margin, 0), some[-1] + margin + 1)
    x = p["x"][part]
    figure, axes = plt.subplots(3, 1, figsize=(style.WIDTH, 9.5), sharex=True)
    for axis, values, label in ((axes[0], surface, "ground at the end" if one_bed else "ground at the end over each member's own bed"), (axes[1], depth, "depth of what flowed")):
        known = ~np.isnan(values[:, part]).all(axis=0)
        low, middle, high = np.nanpercentile(values[:, part][:, known], [10, 50, 90], axis=0)
        axis.fill_between(x[known], low, high, color=BLUE, alpha=0.25, lw=0, label="P10 to P90")
        axis.plot(x[known], middle, color=BLUE, label="P50")
        axis.set_title(f"{label}, column by column over {have.sum()} members" + (" (heights exaggerated)" if axis is axes[0] else ""))
    known = ~np.isnan(initial[:, part]).all(axis=0)
    axes[0].plot(x[known], np.nanmedian(initial[:, part][:, known], axis=0), color="0.4", lw=1.0, ls="--", label="at the hand-over")
    axes[0].plot(x, p["bed"][part] if one_bed else 0.0 * x, color="#8b6b4a", lw=1.2, label="bed")
    axes[0].set_ylabel("y (m)" if one_bed else "height (m)")
    axes[1].set_ylabel("depth (m)")
    axes[1].set_ylim(bottom=0.0)
    share = (depth[:, part] > WANTED).sum(axis=0)
    low, high = band(share, len(depth), failed)
    axes[2].fill_between(x, low, high, step="mid", color=RED, alpha=0.18, lw=0, label=band_words(failed))
    axes[2].step(x, share / len(depth), where="mid", color=RED, label=f"share of the {len(depth)} members done")
    axes[2].set(ylim=(0.0, 1.02), xlabel="x (m)", ylabel="probability", title=f"flow deeper than {WANTED:g} m", xlim=(x[0], x[-1]))
    for axis in axes:
        axis.grid(alpha=0.3)
        axis.legend(loc="best", fontsize=8, frameon=True)
    style.save(figure, output)


def words_in_order(p, values):
    """What pictures call those values of a list that there are, in the list's order."""
    present = {text_of_choice(p, value) for value in values}
    listed = [text_of_choice(p, value) for value in p.get("choices") or []]
    return [word for word in listed if word in present] + sorted(present - set(listed))


def base_choice(p):
    """The choice that the base run has; null is "as the case file says"."""
    return None if None in (p.get("choices") or []) else p["base"]


def scatter(plt, table, output):
    """One row of panels a headline number, at most five parameters a row."""
    headlines, most = shown_headlines(table), 5
    varied = sensitivity.varied(table) or table.parameters
    columns = math.ceil(len(varied) / math.ceil(len(varied) / most))
    rows = [(headline, varied[k:k + columns]) for k in range(0, len(varied), columns) for headline in headlines]
    figure, axes = plt.subplots(len(rows), columns, figsize=(style.WIDTH, 3.2 * len(rows)), squeeze=False, sharey="row")
    for axis_row, (headline, parameters) in zip(axes, rows):
        values = table.numbers[headline.name] * headline.factor
        for axis in axis_row[len(parameters):]:
            axis.set_axis_off()
        for axis, p in zip(axis_row, parameters):
            against = table.values[p["name"]]
            if p["numeric"]:
                against = np.array(against, float)  # NaN where it is not varied
                axis.plot(against, values, "o", ms=4, color=BLUE, alpha=0.7)
                lost = [value for value, state in zip(against, table.state) if state == "failed"]
                if lost:  # nothing at all would upset the layout
                    axis.plot(lost, np.full(len(lost), 0.02), "x", ms=6, color=RED, transform=axis.get_xaxis_transform(), clip_on=False)
                if 1 < len(p.get("choices") or []) <= 8:
                    axis.set_xticks(p["choices"])
                if isinstance(p["base"], (int, float)) and np.nanmin(against) <= p["base"] <= np.nanmax(against):
                    axis.axvline(p["base"], color="0.5", lw=0.9, ls="--")
            else:
                words = words_in_order(p, against)
                axis.plot([words.index(text_of_choice(p, value)) for value in against], values, "o", ms=4, color=BLUE, alpha=0.7)
                if text_of_choice(p, base_choice(p)) in words:
                    axis.axvline(words.index(text_of_choice(p, base_choice(p))), color="0.5", lw=0.9, ls="--")
                axis.set_xticks(range(len(words)), [word if len(word) < 22 else f"...{word[-18:]}" for word in words], rotation=30, ha="right", fontsize=8)
                axis.set_xlim(-0.5, len(words) - 0.5)
            axis.set_xlabel("\n".join(textwrap.wrap(axis_words(p), 26)))
            axis.grid(alpha=0.3)
        axis_row[0].set_ylabel(f"{headline.label} ({headline.display_unit})")
    failed = table.state.count("failed")
    figure.suptitle("members; dashed: the base run's value" + (f"; crosses: the {failed} that failed" if failed else ""), fontsize=10)
    style.save(figure, output)


def draw(table, folder):
    """[(file, caption)] of the pictures that there is enough for."""
    plt = style.pyplot()
    made = []
    if not shown_headlines(table):
        return made
    for name, function, caption, possible in (
            ("exceedance.png", exceedance, "How often a value is exceeded", True),
            ("sensitivity.png", sensitivities, "Which parameter moves it", len(table.parameters) > 1),
            ("profiles.png", profiles, "Along the flow", bool(table.profiles) and bool((table.done & table.draws).any())),
            ("scatter.png", scatter, "Against each parameter", True)):
        if possible:
            function(plt, table, folder / name)
            made.append((name, caption))
    return made
