"""Groups of a config against their models: values, all problems at once, and groups that a plug-in replaces."""

import pytest

from runner.base.errors import ConfigError
from runner.config.groups import GROUPS, read_groups
from runner.config.limits import SweepConfig
from runner.config.parsing import Problems, group_of, parse, parse_kind
from runner.controllers import CONTROLLERS
from runner.sensing.force_torque import IDEAL

SWEEP = {"trace": "auto", "retry": "none", "on_failure": "stop", "attempts": 2, "time_limit": None, "part": None}


def test_values_that_fit_make_the_model():
    assert parse("sweep", SweepConfig, SWEEP) == SweepConfig(**SWEEP)


def test_every_problem_of_a_group_is_told():
    with pytest.raises(ConfigError) as caught:
        parse("sweep", SweepConfig, {**SWEEP, "attempts": 0, "trce": "all"})
    assert [problem.partition(":")[0] for problem in caught.value.problems] == ["sweep.attempts", "sweep.trce"]


@pytest.mark.parametrize("resolved", [{}, {"sweep": 1}, {"sweep": None}])
def test_a_group_has_keys(resolved):
    with pytest.raises(ConfigError, match=r"sweep: must be a group of keys; found "):
        group_of("sweep", resolved)


def test_a_group_with_kinds_needs_one():
    with pytest.raises(ConfigError, match=r"controller.kind: missing; known: "):
        parse_kind(CONTROLLERS, {"period": 0.01})


def test_a_plug_in_without_a_known_kind_is_a_problem_and_not_a_sensor():
    problems = Problems()
    found = read_groups({"wrist_sensor": {"kind": "nobody"}}, problems)
    assert found["wrist_sensor"] is None
    assert "wrist_sensor.kind:" in [problem.partition(" ")[0] for problem in problems.found]


def test_a_built_in_sensor_is_read_by_its_model():
    assert read_groups({"wrist_sensor": IDEAL.model_dump()}, Problems())["wrist_sensor"] == IDEAL


def test_a_group_that_is_missing_is_a_problem_unless_it_may_be():
    problems = Problems()
    read_groups({}, problems)
    missing = [problem.partition(":")[0] for problem in problems.found if "must be a group of keys" in problem]
    assert missing == [group for group in GROUPS if group not in ("input_shaper", "notch")]
