"""Spec of a sweep: failure probabilities of each bound over the axes, with intervals."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.reporting.charts.figure import spaced_indices
from runner.reporting.document import Curves, Map, Maps, Notice, Panel, ReportBlock, Section, Series, Table, Text
from runner.reporting.markup import literal
from runner.reporting.spec_blocks import RULE, bound_text, interval_text, late_text, probability
from runner.reporting.sweep import maps
from runner.reporting.sweep.subject import Subject, key_label, spans_decades
from runner.schema.bound import Bound
from runner.statistics.spec import bounds_of, merge_histories, settings
from runner.store import Sweep
from runner.store.axes import Axis, group_cells
from runner.store.drawn import draws_nothing

_WIDE = 10.0  # times the lower end: of a probability with a higher upper end not even the magnitude is known
_FEW = "too few repetitions to tell"
_TOLD = (
    f"Repetitions are too few to tell where the upper end of the interval is more than {_WIDE:g} times the lower one: "
    "not even the magnitude of the probability is known. Where no repetition failed, only the upper end counts."
)
_LABEL = "probability of failing"
_MOST_ROWS = 60
_MOST_MULTIPLES = 4
_ALL = "all bounds"


@dataclass(frozen=True)
class Failing:
    """Number of repetitions of each of some cells that do not keep a bound.

    Attributes:
        name: Description of the bound.
        failed: Their number, shape (n,).
        of: Number of repetitions, shape (n,); 0 for cells without the metric.
        exact: True for cells in which nothing is drawn, shape (n,).
    """

    name: str
    failed: NDArray[np.intp]
    of: NDArray[np.intp]
    exact: NDArray[np.bool_]

    @property
    def share(self) -> FloatArray:
        """The fraction of them, shape (n,); NaN for none."""
        return np.where(self.of > 0, self.failed / np.maximum(self.of, 1), np.nan)

    @property
    def ends(self) -> tuple[FloatArray, FloatArray]:
        """The ends of the intervals of the probability, shape (n,) each; NaN for none."""
        from runner.statistics.proportion import share_ends

        low, high = share_ends(self.failed, np.maximum(self.of, 1), self.exact)
        return np.where(self.of > 0, low, np.nan), np.where(self.of > 0, high, np.nan)

    @property
    def few(self) -> NDArray[np.bool_]:
        """True for cells with too few repetitions, shape (n,)."""
        low, high = self.ends
        return high > _WIDE * low

    def pooled(self, members: Sequence[Sequence[int]]) -> "Failing":
        """Return the same of groups of cells, which differ only in their seed."""
        failed, of = (
            np.array([int(counts[list(some)].sum()) for some in members]) for counts in (self.failed, self.of)
        )
        return Failing(self.name, failed, of, np.array([bool(self.exact[list(some)].all()) for some in members]))


def find_failing(subject: Subject, spec: Mapping[str, Bound]) -> list[Failing]:
    """Return the number of repetitions of each cell that fail each bound, or any of several bounds.

    A repetition without a value fails, also where no run of the cell defines one.
    """
    measured = subject.measurements
    values, undefined = measured.values, measured.undefined
    exact = np.zeros(len(measured.hashes), dtype=bool)
    for config, cells in measured.configs:
        exact[cells] = draws_nothing(config)
    shape = (len(measured.hashes), measured.repetitions)
    found, any_failed, all_there = [], np.zeros(shape, dtype=bool), np.ones(shape, dtype=bool)
    for metric, bound in spec.items():
        known = values.get(metric, np.full(shape, np.nan))
        there = ~np.isnan(known) | undefined.get(metric, False)
        failed = there & ~bound.range.holds(known)
        found.append(Failing(bound_text(metric, bound), failed.sum(axis=1), there.sum(axis=1), exact))
        any_failed, all_there = any_failed | failed, all_there & there
    if len(found) > 1:
        found.append(Failing(_ALL, (any_failed & all_there).sum(axis=1), all_there.sum(axis=1), exact))
    return found


def section(subject: Subject, sweep: Sweep) -> Section:
    """Return the section on the spec of a sweep."""
    failing = find_failing(subject, sweep.spec)
    axes = [axis for axis in subject.axes if axis.name != maps.POOLED]
    blocks: list[ReportBlock] = [Text(literal(f"{RULE} {_TOLD}"))]
    late = _late(subject, sweep)
    if late:
        blocks.append(Notice("warning", "Bounds that were set after the result was known", literal(late)))
    for one in failing:
        if not one.of.any():
            blocks.append(Text(literal(f"No run of the sweep has the metric of the bound: {one.name}.")))
        elif len(axes) == 1:
            blocks.append(_curve(one, axes[0]))
        elif maps.is_readable(subject):
            blocks.append(_maps(subject, one))
    return Section("Spec", [*blocks, _table(subject, failing)])


def summary(subject: Subject, sweep: Sweep) -> str:
    """Return the number of cells that keep the whole spec in every repetition, and the bounds that were set late."""
    whole = find_failing(subject, sweep.spec)[-1]
    kept = int(np.count_nonzero((whole.failed == 0) & (whole.of > 0)))
    return f"{kept} of {len(whole.of)} cells keep the spec in every repetition.{_late(subject, sweep)}"


def _late(subject: Subject, sweep: Sweep) -> str:
    """Return in sentences which bounds were set after the result of some cells was known."""
    texts: Counter[str] = Counter()
    for config, cells in subject.measurements.configs:
        history = merge_histories(settings({**dict.fromkeys(sweep.spec), **bounds_of(config)}, ""), sweep.history)
        for metric, bound in sweep.spec.items():
            late = late_text(metric, bound, history[metric])
            texts.update({bound_text(metric, bound) + late: len(cells)} if late else {})
    cells_in_all = len(subject.measurements.hashes)
    return "".join(f" {text}: {count} of {cells_in_all} cells." for text, count in texts.items())


def _curve(one: Failing, axis: Axis) -> Curves:
    """Return the probability over one axis, with its interval as a band."""
    members = [np.flatnonzero(axis.level == level).tolist() for level in range(len(axis.values))]
    pooled = one.pooled(members)
    low, high = pooled.ends
    numbers = axis.numbers
    x = np.arange(len(members), dtype=float) if numbers is None else numbers
    few = pooled.few
    series = [Series("share that failed, with the 95 % interval", x, pooled.share, "points_line", low, high)]
    if few.any():
        series.append(Series(_FEW, x[few], pooled.share[few], "points"))
    panel = Panel(
        "",
        key_label(axis),
        _LABEL,
        series,
        numbers is not None and spans_decades(numbers),
        spans_decades(pooled.share) and not few.any(),
        x_names=axis.texts if numbers is None else (),
    )
    return Curves(literal(f"Probability of failing over {axis.name}: {one.name}."), [panel], columns=1)


def _maps(subject: Subject, one: Failing) -> Maps:
    """Return maps of the share that failed and of the upper end of the interval, a row for each value of more axes."""
    x, y, *others = maps.choose_axes(subject)
    combinations = maps.named_groups(others, len(one.of))
    shown = [combinations[place] for place in spaced_indices(len(combinations), _MOST_MULTIPLES)]
    panels: list[Map] = []
    for name, cells in shown:
        panels += _row(one, x, y, cells, f"{name}: " if name else "")
    values = np.concatenate([panel.values.ravel() for panel in panels])
    log = spans_decades(values[values > 0])
    texts = [f"Probability of failing: {one.name}."]
    if any(panel.failed.any() for panel in panels):
        texts.append(f"A cross marks {_FEW}.")
    if log and (values == 0).any():
        texts.append("Cells without a colour are 0.")
    if len(shown) < len(combinations):
        texts.append(f"{len(shown)} of {len(combinations)} values of the other axes, evenly chosen.")
    return Maps(literal(" ".join(texts)), _LABEL, panels, log, columns=2)


def _row(one: Failing, x: Axis, y: Axis, cells: NDArray[np.intp], start: str) -> list[Map]:
    shape = (len(y.values), len(x.values))
    places = y.level[cells] * shape[1] + x.level[cells]
    pooled = one.pooled([cells[places == place].tolist() for place in range(shape[0] * shape[1])])
    _, high = pooled.ends
    few = pooled.few.reshape(shape)
    hints = [
        f"{y.name}={y.text(place // shape[1])}, {x.name}={x.text(place % shape[1])}: {text}"
        for place, text in enumerate(_texts(pooled))
    ]
    unmarked = np.zeros(shape, dtype=bool)
    drawn = (("share that failed", pooled.share, few), ("upper end of the 95 % interval", high, unmarked))
    names = (key_label(x), key_label(y), x.texts, y.texts)
    return [Map(start + title, *names, values.reshape(shape), marks, hints=hints) for title, values, marks in drawn]


def _texts(failing: Failing) -> list[str]:
    from runner.statistics.proportion import Share

    columns = zip(failing.failed, failing.of, *failing.ends, failing.few, strict=True)
    return [
        f"{failed} of {of} failed, {probability(failed / of)} ({interval_text(Share(failed, of, low, high))})"
        + ("; too few" if few else "")
        if of
        else "no such metric"
        for failed, of, low, high, few in columns
    ]


def _table(subject: Subject, failing: Sequence[Failing]) -> Table:
    """Return each cell with the probability of failing each bound, those that fail most often first.

    Cells that differ only in the seed are counted together.
    """
    axes = [axis for axis in subject.axes if axis.name != maps.POOLED]
    groups = [cells.tolist() for _, cells in group_cells(axes, np.arange(len(failing[-1].of)))]
    pooled = [one.pooled(groups) for one in failing]
    order = np.argsort(-np.nan_to_num(pooled[-1].share), kind="stable")
    shown = [int(order[place]) for place in spaced_indices(len(order), _MOST_ROWS)]
    texts = [_texts(one) for one in pooled]
    names = [subject.cell_name(cells[0], axes) or "all seeds" for cells in groups]
    rows = [[names[place], *(own[place] for own in texts)] for place in shown]
    caption = "Repetitions that failed, with the probability of failing and its 95 % interval."
    if len(axes) < len(subject.axes):
        caption += " Cells that differ only in the seed are counted together."
    if len(shown) < len(order):
        caption += f" {len(shown)} of {len(order)} cells, evenly chosen by how often they fail."
    return Table(caption, ["cell", *(one.name for one in failing)], rows)
