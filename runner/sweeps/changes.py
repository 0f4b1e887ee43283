"""Differences between a stored run and today: its keys from those of its groups, and the rules of its caveats."""

from collections.abc import Mapping
from typing import Any

from runner.base.dotted_keys import dotted, leaves
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.store.run import Run

Changes = Mapping[str, tuple[Any, Any]]
"""Key, value in its group, and value of the run."""


def changed_keys(run: Run) -> Changes | None:
    """Return the keys that differ from what the run's groups hold by themselves, each as (default, value).

    Returns:
        The keys; None where the groups cannot be composed here, such as those of the user's config folder.
    """
    choices = run.provenance.get("choices", {})
    try:
        plain = compose([f"{group}={name}" for group, name in choices.items() if group != "experiment"])
    except ConfigError:
        return None
    before, now = (dict(leaves(config, lists=False)) for config in (plain.resolved, run.config))
    places = [place for place in now if place != ("outputs",) and place in before and before[place] != now[place]]
    return {dotted(place): (before[place], now[place]) for place in places}


def changed_rules(run: Run, thresholds: Mapping[str, Mapping[str, float]] | None = None) -> list[str]:
    """Return a message for each difference between the rules of a run's caveats and the current rules.

    Args:
        run: The run.
        thresholds: Current thresholds; None for those of `conf/`.
    """
    from runner.caveats.versions import changes_since  # imports all rules

    return changes_since(run.caveat_rules, thresholds)
