"""Config keys that differ from the defaults of their groups."""

from collections.abc import Mapping
from typing import Any

from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.store import Run


def changed_keys(run: Run) -> dict[str, tuple[Any, Any]] | None:
    """Return the keys that differ from what the run's groups hold by themselves, each as (default, value).

    Returns:
        The keys; None where the groups cannot be composed here, as those of a config folder of one's own.
    """
    choices = run.provenance.get("choices", {})
    try:
        plain = compose([f"{group}={name}" for group, name in choices.items() if group != "experiment"])
    except ConfigError:
        return None
    before, now = flatten(plain.resolved), flatten(run.config)
    keys = [key for key in now if key != "outputs" and key in before and before[key] != now[key]]
    return {key: (before[key], now[key]) for key in keys}


def flatten(value: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Return the values of a config by their dotted keys."""
    flat: dict[str, Any] = {}
    for key, item in value.items():
        if isinstance(item, Mapping) and item:
            flat |= flatten(item, f"{prefix}{key}.")
        else:
            flat[f"{prefix}{key}"] = item
    return flat
