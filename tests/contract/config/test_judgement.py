"""Bounds on metrics, as they are written and as they are refused."""

import pytest

from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.schema.bound import Bound
from runner.store import run_hash


def bounds(*overrides, config_dirs=()):
    composed = compose(["robot=macro", "plant=rk4", *overrides], config_dirs)
    return validate(composed).spec.metrics


def problems(*overrides):
    with pytest.raises(ConfigError) as raised:
        bounds(*overrides)
    return raised.value.problems


def test_there_are_none_by_default():
    assert bounds() == bounds("spec=none") == {}


def test_a_bound_may_have_the_unit_of_its_metric():
    found = bounds("spec.metrics.settling_time.max=1600ms", "spec.metrics.peak_torque_q2={min: 1kN m, max: 5e3}")
    assert found == {"settling_time": Bound(max=1.6), "peak_torque_q2": Bound(min=1000.0, max=5000.0)}


def test_an_own_file_from_a_config_folder(tmp_path):
    (tmp_path / "spec").mkdir()
    text = "metrics:\n  settling_time: {max: 1.6 s, reason: the beat of the line}\n  overshoot: {max: 2mm}\n"
    (tmp_path / "spec" / "line.yaml").write_text(text)
    found = bounds("spec=line", "spec.metrics.overshoot.max=3mm", config_dirs=[tmp_path])
    assert found["settling_time"] == Bound(max=1.6, reason="the beat of the line")
    assert found["overshoot"].max == 3e-3


def test_a_spec_does_not_change_which_run_it_is():
    plain, bound = (compose(["robot=macro", *some]).resolved for some in ([], ["spec.metrics.settling_time.max=1.6"]))
    assert plain != bound
    assert run_hash(plain, "") == run_hash(bound, "")


def test_an_unknown_metric_is_told_with_the_nearest():
    (problem,) = problems("spec.metrics.setling_time.max=1600ms")
    assert problem.startswith(
        "spec.metrics: no metric is called 'setling_time' (did you mean settling_time?); metrics:"
    )
    assert problem.endswith("found {'setling_time': {'max': '1600ms'}}")


@pytest.mark.parametrize(
    ("override", "problem"),
    [
        ("spec.metrics.settling_time={}", "spec.metrics.settling_time: needs min, max or both; found {}"),
        ("spec.metrics.settling_time={min: 2, max: 1}", "spec.metrics.settling_time: min 2 is above max 1; found"),
        ("spec.metrics.settling_time=1.6", "spec.metrics.settling_time: must be a group of keys; found 1.6"),
        ("spec.metrics.settling_time.maxx=1", "spec.metrics.settling_time.maxx: unknown key (did you mean max?); keys"),
        (
            "spec.metrics.settling_time.max=5mm",
            "spec.metrics.settling_time.max: must be a number, or one with a unit of s",
        ),
        ("spec.metrics.settling_time.max=soon", "spec.metrics.settling_time.max: must be a number; found 'soon'"),
        (
            "spec.metrics.saturation_fraction.max=1s",
            "spec.metrics.saturation_fraction.max: has no unit; found '1s'",
        ),
        ("spec.metrics=all", "spec.metrics: must be a group of keys; found 'all'"),
        ("spec.bounds=1", "spec.bounds: unknown key; keys: metrics"),
    ],
)
def test_what_is_no_bound_is_told(override, problem):
    (found,) = problems(override)
    assert found.startswith(problem)
