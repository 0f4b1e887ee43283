"""Values of a log combined with those of the robot's file: both limits, and the share of the file."""

from dataclasses import replace

import numpy as np
import pytest
from support.identified_logs import KnownArm

from runner.identification.fit import fit_logs
from runner.identification.log_rows import log_rows
from runner.identification.prior import combine_with_prior, prior_widths


@pytest.fixture(scope="module")
def arm():
    return KnownArm("macro")


def fit_of(arm, moves=None):
    log = arm.log(16.0, moves=moves)
    tau = log[-1] + 0.05 * np.random.default_rng(0).normal(size=log[-1].shape)
    return fit_logs([log_rows(arm.rows((*log[:-1], tau)), arm.sums, True, "log")], "coulomb")


def combined(arm, fit, width):
    full = np.concatenate([arm.model.inertial_parameters, np.full(3, 0.2)])
    factors = np.array([each.factors for each in arm.sums])
    widths = prior_widths(full, 3, width)
    base = factors @ full
    covariance = (factors * widths**2) @ factors.T
    return combine_with_prior(fit, fit.halves, base, covariance), base, np.sqrt(np.diagonal(covariance))


def test_a_wide_prior_leaves_the_values_of_the_log_and_a_narrow_one_those_of_the_file(arm):
    fit = fit_of(arm)
    nb = fit.state.layout.base
    wide, _, _ = combined(arm, fit, 1e4)
    np.testing.assert_allclose(wide.values[:-1], fit.state.values[:-1], rtol=1e-3, atol=1e-5)
    np.testing.assert_allclose(wide.halves[:-1], fit.halves[:-1], rtol=1e-2)
    assert (wide.shares[:nb] < 0.01).all()
    narrow, base, deviations = combined(arm, fit, 1e-6)
    assert (np.abs(narrow.values[:nb] - base) < 20.0 * deviations).all()  # the log lies 1e5 of them away
    assert (narrow.shares[:nb] > 0.99).all()
    assert np.isnan(narrow.shares[nb:]).all()


def test_intervals_are_narrower_than_those_of_the_log_and_of_the_file(arm):
    fit = fit_of(arm)
    nb = fit.state.layout.base
    found, _, _ = combined(arm, fit, 0.3)
    assert (found.halves[:nb] <= fit.halves[:nb] * (1.0 + 1e-9)).all()
    assert ((found.shares[:nb] >= 0.0) & (found.shares[:nb] <= 1.0)).all()


def test_what_the_log_does_not_tell_is_the_files(arm):
    fit = fit_of(arm, moves=[1.0, 1.0, 0.0])
    found, base, deviations = combined(arm, fit, 0.1)
    missing = [column for column in range(fit.state.layout.base) if column not in fit.taken]
    assert missing
    assert (np.abs(found.values[: len(base)] - base)[missing] < 3.0 * deviations[missing]).all()
    assert (found.shares[missing] > 0.3).all()
    assert found.shares[missing].max() > 0.99
    assert np.isnan(found.halves[fit.state.layout.friction(2)]).all()


def test_one_known_value_is_the_weighted_mean(arm):
    fit = fit_of(arm)
    layout = fit.state.layout
    single = replace(fit, halves=np.where(np.arange(layout.delay + 1) == fit.taken[0], fit.halves, np.nan))
    column, deviation = fit.taken[0], fit.halves[fit.taken[0]] / 1.96
    base, own = np.zeros(layout.base), np.zeros((1, layout.delay + 1))
    own[0, column] = 1.0
    only = replace(single, factors=np.vstack([own, fit.factors[1:]]))
    found = combine_with_prior(only, only.halves, base, np.diag(np.full(layout.base, deviation**2)))
    assert found.values[column] == pytest.approx(0.5 * fit.state.values[column])
    assert found.shares[column] == pytest.approx(0.5)
    assert found.halves[column] == pytest.approx(1.96 * deviation / np.sqrt(2.0))


def test_a_coordinate_of_zero_in_the_file_is_not_exact():
    body = [2.0, 0.0, 0.0, 0.0, 0.02, 0.0, 0.02, 0.0, 0.0, 0.02]
    widths = prior_widths(np.array([*body, 0.0]), 1, 0.1)
    radius = np.sqrt(0.03 / 2.0)
    np.testing.assert_allclose(widths[:10], 0.1 * np.array([2.0, *3 * [2.0 * radius], *6 * [2.0 * radius**2]]))
    assert widths[10] >= 100.0
