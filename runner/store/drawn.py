"""Random draws of a stored run's repetitions, read from its config."""

from collections.abc import Mapping
from typing import Any

from runner.base.dotted_keys import leaves

_AMPLITUDES = ("noise", "drift", "jitter", "miss")
"""Keys outside `noise` whose value, if it is not zero, is the size of a random draw."""


def draws_nothing(config: Mapping[str, Any]) -> bool:
    """Return True if no repetition of a config draws anything; False for noise or a model error from a plug-in."""
    noise, mismatch = config.get("noise"), config.get("mismatch")
    if not isinstance(noise, Mapping) or not isinstance(mismatch, Mapping) or "kind" in noise:
        return False
    measured = noise.get("distribution") == "none" or not _is_positive(noise.get("position"))
    return measured and not draws_model(config) and not any(
        _is_positive(value) for place, value in leaves(config, lists=False)
        if place[0] != "noise" and place[-1] in _AMPLITUDES
    )  # fmt: skip


def draws_model(config: Mapping[str, Any]) -> bool:
    """Return True if a config's model error differs between repetitions."""
    mismatch = config.get("mismatch", {})
    of_links = [value for link in mismatch.get("link", {}).values() for key, value in link.items() if "spread" in key]
    return "kind" in mismatch or any([mismatch.get("spread"), *of_links])


def _is_positive(value: object) -> bool:
    """Return True if a number, or one of a list or of several stages, is above zero."""
    if isinstance(value, list | Mapping):
        return any(map(_is_positive, value.values() if isinstance(value, Mapping) else value))
    return isinstance(value, int | float) and value > 0
