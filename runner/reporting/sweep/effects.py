"""Effects of the axes: fractions of the variance with permutation tests, and main effects."""

import numpy as np

from runner.base.quantities import label_with_unit, number
from runner.reporting.charts.thinning import spaced_indices
from runner.reporting.document import Block, Curves, Panel, Section, Series, Table, Text
from runner.reporting.markup import literal, literals
from runner.reporting.metric_titles import title
from runner.reporting.sweep.intervals import at_texts, axis_panel, cells_with_intervals, places
from runner.reporting.sweep.subject import MOST_GROUPS, QUANTILE_RULE, Subject
from runner.statistics import PERMUTATIONS, EffectAnalysis
from runner.sweeps.measurements import Axis

_MOST_LEVELS = 200  # of an axis that are drawn, spread evenly


def section(subject: Subject) -> Section:
    """Return what each axis does to each metric."""
    blocks: list[Block] = [_table(subject.effects), Text(_explained(subject.effects)), *_main_effects(subject)]
    many = [axis.name for axis in subject.axes if len(axis.values) > MOST_GROUPS]
    if many:
        blocks.insert(2, Text(literal(f"{', '.join(many)}: taken in {MOST_GROUPS} groups of neighbouring values.")))
    if len(subject.axes) <= 2:
        blocks += [
            figure for figure in (cells_with_intervals(subject, metric) for metric in subject.metrics[:2]) if figure
        ]
    return Section("Effects of the axes", blocks)


def describe_shared_variation(subject: Subject) -> list[str]:
    """Return in a sentence which share of the variation of the first metric the draws of the repetitions make."""
    metric = subject.metrics[0]
    found = subject.effects[metric].shared
    if found is None:
        return []
    drawn = f"{_percent(found)} of the variation of the {title(metric)} lies between the repetitions"
    return [f"{drawn}: all cells share what is drawn for one."]


def _table(analyses: dict[str, EffectAnalysis]) -> Table:
    rows = []
    for effects in zip(*(analysis.effects for analysis in analyses.values()), strict=True):
        cells = []
        for effect in effects:
            tested = effect.remark if effect.p_value is None else f"p = {effect.p_value:.2g}"
            cells.append(f"{_percent(effect.share)} ({tested})")
        rows.append([" × ".join(effects[0].axes), *cells])
    header = ["effect", *map(title, analyses)]
    return Table(
        "Share of the variation that each axis explains, and what two axes do together beyond what each does by "
        "itself.",
        literals(header),
        [literals(row) for row in rows],
    )


def _explained(analyses: dict[str, EffectAnalysis]) -> str:
    logs = [title(name) for name, analysis in analyses.items() if analysis.logarithmic]
    lost = [f"{analysis.left_out} of {title(name)}" for name, analysis in analyses.items() if analysis.left_out]
    used = ", ".join(dict.fromkeys(str(analysis.n) for analysis in analyses.values()))
    shared = [
        f"{_percent(analysis.shared)} of the variation of {title(name)}"
        for name, analysis in analyses.items()
        if analysis.shared is not None
    ]
    tests = sum(effect.p_value is not None for analysis in analyses.values() for effect in analysis.effects)
    texts = [
        f"A share is the sum of squares of an effect over the total; p is the share of {PERMUTATIONS} permutations of "
        f"the residuals, and the order found, with as large an effect. Values used: n = {used}.",
        f"Of {', '.join(logs)} the logarithms were taken, as the values span decades." if logs else "",
        f"Left out, as beyond every number: {', '.join(lost)}; shares of what is left may overlap." if lost else "",
        f"Cells of one seed share the random draws of a repetition, which make {', '.join(shared)}. This is no scatter "
        "between cells: the test takes it out first, and permutes within a repetition only."
        if shared
        else "",
        _on_chance(tests) if tests else "",
    ]
    return literal(" ".join(text for text in texts if text))


def _on_chance(tests: int) -> str:
    """Return what so many tests find by chance, and under which condition."""
    count = "One test stands here" if tests == 1 else f"{tests} tests stand here"
    return (
        "Where an axis has no effect and the values scatter alike at all of its levels, p falls below 0.05 in one test "
        f"in twenty. {count}. Where they scatter more at some levels than at others, p is too small too often."
    )


def _main_effects(subject: Subject) -> list[Curves]:
    """Return a figure for each metric, with a panel for each axis."""
    told = (
        ": median of all repetitions at each value of an axis, over the values of the others; shaded, or a bar, the "
        f"half of them between the quartiles. {QUANTILE_RULE} No point stands where half of the runs or more failed."
    )
    figures: list[Curves] = []
    for metric in subject.metrics[:3]:
        panels = [_main_effect(subject, metric, axis) for axis in subject.axes]
        name = title(metric)
        caption = literal(f"{name[0].upper()}{name[1:]} and each axis{'.' if figures else told}")
        figures.append(Curves(caption, panels, columns=len(panels) if len(panels) <= 4 else 3))
    return figures


def _main_effect(subject: Subject, metric: str, axis: Axis) -> Panel:
    values = subject.measurements.values[metric]
    shown = spaced_indices(len(axis.values), _MOST_LEVELS)
    quartiles = np.full((3, len(shown)), np.nan)
    for place, level in enumerate(shown):
        pooled = values[axis.level == level]
        pooled = pooled[~np.isnan(pooled)]
        if pooled.size:
            low, high = np.quantile(pooled, (0.25, 0.75), method="inverted_cdf")
            quartiles[:, place] = low, np.median(pooled), high  # the median as in all tables
    quartiles[~np.isfinite(quartiles)] = np.nan
    x = places(axis)[shown]
    low, median, high = quartiles
    series = [Series("", x, median, "points_line", low, high, color=0)]
    if axis.numbers is None:
        series = at_texts(series[0])
    unit = subject.measurements.units[metric]
    return axis_panel("", axis, label_with_unit("median", unit), series, quartiles)


def _percent(share: float) -> str:
    return f"{number(100 * share, 2)} %" if share >= 1e-3 else "< 0.1 %"
