"""Settings of a run apart from its controller, and their comparison between controllers."""

from collections.abc import Mapping
from typing import Any

from runner.store import simulated_part
from runner.sweeps.differing import entries

_LAW = ("controller", "disturbance_observer")


def setting(config: Mapping[str, Any]) -> dict[str, str]:
    """Return all that decides about a run but its law, with what the law carries; of the law the period stays.

    Args:
        config: The resolved config of the run.
    """
    part = simulated_part(config)
    period = {"controller.period": part["controller"].get("period")}
    return dict(entries({key: value for key, value in part.items() if key not in _LAW} | period))


def difference(one: tuple[str, Mapping[str, str]], other: tuple[str, Mapping[str, str]]) -> str:
    """Return in which key the settings of two laws differ, each given with the law's name; empty where in none."""
    (law, ours), (their_law, theirs) = one, other
    if ours == theirs:
        return ""
    key = next(key for key in dict.fromkeys([*ours, *theirs]) if ours.get(key) != theirs.get(key))
    return (
        f"{key} is {ours.get(key, 'none')} for {law} and {theirs.get(key, 'none')} for {their_law}; laws are compared "
        "where nothing but they and their gains differ"
    )
