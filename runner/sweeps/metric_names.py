"""Metric names: check of requested names, and names of single joints and axes."""

import re
from collections.abc import Iterable, Sequence

from runner.base.errors import RunnerError, nearest

_PART = re.compile(r".*_([xyz]|q\d+)$")


def is_part(name: str) -> bool:
    """Tell whether a metric is that of one direction or joint, such as peak_torque_q1."""
    return _PART.match(name) is not None


def check_metrics(wanted: Sequence[str], known: Iterable[str]) -> None:
    """Refuse metrics that are not known.

    Args:
        wanted: Names that were asked for.
        known: Names that there are.

    Raises:
        RunnerError: For the first that there is none of.
    """
    names = list(known)
    for name in wanted:
        if name not in names:
            listed = ", ".join(names) or "none, as all runs failed"
            raise RunnerError(f"the runs have no metric '{name}'{nearest(name, names)}; known: {listed}")
