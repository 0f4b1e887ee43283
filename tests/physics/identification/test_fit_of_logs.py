"""Parameters fitted to torques that are known exactly: masses, rotors, friction, delay, contacts and several logs."""

import re

import numpy as np
import pinocchio as pin
import pytest
from support.identified_logs import KnownArm

from runner.identification.checks import find_flags, find_masses, payload_sentences, second_method
from runner.identification.fit import fit_logs, residual_sizes, row_weights
from runner.identification.friction_kinds import TERMS
from runner.identification.held_out import file_share, predict_held_out
from runner.identification.log_rows import log_rows


@pytest.fixture(scope="module")
def arm():
    return KnownArm("macro")


def rows_of(arm, log, exact=False, rotors=True, name="log"):
    return log_rows(arm.rows(log, exact=exact), arm.sums, rotors, name)


def truth(arm, kind):
    terms = {
        "viscous": arm.viscous,
        "coulomb": arm.coulomb,
        "offset": arm.offset,
        "coulomb by load": arm.by_load,
    }
    return np.concatenate([arm.base, np.column_stack([terms[term] for term in TERMS[kind]]).ravel()])


def noisy(log, seed=0, size=0.2):
    *motion, tau = log
    return (*motion, tau + size * np.random.default_rng(seed).normal(size=tau.shape))


@pytest.mark.costs(3)
@pytest.mark.parametrize("robot", ["macro", "ur5e"])
def test_a_noiseless_log_with_accelerations_gives_the_true_model(robot):
    arm = KnownArm(robot)
    fit = fit_logs([rows_of(arm, arm.log(), exact=True)], "coulomb")
    wanted = truth(arm, "coulomb")
    told = [place for place in fit.taken if place < len(wanted)]
    assert len(told) == len(wanted)
    np.testing.assert_allclose(fit.state.values[told], wanted[told], atol=1e-6)
    assert abs(fit.state.delay) < 1e-6


@pytest.mark.costs(2)
def test_friction_that_grows_with_the_load_is_found(arm):
    loaded = KnownArm("macro")
    loaded.by_load = np.array([0.05, 0.1, 0.08])
    rows = rows_of(loaded, loaded.log(), exact=True)
    fit = fit_logs([rows], "load")
    np.testing.assert_allclose(fit.state.values[:-1], truth(loaded, "load"), atol=1e-5)
    other = [rows_of(loaded, noisy(loaded.log(20.0)))]
    flags = find_flags(fit_logs(other, "coulomb"), other)
    assert "the load" in {flag.follows for flag in flags}
    right = [rows_of(arm, noisy(arm.log(20.0)))]
    assert not find_flags(fit_logs(right, "coulomb"), right)


@pytest.mark.costs(2)
@pytest.mark.parametrize("start", [1e-8, 1.05, 2.0])
def test_the_result_does_not_depend_on_the_starting_value(arm, start):
    rows = [rows_of(arm, noisy(arm.log()))]
    plain = fit_logs(rows, "coulomb")
    begun = arm.base * start if start > 1.0 else np.full(len(arm.base), start)
    other = fit_logs(rows, "coulomb", begun)
    scale = np.maximum(plain.deviations[plain.taken], 1e-12)
    assert np.max(np.abs(other.state.values - plain.state.values)[plain.taken] / scale) < 1e-3
    assert other.taken == plain.taken


def test_a_delay_of_the_torques_is_found_and_not_taken_for_friction(arm):
    fit = fit_logs([rows_of(arm, noisy(arm.log(20.0, delay=0.006), size=0.05))], "coulomb")
    assert fit.state.delay == pytest.approx(0.006, abs=3.0 * fit.halves[-1])
    assert 0.0 < fit.halves[-1] < 0.001
    wanted = truth(arm, "coulomb")
    assert np.mean(np.abs(fit.state.values[:-1] - wanted) < fit.halves[:-1]) > 0.8


def test_contacts_count_less(arm):
    log = noisy(arm.log(20.0), size=0.05)
    pushed = log[-1].copy()
    pushed[2000:2300] += 30.0
    plain, hit = (fit_logs([rows_of(arm, (*log[:-1], tau))], "coulomb") for tau in (log[-1], pushed))
    assert hit.outside.sum() > plain.outside.sum() + 10
    blunt = second_method(hit)
    wanted = truth(arm, "coulomb")
    robust, ordinary = (np.abs(values[:-1] - wanted).max() for values in (hit.state.values, blunt.values))
    assert robust < 0.3 * ordinary


@pytest.mark.costs(2)
def test_a_joint_whose_torque_contradicts_the_others_does_not_count_ever_more(arm):
    t, q, dq, ddq, tau = noisy(arm.log(20.0), size=0.02)
    growth = []
    for gain in (1.0, 1.2):
        fit = fit_logs([rows_of(arm, (t, q, dq, ddq, tau * np.array([1.0, 1.0, gain])))], "coulomb")
        renewed = row_weights(fit.system, fit.rest, residual_sizes(fit.system, fit.rest))[0]
        used = fit.weights > 0.0
        parts = [used & (fit.system.joint == joint) for joint in range(3)]
        by_joint = [np.median(renewed[part] / fit.weights[part]) for part in parts]
        growth.append(max(by_joint) / min(by_joint))
    assert growth[0] < 1.1
    assert growth[1] > 3.0


@pytest.mark.parametrize("size", [0.0, 0.05])
def test_an_interval_is_never_narrower_than_that_of_white_residuals(arm, size):
    fit = fit_logs([rows_of(arm, noisy(arm.log(), size=size))], "coulomb")
    assert (fit.within[fit.taken] >= fit.white[fit.taken]).all()


def test_a_joint_that_does_not_move_is_left_out_and_told_apart_from_nothing(arm):
    rows = rows_of(arm, arm.log(moves=[1.0, 1.0, 0.0]), exact=True)
    assert rows.motion.creeps(2)
    fit = fit_logs([rows], "coulomb")
    missing = set(range(fit.state.layout.delay)) - set(fit.taken)
    assert set(range(*fit.state.layout.friction(2).indices(99))) <= missing


def test_held_out_torques_are_predicted_and_the_files_model_is_not_as_good(arm):
    rows = [rows_of(arm, noisy(arm.log(20.0), size=0.05))]
    fit = fit_logs(rows, "coulomb")
    held = predict_held_out(fit, rows)
    full = np.concatenate([arm.model.inertial_parameters, arm.model.armature])
    file = np.array([each.factors @ full for each in arm.sums])
    inside = np.linalg.norm(fit.rest[fit.system.moving]) / np.linalg.norm(fit.system.y[fit.system.moving])
    assert 0.9 * inside < held.share() < 0.02 < 0.1 < file_share(held.system, file)
    assert len(held.squares) == 8
    assert len(predict_held_out(fit_logs(3 * rows, "coulomb"), 3 * rows).squares) == 3


@pytest.mark.costs(2)
def test_the_spread_between_logs_is_in_the_interval(arm):
    logs = []
    for number, viscous in enumerate((0.5, 1.0, 1.5)):
        changed = KnownArm("macro")
        changed.viscous = np.full(3, viscous)
        logs.append(rows_of(arm, noisy(changed.log(12.0, first=20.0 * number), number, 0.05), name=f"{number}"))
    fit = fit_logs(logs, "coulomb")
    viscous = [fit.state.layout.friction(joint).start for joint in range(3)]
    assert fit.spread[viscous].all()
    assert (fit.halves[viscous] > 0.5).all()
    assert (fit.within[viscous] < fit.halves[viscous]).all()


def test_a_change_of_the_payload_is_found_with_its_time_and_mass(arm):
    t, q, dq, ddq, tau = noisy(arm.log(20.0), size=0.05)
    loaded = arm.model.with_payload(2.0)
    extra = loaded.pin_model, loaded.pin_model.createData(), arm.model.pin_model, arm.model.pin_model.createData()
    more = np.array([pin.rnea(*extra[:2], *row) - pin.rnea(*extra[2:], *row) for row in zip(q, dq, ddq, strict=True)])
    rows = [rows_of(arm, (t, q, dq, ddq, tau + more * (t > 12.0)[:, None]))]
    (change,) = find_masses(fit_logs(rows, "coulomb"), rows)
    assert change.time == pytest.approx(12.0, abs=1.0)
    assert change.mass == pytest.approx(2.0, rel=0.3)
    same = [rows_of(arm, (t, q, dq, ddq, tau))]
    assert not list(find_masses(fit_logs(same, "coulomb"), same))


@pytest.mark.costs(3)
def test_a_payload_that_only_another_log_has_gets_no_time(arm):
    def logs(*masses):
        found = []
        for number, mass in enumerate(masses):
            t, q, dq, ddq, tau = noisy(arm.log(20.0, first=20.0 * number), number, 0.05)
            models = [model.pin_model for model in (arm.model.with_payload(mass), arm.model)]
            loaded, bare = (
                np.array([pin.rnea(model, model.createData(), *row) for row in zip(q, dq, ddq, strict=True)])
                for model in models
            )
            found.append(rows_of(arm, (t, q, dq, ddq, tau + loaded - bare), name=f"log{number}.csv"))
        return found

    def said(rows):
        return [*payload_sentences(fit_logs(rows, "coulomb"), rows)]

    for masses, more in (((0.0, 2.0), "log1.csv"), ((2.0, 0.0), "log0.csv"), ((0.0, 2.0, 0.0), "log1.csv")):
        (sentence,) = said(logs(*masses))
        assert re.fullmatch(rf"{more} seems to carry (1\.\d|2|2\.\d) kg more than the other logs", sentence)
    assert said(logs(0.0, 0.0)) == []
