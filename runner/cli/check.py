"""Compare the metrics of a run or a sweep with a spec or a baseline.

Without a baseline, the spec of the run is compared, and no repetition may break a bound. With
`--max-failure-probability` the whole 95 % interval of the probability of failing must be below P. `--save-baseline`
writes the baseline of a sweep, and `--baseline` then lists the changes. If FILE has bands, `--save-baseline` sets their
ends from a sweep over the seed. Exit code 1: the check failed.

Example: runner check latest --baseline baseline.yaml --format markdown
"""

import argparse
import math
from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from typing import TYPE_CHECKING

from runner.base.errors import RunnerError
from runner.base.quantities import plain_number
from runner.base.sanitize import one_line
from runner.cli.arguments import NameList, Parser, StoredFolder
from runner.reporting.table import Cell, Number, Table, numbers, terminal
from runner.sweeps.challenge.question import CLASSES

if TYPE_CHECKING:
    from runner.statistics.proportion import Share
    from runner.statistics.spec import Kept
    from runner.store import Run, Sweep
    from runner.store.baselines import BandResult, Bands
    from runner.store.cells import Move, SweepBaseline

_MOVE_COLUMNS = ("cell", "metric", *numbers("was", "is", "moved"), "beyond the seeds' spread")
_DIGITS = 3  # significant digits of the number of repetitions that are still needed
_SAYS = {"kept": "good", "broken": "broken", "untold": "too few repetitions to tell"}


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    stored = StoredFolder("run", "sweep", "tuning", "challenge")
    parser.add_argument("folder", type=stored, metavar="DIR", help="a run, sweep or challenge; or latest")
    parser.add_shared(
        baseline="bands or a saved sweep (default: the spec, or the experiment's)",
        save_baseline="write a baseline, or set the bands in FILE",
    )
    parser.add_argument(
        "--max-failure-probability",
        type=_probability,
        metavar="P",
        help="highest probability that a repetition fails",
    )
    parser.add_argument(
        "--require-scope",
        type=NameList(list(CLASSES)),
        metavar="A,B",
        help="challenge: classes that it must hold for",
    )
    parser.add_formats(("text", "markdown"), "text or markdown (default: text)", most=1)


def run(options: argparse.Namespace) -> int:
    """Check a run or sweep against a baseline, or save one."""
    markdown = options.format == ["markdown"]
    from runner import store
    from runner.store.baselines import Bands, load_baseline, renew_bands
    from runner.store.cells import cell_names, save_baseline
    from runner.store.kinds import kind_of
    from runner.sweeps.rounding import RoundingSensitivity, find_sensitive
    from runner.sweeps.status import report_if_running

    if options.require_scope is not None or kind_of(options.folder) == "challenge":
        return _check_scope(options)
    if options.save_baseline:
        if options.baseline or options.max_failure_probability is not None or options.format:
            others = "--baseline, --max-failure-probability or --format"
            options.parser.error(f"--save-baseline compares nothing: not with {others}")
        path, sweep = options.save_baseline, store.open_sweep(options.folder)
        before = load_baseline(path) if path.exists() else None
        bands = before if isinstance(before, Bands) else None
        found = RoundingSensitivity() if bands else find_sensitive(sweep)
        count = renew_bands(bands, list(sweep.runs()), path) if bands else save_baseline(sweep, path, found.changes)
        print(f"saved: {count} metric{'s' if count > 1 else ''} of {options.folder} in {path}{found.in_words()}")
        return 0
    baseline = load_baseline(options.baseline) if options.baseline else None
    if not (baseline is None or isinstance(baseline, Bands)):
        return _check_sweep(store.open_sweep(options.folder), baseline, markdown)
    if markdown:
        options.parser.error("--format markdown: only for the baseline of a sweep. Add --baseline FILE.")
    with report_if_running(store.open_sweep(options.folder)) if kind_of(options.folder) != "run" else nullcontext():
        runs = store.open_runs(options.folder)
    judged = options.baseline is None and runs[0].spec is not None
    if options.max_failure_probability is not None and not judged:
        options.parser.error(
            "--max-failure-probability needs a run with a spec, as by spec.metrics.settling_time.max=1.6, "
            "and no --baseline"
        )
    if judged:
        cells = [] if kind_of(options.folder) == "run" else cell_names(store.open_sweep(options.folder))
        return _check_spec(runs, cells, options.max_failure_probability)
    return _check_bands(runs, baseline)


def _check_scope(options: argparse.Namespace) -> int:
    """Print what turns the answer of a challenge in some classes, or is not known; return 1 if there is anything."""
    from runner.reporting.challenge.page import turns_answer
    from runner.store.kinds import kind_of
    from runner.sweeps.challenge.stored import open_challenge

    if kind_of(options.folder) != "challenge":
        options.parser.error("--require-scope: not a challenge. `runner challenge RESULT` makes one.")
    if not options.require_scope or options.baseline or options.save_baseline or options.format:
        options.parser.error("a challenge is checked only with --require-scope A,B.")
    reasons = turns_answer(open_challenge(options.folder), options.require_scope)
    named = ", ".join(options.require_scope)
    for text in reasons:
        print(one_line(text))
    print(f"not shown to hold for {named}: {len(reasons)}" if reasons else f"good: the answer holds for {named}")
    return 1 if reasons else 0


def _probability(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < 1.0:
        raise argparse.ArgumentTypeError(f"not a probability ('{text}'). Allowed: a number above 0 and below 1.")
    return value


def _check_sweep(sweep: "Sweep", baseline: "SweepBaseline", markdown: bool) -> int:
    """Print the changes since a sweep's baseline was saved; return 1 if one of them fails the check."""
    from runner.reporting.export.columns import write_markdown
    from runner.store.cells import BROKEN, SENSITIVE, check_sweep

    found = check_sweep(sweep, baseline)
    moves, beyond = found.moves, sum(move.beyond for move in found.moves)
    summary = (
        f"{baseline.size} metrics of {len(baseline.cells)} cells: {len(moves)} moved, {beyond} beyond the seeds' spread"
    )
    for remark in (SENSITIVE, BROKEN):
        count = sum(move.remark == remark for move in moves)
        summary += f", {count} {remark}" if count else ""
    table = Table("", _MOVE_COLUMNS, list(map(_move_row, moves)))
    if markdown:
        print("\n".join([f"**{summary}**", *(["", write_markdown(table)] if moves else [])]))
    else:
        print("\n".join([summary, terminal(table)]) if moves else f"good: {summary}")
    for note in found.notes:
        print(f"\n{one_line(note)}" if markdown else one_line(note))
    return 1 if any(move.fails for move in moves) else 0


def _move_row(move: "Move") -> list[str]:
    beyond = f"{'yes' if move.beyond else 'no'}{', ' if move.remark else ''}{move.remark}"
    if not move.metric:
        return [move.cell, "(all)", "", "", move.event, beyond]
    was, unit = "-", ""
    if move.was is not None:
        unit = "" if move.was.unit == "1" else f" {move.was.unit}"
        ends = (move.was.min, move.was.max) if move.was.seeds > 1 else ()
        was = Number(move.was.median, *ends).text(plain_number)
    return [move.cell, move.metric, was + unit, plain_number(move.value) + unit, _direction(move), beyond]


def _direction(move: "Move") -> str:
    """Return the direction and the relative size of a change; a missing value counts as beyond every number."""
    old, new = None if move.was is None else move.was.median, move.value
    if old is None or new is None:
        return "new" if move.was is None else "up" if new is None else "down"
    share = f" {100.0 * abs(new - old) / abs(old):.2g} %" if old else ""
    return ("up" if new > old else "down") + share


def _check_bands(runs: "Sequence[Run]", given: "Bands | None") -> int:
    """Check the medians of all runs; print one line if all are in their bands, otherwise a table of the others."""
    from runner.store.baselines import check_run, find_shipped

    pairs = [(run, given or find_shipped(run)) for run in runs]
    results = [(run, baseline, check_run(run, baseline)) for run, baseline in pairs]
    short = [result for result in results if not all(finding.good for finding in result[2])]
    if short:
        print("\n\n".join(_report(*result) for result in short))
        return 1
    names = ", ".join(dict.fromkeys(baseline.name for _, baseline in pairs))
    count = sum(len(findings) for _, _, findings in results)
    print(f"good: {count} metrics of {len(runs)} {'run' if len(runs) == 1 else 'runs'} lie in the bands of {names}")
    return 0


def _report(run: "Run", baseline: "Bands", findings: "Sequence[BandResult]") -> str:
    wrong = [finding for finding in findings if not finding.good]
    head = f"{run.folder}: {len(wrong)} of {len(findings)} metrics fall short of {baseline.name}"
    rows: list[list[Cell]] = [
        [f.metric, Number(f.value), f.band.range.text(plain_number), f.band.reason] for f in wrong
    ]
    failure = [f"  {run.failure}"] if run.failure else []
    return "\n".join([head, *failure, terminal(Table("", ["metric", *numbers("found", "band"), "reason"], rows))])


def _check_spec(runs: "Sequence[Run]", cells: Sequence[str], at_most: float | None) -> int:
    """Print a line for each bound of some runs; return 1 if one is broken or there are too few repetitions."""
    from runner.reporting.spec_blocks import COLUMNS

    rows, good = [], []
    for run, named in zip(runs, [[cell] for cell in cells] or [[]], strict=True):
        for said, *row in _rows(run, at_most):
            rows.append([*named, *row])
            good.append(said == "kept")
    print(terminal(Table("", [*(["cell"] if cells else []), *COLUMNS, "verdict"], rows)))
    count = f"{len(good)} bound{'s' if len(good) > 1 else ''}" + (f" of {len(runs)} runs" if len(runs) > 1 else "")
    good_text, bad_text = ("kept in every repetition", "broken") if at_most is None else (
        f"each failing with a probability below {at_most:g}", f"not shown to fail with a probability below {at_most:g}"
    )  # fmt: skip
    print(f"good: {count}, {good_text}" if all(good) else f"{bad_text}: {good.count(False)} of {count}")
    return 0 if all(good) else 1


def _rows(run: "Run", at_most: float | None) -> Iterator[list[str]]:
    """Yield a row for each bound, with its verdict first."""
    from runner.reporting.spec_blocks import lacking_text, spec_rows, without_value

    if run.spec is None:
        raise RunnerError(f"{run.folder}: has no spec, but the others have one; run it again with theirs")
    if run.spec.lacking:
        raise RunnerError(f"{run.folder}: {lacking_text(run.spec, run.metrics)}")
    for one, row in zip(run.spec.bounds, spec_rows(run.spec), strict=False):
        yield _judged(one, row, at_most, without_value(run, one.metric))


def _judged(one: "Kept", row: Sequence[str], at_most: float | None, without: str) -> list[str]:
    from runner.statistics.spec import judge_share

    assert one.share is not None  # noqa: S101 - `_rows` rejects runs that lack a metric
    verdict = judge_share(one.share, at_most)
    text = _SAYS[verdict.says]
    if verdict.says == "untold":
        text += f": {_more(verdict.needed, one.share)}"
    if without:
        text += f": {without}"
    reason = f" ({one.bound.reason})" if one.bound.reason and verdict.says != "kept" else ""
    return [verdict.says, *row, one_line(text + reason)]


def _more(needed: int | None, share: "Share") -> str:
    """Return a sentence with the number of repetitions that are still needed."""
    if needed is None:
        return "the share is at the limit itself"
    lasting = "if none failed" if share.kept == share.of else "if the share stayed"
    more = needed - share.of
    unit = 10 ** max(0, len(str(more)) - _DIGITS)
    return f"some {-(-more // unit) * unit} more would do {lasting}"
