"""Growth of rounding errors: start, relative changes, and comparison of two traces."""

from dataclasses import replace

import numpy as np
import pytest

from runner.assembly.validation import validate
from runner.base.trace import Failure
from runner.caveats.rounding import caveat_of
from runner.caveats.rounding_growth import SENSITIVE, STEP, RoundingGrowth, compare, move_start, relative_change
from runner.config.compose.compose import compose
from runner.simulation.run import simulate_run

LIMIT = 1e-6
SAME = (None, None)


@pytest.fixture(scope="module")
def simulated():
    """Repetition 0 of a short run: its trace and its metrics."""
    overrides = ("robot=macro", "trajectory=quintic", "trajectory.duration=1", "duration=1.5", "plant=rk4")
    result = simulate_run(validate(compose(overrides)))
    return result.trace, {name: summary.median for name, summary in result.metrics.items()}


def test_every_joint_moves_by_one_rounding_error_or_to_the_next_number():
    q = np.array([0.0, 0.3, -1.0, -2.0, 3.0, 1e3, -1e-300])
    for sign in (1.0, -1.0):
        moved = move_start(q, np.full(7, sign))
        assert (np.sign(moved - q) == sign).all()
        np.testing.assert_array_equal(moved[:4] - q[:4], sign * np.array([STEP, STEP, STEP, 2.0 * STEP]))
        np.testing.assert_array_equal(moved[4:6] - q[4:6], sign * np.spacing(q[4:6]))


@pytest.mark.parametrize(
    ("a", "b", "change"),
    [
        (2.0, 2.0, 0.0), (2.0, 2.002, 0.002 / 2.002), (2.002, 2.0, 0.002 / 2.002), (-1.0, 1.0, 1.0), (0.0, 1e-3, 1.0),
        (1e-10, 1.005e-10, 0.0), (0.0, 1e-12, 0.0), (0.0, 1.1e-12, 1.0),  # below 1e-12 it is rounding
        (None, None, 0.0), (None, 1.0, 1.0), (1.0, None, 1.0),
    ],
)  # fmt: skip
def test_a_change_is_relative_above_the_size_of_rounding(a, b, change):
    assert relative_change(a, b) == pytest.approx(change, rel=1e-9)


def test_two_equal_traces_have_not_moved(simulated):
    trace, metrics = simulated
    growth = compare(trace, metrics, trace, metrics)
    assert (growth.factor, growth.failures, growth.largest) == (0.0, SAME, 0.0)
    assert set(growth.metrics) == set(metrics)


def test_the_largest_difference_of_a_joint_and_its_time_are_found(simulated):
    trace, metrics = simulated
    q = trace.q + STEP
    q[70, 2] = trace.q[70, 2] - 1e-6
    q[-1] = np.nan  # of a run that diverges
    growth = compare(trace, metrics, replace(trace, q=q), {**metrics, "peak_torque": 1.01 * metrics["peak_torque"]})
    first = np.abs(q[0] - trace.q[0]).max()
    assert growth.factor == pytest.approx(1e-6 / first)
    assert growth.at == trace.t[70]
    assert growth.largest == growth.metrics["peak_torque"] == pytest.approx(0.01 / 1.01)
    assert sum(change > SENSITIVE for change in growth.metrics.values()) == 1


def test_a_failure_that_moves_is_a_change(simulated):
    trace, metrics = simulated
    early, late = (trace.ended(Failure("diverged", float(trace.t[k]))) for k in (40, 50))
    assert compare(early, {}, early, {}).largest == 0.0
    both = compare(early, {}, late, {})
    assert (both.failures, both.largest) == ((trace.t[40], trace.t[50]), pytest.approx(1 - trace.t[40] / trace.t[50]))
    assert compare(early, {}, trace, metrics).largest == 1.0
    only = compare(trace, metrics, late, {})
    assert {only.metrics[name] for name, value in metrics.items() if value is not None} == {1.0}


def grown(failures=SAME, **metrics):
    return RoundingGrowth(3.14159e9, 2.5, failures, metrics)


def test_the_caveat_names_factor_time_and_the_most_sensitive_metric():
    found = caveat_of(grown(energy=2e-6, settling_time=0.0, peak_torque=0.25), LIMIT)
    assert (found.rule, found.value) == ("rounding_grows", 0.25)
    assert found.text == (
        "rounding errors grow by a factor of 3.1e+09 until t = 2.5 s: another processor gives other values of 2 of 3 "
        "metrics, of peak_torque by 25 %; judge it by repetitions with noise"
    )


def test_the_caveat_names_a_failure_that_moves():
    text = "until t = 2.5 s: another processor gives a failure at 1.5 s instead of a failure at 1.25 s; judge"
    assert text in caveat_of(grown((1.25, 1.5)), LIMIT).text
    assert "gives no failure instead of a failure at 1.25 s" in caveat_of(grown((1.25, None)), LIMIT).text
    assert "gives a failure at 1.5 s instead of no failure" in caveat_of(grown((None, 1.5), energy=1.0), LIMIT).text


def test_the_threshold_itself_is_allowed_and_one_disables_the_rule():
    assert caveat_of(grown(energy=LIMIT), LIMIT) is None
    assert caveat_of(grown(energy=np.nextafter(LIMIT, 1.0)), LIMIT) is not None
    assert caveat_of(grown(energy=1.0), 1.0) is None
    assert caveat_of(grown((1.25, 1.25)), LIMIT) is None
    assert "1 of 2 metrics" in caveat_of(grown(energy=1e-3, peak_torque=1e-4), 5e-4).text
