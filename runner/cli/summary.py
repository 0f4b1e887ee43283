"""Summary of a finished run or sweep: folder on standard output, everything else on standard error."""

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from runner.base.sanitize import align_columns, one_line
from runner.config.compose.user_settings import outputs_dir
from runner.store.kinds import WORD

if TYPE_CHECKING:
    from runner.store import Run
    from runner.sweeps.measurements import Axis
    from runner.sweeps.run import Ended

_METRICS = 5
_NAMES = (("robot", "name"), ("controller", "kind"), ("trajectory", "kind"))
_FAILURES_SHOWN = 20
_MOST_RANKED = 200  # cells; to read so many takes half a second


def print_run(run: "Run", made: bool, thresholds: Any) -> int:
    """Print the summary of a run; return its exit code.

    Args:
        run: The run.
        made: Whether this command simulated it.
        thresholds: Thresholds of the caveats in the command's config.
    """
    if not run.failure:
        _print_metrics(run, made)
    _print_spec(run)
    for warning in run.provenance["warnings"]:
        print(one_line(f"runner: warning: {warning}"), file=sys.stderr)
    _print_caveats(run, thresholds)
    if run.failure:
        print(one_line(f"runner: {run.failure}"), file=sys.stderr)
    print(run.folder)
    return 1 if run.failure else 0


def _print_metrics(run: "Run", made: bool) -> None:
    """Print the names of a run's parts, its folder, and its main metrics."""
    from runner.reporting.key_metrics import key_metrics

    config, count = run.config, run.record["repetitions"]
    what = ", ".join(str(config[group][key]) for group, key in _NAMES)
    where = f"{'stored' if made else 'stored before'} in {run.folder}"
    repetitions = "1 repetition" if count == 1 else f"{count} repetitions"
    print(one_line(f"runner: {what}: {repetitions}, {where}"), file=sys.stderr)
    rows = [[metric.title, metric.value, metric.remark] for metric in key_metrics(run, _METRICS)]
    if rows:
        print(align_columns(rows), file=sys.stderr)


def _print_spec(run: "Run") -> None:
    """Print the fraction of repetitions that pass each bound of a run's spec, if it has one."""
    if run.spec is None:
        return
    from runner.reporting.spec_blocks import HEADER, lacking_text, spec_rows

    print(align_columns([HEADER, *spec_rows(run.spec)]), file=sys.stderr)
    lacking = lacking_text(run.spec, run.metrics)
    if lacking:
        print(one_line(f"runner: {lacking}"), file=sys.stderr)


def _print_caveats(run: "Run", thresholds: Any) -> None:
    """Print the caveats of a run, and the thresholds that differ from those of the command's config."""
    from runner.metrics.caveats import changes_since

    for caveat in run.caveats:
        print(one_line(f"runner: caveat: {caveat['rule']}: {caveat['text']}"), file=sys.stderr)
    changes = changes_since(run.caveat_rules, thresholds)
    if changes:
        print(one_line(f"runner: stored before; its caveats were looked for by {'; '.join(changes)}"), file=sys.stderr)


def print_sweep(ended: "Ended") -> int:
    """Print the summary of a sweep; return its exit code."""
    from runner.store import open_sweep
    from runner.sweeps.differing import in_words
    from runner.sweeps.measurements import axes_of

    if ended.failures:
        rows = [[" ".join(overrides), why, str(where)] for overrides, why, where in ended.failures[:_FAILURES_SHOWN]]
        count = len(ended.failures)
        print(f"runner: {count} run{'s' if count > 1 else ''} failed", file=sys.stderr)
        print(align_columns([["run", "why", "more in"], *rows]), file=sys.stderr)
        if len(ended.failures) > len(rows):
            print(f"  and {len(ended.failures) - len(rows)} more", file=sys.stderr)
    counts = ended.ends.caveats
    if counts.any():
        text = f"{(counts > 0).sum()} of {len(counts)} cells have caveats, {counts.max()} at most"
        print(f"runner: {text}; `runner table {ended.folder}` says which", file=sys.stderr)
    if ended.left:
        print(f"runner: stopped at a failure; left: {ended.left}", file=sys.stderr)
    axes, _ = axes_of(open_sweep(ended.folder).overrides)
    also = in_words(ended.resolved.differences(axes))
    if also:
        print(one_line(f"runner: {also}; the report lists their values"), file=sys.stderr)
    _print_cells(ended, axes)
    print(ended.folder)
    return 1 if ended.failures else 0


def _print_cells(ended: "Ended", axes: "Sequence[Axis]") -> None:
    """Print the numbers of runs, the answer of the sweep, and the next commands."""
    from runner import store
    from runner.reporting.sweep.question import in_short
    from runner.reporting.sweep.subject import choose
    from runner.sweeps.finer_step import work_out_sweep
    from runner.sweeps.measurements import measure_sweep

    made, failed = len(ended.ends) - ended.stored, len(ended.failures)
    runs = "1 run" if len(ended.ends) == 1 else f"{len(ended.ends)} runs"
    text = f"{runs}: {made} made, {ended.stored} stored before, {failed or 'none'} of them failed"
    answer, spec = "", ""
    if len(ended.names) <= _MOST_RANKED and not (ended.left or failed == len(ended.names)):
        sweep = store.open_sweep(ended.folder)
        work_out_sweep(sweep)
        subject = choose(measure_sweep(sweep))
        answer = in_short(subject)
        if sweep.spec:
            from runner.reporting.sweep.spec import summary  # imports charts, which takes long

            spec = summary(subject, sweep)
    for line in filter(None, (text, answer, spec)):
        print(one_line(f"runner: {line}"), file=sys.stderr)
    here = ended.outputs.resolve() == outputs_dir().resolve()
    name = WORD if here else str(ended.folder)
    compared = next((axis.name for axis in axes if axis.name != "seed"), None)
    compare = f", `runner compare {name} --by {compared}`" if compared else ""
    print(one_line(f"runner: next: `runner report {name}`, `runner table {name}`{compare}"), file=sys.stderr)
