"""Keys of a run's config that its groups do not set so."""

from dataclasses import dataclass
from typing import Any

from runner.config.compose.compose import compose
from runner.reporting.run_report import _yaml
from runner.sweeps.changes import changed_keys


@dataclass
class _Run:
    config: dict[str, Any]
    provenance: dict[str, Any]


def _run(*overrides: str, choices: dict[str, str] | None = None) -> _Run:
    groups = choices or {"robot": "macro", "trajectory": "quintic"}
    composed = compose([*(f"{group}={name}" for group, name in groups.items()), *overrides])
    return _Run(dict(composed.resolved), {"choices": groups})


def test_only_what_was_set_is_named_with_its_default() -> None:
    found = changed_keys(_run("trajectory.duration=1.25", "seed=7"))
    assert found is not None
    assert set(found) == {"trajectory.duration", "seed"}
    default, value = found["trajectory.duration"]
    assert (value, default != value) == (1.25, True)


def test_nothing_is_named_where_nothing_was_set() -> None:
    assert changed_keys(_run()) == {}


def test_groups_that_are_not_here_are_told_by_none() -> None:
    assert changed_keys(_Run({}, {"choices": {"robot": "of_a_stranger"}})) is None


def test_a_value_is_shown_as_it_is_typed():
    values = (["Würfel", "鸡蛋"], "Würfel", True, None, 1000000000.0, [2000000000.0])
    assert [_yaml(value) for value in values] == ['["Würfel", "鸡蛋"]', "Würfel", "true", "null", "1e9", "[2e9]"]
