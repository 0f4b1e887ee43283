"""Summary of a finished run or sweep: folder on standard output, everything else on standard error."""

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from runner.base.sanitize import one_line
from runner.config.compose.user_settings import outputs_dir
from runner.store.latest import WORD

if TYPE_CHECKING:
    from runner.store import Run
    from runner.sweeps.measurements import Axis
    from runner.sweeps.run import Ended

_METRICS = 5
_NAMES = (("robot", "name"), ("controller", "kind"), ("trajectory", "kind"))
_FAILURES_SHOWN = 20
_MOST_RANKED = 200  # cells; to read so many takes half a second


def tell_run(run: "Run", made: bool, thresholds: Any) -> int:
    """Tell of a run; return its exit code.

    Args:
        run: The run.
        made: Whether it was made by this command, and not found stored.
        thresholds: Thresholds of the caveats that were asked for.
    """
    if not run.failure:
        _tell_metrics(run, made)
    _tell_spec(run)
    for warning in run.provenance["warnings"]:
        print(one_line(f"runner: warning: {warning}"), file=sys.stderr)
    _tell_caveats(run, thresholds)
    if run.failure:
        print(one_line(f"runner: {run.failure_text}"), file=sys.stderr)
    print(run.folder)
    return 1 if run.failure else 0


def _tell_metrics(run: "Run", made: bool) -> None:
    """Print what was run, where it is, and the metrics that say most of it."""
    from runner.cli.columns import align_columns
    from runner.reporting.key_metrics import key_metrics

    config, count = run.config, run.record["repetitions"]
    what = ", ".join(str(config[group][key]) for group, key in _NAMES)
    where = f"{'stored' if made else 'stored before'} in {run.folder}"
    repetitions = "1 repetition" if count == 1 else f"{count} repetitions"
    print(one_line(f"runner: {what}: {repetitions}, {where}"), file=sys.stderr)
    rows = [[metric.title, metric.value, metric.remark] for metric in key_metrics(run, _METRICS)]
    if rows:
        print(align_columns(rows), file=sys.stderr)


def _tell_spec(run: "Run") -> None:
    """Print how often the bounds of a run's spec are kept, where it has any."""
    if run.spec is None:
        return
    from runner.cli.columns import align_columns
    from runner.reporting.spec_blocks import HEADER, lacking_text, spec_rows

    print(align_columns([HEADER, *spec_rows(run.spec)]), file=sys.stderr)
    lacking = lacking_text(run.spec, run.metrics)
    if lacking:
        print(one_line(f"runner: {lacking}"), file=sys.stderr)


def _tell_caveats(run: "Run", thresholds: Any) -> None:
    """Print why a run's result may mislead, and where other thresholds than those asked for were used."""
    from runner.metrics.caveats import changes_since

    for caveat in run.caveats:
        print(one_line(f"runner: caveat: {caveat['rule']}: {caveat['text']}"), file=sys.stderr)
    changes = changes_since(run.caveat_rules, thresholds)
    if changes:
        print(one_line(f"runner: stored before; its caveats were looked for by {'; '.join(changes)}"), file=sys.stderr)


def tell_sweep(ended: "Ended") -> int:
    """Tell of a sweep; return its exit code."""
    if ended.failures:
        from runner.cli.columns import align_columns

        rows = [[" ".join(overrides), why, str(where)] for overrides, why, where in ended.failures[:_FAILURES_SHOWN]]
        count = len(ended.failures)
        print(f"runner: {count} run{'s' if count > 1 else ''} failed", file=sys.stderr)
        print(align_columns([["run", "why", "more in"], *rows]), file=sys.stderr)
        if len(ended.failures) > len(rows):
            print(f"  and {len(ended.failures) - len(rows)} more", file=sys.stderr)
    counts = ended.ends.caveats
    if counts.any():
        told = f"{(counts > 0).sum()} of {len(counts)} cells have caveats, {counts.max()} at most"
        print(f"runner: {told}; `runner table {ended.folder}` says which", file=sys.stderr)
    if ended.left:
        print(f"runner: stopped at a failure; left: {ended.left}", file=sys.stderr)
    _tell_differences(ended)
    _tell_cells(ended)
    print(ended.folder)
    return 1 if ended.failures else 0


def _tell_cells(ended: "Ended") -> None:
    """Print how many runs were made, what may be said of them, and what may be typed next."""
    from runner import store
    from runner.reporting.sweep.question import in_short
    from runner.reporting.sweep.subject import choose
    from runner.sweeps.finer_step import work_out_sweep
    from runner.sweeps.measurements import measure_sweep

    made, failed = len(ended.ends) - ended.stored, len(ended.failures)
    runs = "1 run" if len(ended.ends) == 1 else f"{len(ended.ends)} runs"
    text = f"{runs}: {made} made, {ended.stored} stored before, {failed or 'none'} of them failed"
    told, kept = "", ""
    if len(ended.names) <= _MOST_RANKED and not (ended.left or failed == len(ended.names)):
        sweep = store.open_sweep(ended.folder)
        work_out_sweep(sweep)
        subject = choose(measure_sweep(sweep))
        told = in_short(subject)
        if sweep.spec:
            from runner.reporting.sweep.spec import summary  # imports what draws, which takes long

            kept = summary(subject, sweep)
    for line in filter(None, (text, told, kept)):
        print(one_line(f"runner: {line}"), file=sys.stderr)
    here = ended.outputs.resolve() == outputs_dir().resolve()
    name = WORD if here else str(ended.folder)
    compared = next((axis.name for axis in _axes(ended) if axis.name != "seed"), None)
    compare = f", `runner compare {name} --by {compared}`" if compared else ""
    print(one_line(f"runner: next: `runner report {name}`, `runner table {name}`{compare}"), file=sys.stderr)


def _tell_differences(ended: "Ended") -> None:
    """Say in a line that cells differ beyond what was swept, where they do."""
    from runner.sweeps.differing import in_words

    also = in_words(ended.resolved.differences(_axes(ended)))
    if also:
        print(one_line(f"runner: {also}; the report lists their values"), file=sys.stderr)


def _axes(ended: "Ended") -> "Sequence[Axis]":
    """Return what was swept."""
    from runner.store import open_sweep
    from runner.sweeps.measurements import axes_of

    axes, _ = axes_of(open_sweep(ended.folder).overrides)
    return axes
