"""Evaluation of a stored run with another spec."""

import sys
from collections.abc import Mapping

from runner.config.spec import Bound
from runner.statistics.spec.history import settings, today
from runner.store.run import Run
from runner.store.stored import write_job


def judge_run(run: Run, bounds: Mapping[str, Bound], date: str = "") -> Run:
    """Return a run with the shares of its repetitions that keep some bounds, stored with it; new ones are told.

    Nothing is simulated: the shares follow from the stored values. Without bounds those that it was judged by stay.
    It is stored, too, when each bound was first set.

    Args:
        run: The run.
        bounds: The bounds.
        date: The date on which they are set; empty for today.

    Raises:
        StoreError: if the disk does not take them.
    """
    before = run.spec
    if not bounds or (before is not None and before.config == bounds):
        return run
    found = run.judged_by(bounds, settings(bounds, date or today()))
    write_job(run.folder, "metrics.json", {key: value for key, value in found.record.items() if key != "schema"}, {})
    what = "without a spec" if before is None else "with another spec"
    print(f"runner: stored before {what}; the shares are worked out from its stored values", file=sys.stderr)
    return found
