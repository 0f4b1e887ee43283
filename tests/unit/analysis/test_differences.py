"""Extrapolated differences: of functions whose derivative is known, within their own estimate of the error."""

from importlib import import_module
from types import SimpleNamespace

import numpy as np
import pytest

from runner.analysis.sensitivity import differences
from runner.simulation.batch import BatchResult

MODULE = import_module(differences.__module__)


@pytest.fixture
def by_differences(monkeypatch):
    """Return the derivative of one metric by one parameter, given as a function and its value."""

    def make(function, value):
        class BatchSimulator:
            def simulate(self, runs):
                yield BatchResult(range(len(runs)), runs, None)

        monkeypatch.setattr(MODULE, "BatchSimulator", BatchSimulator)
        monkeypatch.setattr(MODULE, "measure", lambda runs, _: {"metric": np.array([function(run) for run in runs])})
        found = SimpleNamespace(
            scene=SimpleNamespace(at=lambda parameter, value: value),
            metrics={"metric": function(value)},
            parameters=[SimpleNamespace(value=value)],
            error=1.0,
            moves=np.array([1.0]),
        )
        (one,) = differences(found, ["metric"]).values()
        return float(one.derivatives[0]), float(one.doubts[0])

    return make


@pytest.mark.parametrize(
    ("function", "derivative"),
    [(np.exp, np.exp), (np.sin, np.cos), (lambda x: x**3, lambda x: 3.0 * x**2)],
    ids=["exp", "sin", "cube"],
)
@pytest.mark.parametrize("value", [0.7, 3.0])
def test_the_derivative_is_within_a_doubt_that_is_small(by_differences, function, derivative, value):
    found, doubt = by_differences(function, value)
    assert abs(found - derivative(value)) <= doubt
    assert doubt < 3e-11 * max(1.0, abs(function(value)))


def test_where_the_smallest_steps_are_lost_in_noise_larger_ones_count(by_differences):
    """Noise of 1e-9 is 2.6e-7 of a slope at the largest of the nine steps, 4e-3, and 256 times that at the smallest."""
    noise = iter(np.random.default_rng(0).uniform(-1e-9, 1e-9, 100))
    found, _ = by_differences(lambda x: np.exp(x) + next(noise), 1.0)
    assert found == pytest.approx(np.e, abs=2e-6)
