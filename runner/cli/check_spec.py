"""Spec check for `runner check DIR`: bounds, failed repetitions and failure probability."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from runner.base.errors import RunnerError
from runner.base.sanitize import one_line
from runner.cli.columns import align_columns

if TYPE_CHECKING:
    from runner.statistics.proportion import Share
    from runner.statistics.spec import Kept
    from runner.store import Run

_DIGITS = 3  # of how many more repetitions would do
_SAYS = {"kept": "good", "broken": "broken", "untold": "too few repetitions to tell"}


def check_spec(runs: "Sequence[Run]", cells: Sequence[str], at_most: float | None) -> int:
    """Print a line for each bound of some runs; return 1 where one is broken, or this cannot be told.

    Args:
        runs: The runs, with the same spec.
        cells: What tells each from the others; none for one run.
        at_most: The largest probability of failing that is allowed; None where no repetition may fail.

    Raises:
        RunnerError: for a run that lacks a metric of its spec.
    """
    from runner.reporting.spec_blocks import HEADER

    rows, good = [], []
    for run, named in zip(runs, [[cell] for cell in cells] or [[]], strict=True):
        for said, *row in _rows(run, at_most):
            rows.append([*named, *row])
            good.append(said == "kept")
    print(align_columns([[*(["cell"] if cells else []), *HEADER, "verdict"], *rows]))
    count = f"{len(good)} bound{'s' if len(good) > 1 else ''}" + (f" of {len(runs)} runs" if len(runs) > 1 else "")
    good_text, bad_text = ("kept in every repetition", "broken") if at_most is None else (
        f"each failing with a probability below {at_most:g}", f"not shown to fail with a probability below {at_most:g}"
    )  # fmt: skip
    print(f"good: {count}, {good_text}" if all(good) else f"{bad_text}: {good.count(False)} of {count}")
    return 0 if all(good) else 1


def _rows(run: "Run", at_most: float | None) -> Iterator[list[str]]:
    """Yield for each bound what is said of it, and its row."""
    from runner.reporting.spec_blocks import lacking_text, spec_rows

    if run.spec is None:
        raise RunnerError(f"{run.folder}: has no spec, which the others have; run it again with theirs")
    if run.spec.lacking:
        raise RunnerError(f"{run.folder}: {lacking_text(run.spec, run.metrics)}")
    for one, row in zip(run.spec.bounds, spec_rows(run.spec), strict=False):
        yield _judged(one, row, at_most)


def _judged(one: "Kept", row: Sequence[str], at_most: float | None) -> list[str]:
    from runner.statistics.spec.kept import judge_share

    assert one.share is not None  # noqa: S101 - `_rows` refuses runs that lack a metric
    verdict = judge_share(one.share, at_most)
    text = _SAYS[verdict.says]
    if verdict.says == "untold":
        text += f": {_more(verdict.needed, one.share)}"
    reason = f" ({one.bound.reason})" if one.bound.reason and verdict.says != "kept" else ""
    return [verdict.says, *row, one_line(text + reason)]


def _more(needed: int | None, share: "Share") -> str:
    """Return how many more repetitions would tell."""
    if needed is None:
        return "the share is at the limit itself"
    lasting = "if none failed" if share.kept == share.of else "if the share stayed"
    more = needed - share.of
    unit = 10 ** max(0, len(str(more)) - _DIGITS)
    return f"some {-(-more // unit) * unit} more would do {lasting}"
