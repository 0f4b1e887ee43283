"""Digest of the caveat rules, and differences of stored rules and thresholds from the current ones."""

import hashlib
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import yaml

from runner.base.paths import conf_dir
from runner.config.judgement import CaveatsConfig

_HEX = 24

Thresholds = Mapping[str, Mapping[str, float]]


@cache
def rules_digest() -> str:
    """Return a digest of the source of the rules."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:_HEX]


def changes_since(rules: Mapping[str, Any] | None, today: Thresholds | None = None) -> list[str]:
    """Return a message for each difference between the rules of a run's caveats and the current rules.

    Args:
        rules: Digest and thresholds stored with the caveats; None for an aborted run, which has none.
        today: Current thresholds; None for those of `conf/`.
    """
    if rules is None:
        return []
    changes = [] if rules["digest"] == rules_digest() else ["other rules"]
    now, stored = _flat(our_thresholds() if today is None else today), _flat(rules["thresholds"])
    for key in sorted(now.keys() | stored.keys()):
        then, new = stored.get(key), now.get(key)
        if then != new:
            changes.append(f"{key} {_text(then)}, now {_text(new)}")
    return changes


@cache
def our_thresholds() -> Thresholds:
    """Return the thresholds in the built-in config files."""
    values = yaml.safe_load((conf_dir() / "caveats.yaml").read_text(encoding="utf-8"))["caveats"]
    return dict(CaveatsConfig.model_validate(values).model_dump())


def _flat(thresholds: Thresholds) -> dict[str, float]:
    return {f"caveats.{rule}.{key}": value for rule, keys in thresholds.items() for key, value in keys.items()}


def _text(value: float | None) -> str:
    return "none" if value is None else f"{value:g}"
