"""Notch of torques: its frequency response, a flexible arm with and without it, and refusals."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from support.arms import checked

from runner.assembly.assemble import assemble
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.controllers.notch import Notch
from runner.controllers.torque_filter import AnyLaw, FilteredLaw
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders
from runner.store import simulated_part
from runner.symbolic.maths import NUMPY

H, F, WIDTH = 0.002, 5.0, 2.0
MOVE = ("robot=macro", "trajectory=quintic", "trajectory.duration=1", "duration=0.4", "noise=none", "plant=rk4")
SLOW_LAW = ("controller.natural_frequency=10", "controller.period=0.002")
NOTCHED = ("notch=torques", "notch.frequency=[6,null,9]")


def passed(torques, notch):
    memory, rows, arm = np.zeros(notch.state_size), [], SimpleNamespace(backend=NUMPY)
    for k, torque in enumerate(torques):
        row, memory = notch.filter(arm, notch.parameters, k * H, None, None, torque, memory)
        rows.append(row)
    return np.array(rows)


def gain(frequency):
    """Return the gain of a notch of one joint for a sine, after its transient."""
    times = H * np.arange(6000)
    out = passed(np.sin(2 * np.pi * frequency * times)[:, None], Notch(np.array([F]), WIDTH, H))[3000:, 0]
    waves = np.stack([np.sin(2 * np.pi * frequency * times), np.cos(2 * np.pi * frequency * times)], axis=1)[3000:]
    return np.hypot(*np.linalg.lstsq(waves, out, rcond=None)[0])


def test_nothing_passes_at_its_frequency_and_all_far_from_it():
    assert gain(F) < 1e-9
    assert gain(0.1) == pytest.approx(1.0, abs=1e-3)
    assert gain(200.0) == pytest.approx(1.0, abs=1e-2)


def test_the_width_lies_between_the_frequencies_of_which_half_the_power_passes():
    """f_1 f_2 = f^2 and f_2 - f_1 = width for the analogue notch, which the bilinear transform bends little."""
    low = np.sqrt(F**2 + 0.25 * WIDTH**2) - 0.5 * WIDTH
    assert [gain(low), gain(low + WIDTH)] == pytest.approx([np.sqrt(0.5)] * 2, rel=1e-3)


def test_the_torque_of_the_first_tick_passes_at_once_and_each_joint_on_its_own():
    notch = Notch(np.array([F, np.inf]), WIDTH, H)
    assert passed(np.tile([3.0, -2.0], (200, 1)), notch) == pytest.approx(np.tile([3.0, -2.0], (200, 1)), abs=1e-12)
    steps = np.tile([3.0, -2.0], (200, 1))
    steps[50:] = [1.0, 7.0]
    out = passed(steps, notch)
    assert out[:, 1] == pytest.approx(steps[:, 1])
    assert out[50, 0] != pytest.approx(steps[50, 0], rel=1e-3)


def test_code_and_any_controller_ask_for_the_same_as_the_law():
    config = checked(*MOVE, *SLOW_LAW, *NOTCHED)
    closed = assemble(config)
    closed.close()
    assert closed.compiled is not None
    (loop,), (bare,) = closed.loops, config.loops
    notch = Notch(np.array([6.0, np.inf, 9.0]), 5.0, loop.period)
    wrapped = replace(loop, controller=FilteredLaw(AnyLaw(bare.controller, config.arm.model), notch))
    traces = [
        simulate(replace(closed, compiled=compiled, loops=(each,)), make_encoders(closed, config.noise, 0, 0))
        for compiled, each in ((closed.compiled, loop), (None, loop), (None, wrapped))
    ]
    assert traces[1].tau == pytest.approx(traces[0].tau, abs=1e-8)
    assert np.array_equal(traces[2].tau, traces[1].tau)


def test_it_lets_links_encoders_be_used_at_a_low_bandwidth_and_no_more(simulated):
    """Motors and links ring at 4.5 to 7.5 Hz; without a notch xi omega_n < zeta omega_r, 0.6 rad/s, is the limit."""

    def failure(bandwidth, *notch):
        return simulated(
            *("robot=macro", "plant=rk4_flexible", "plant.step=0.001", "plant.flexible_joints.encoders=link"),
            *("controller=computed_torque", "controller.period=0.005", f"controller.natural_frequency={bandwidth}"),
            *("trajectory=joint_quintic", "trajectory.goal_configuration=[0.3,0.2,0.2]", "trajectory.duration=1"),
            *("noise=none", "torque_limits=none", "duration=6", *notch),
        ).failure

    notch = ("notch=torques", "notch.frequency=[5.03,4.5,6.8]", "notch.width=2")
    assert failure(3) is not None
    assert failure(3, *notch) is None
    assert failure(30, *notch) is not None


def test_the_names_of_runs_without_a_notch_know_nothing_of_it():
    assert "notch" not in simulated_part(compose(["robot=macro"]).resolved)
    assert compose(["robot=macro", "notch=none"]).resolved == compose(["robot=macro"]).resolved
    assert simulated_part(compose(["robot=macro", "notch=torques"]).resolved)["notch"]["width"] == 5.0


def test_stages_have_notches_of_their_own(simulated):
    keys = ("notch.frequency={macro: 6, mini: null}",)
    assert simulated("robot=combined", "plant=rk4", "notch=torques", *keys, "duration=0.05").failure is None
    with pytest.raises(ConfigError, match=r"notch.frequency: needs a value for each stage \(macro, mini\)"):
        checked("robot=combined", "notch=torques")


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        (("notch.frequency=50",), "q1 has 50 Hz, of a loop of 0.01 s; allowed: below 50 Hz, half its rate"),
        (("notch.width=70",), "notch.width: 70 Hz, of a loop of 0.01 s"),
        (("notch.frequency=0",), "must be a number above 0, null for joints without a notch"),
        (("notch.width=0",), "notch.width: must be above 0"),
        (("notch.frequency=null",), "null for every joint; take notch=none"),
        (("notch.frequency=[1,2]",), "2 values for 3 joints (q1, q2, q3)"),
        (("robot=xarm7",), "differential_inverse_kinematics commands joint positions; take a controller that gives"),
        (
            ("robot=mini", "controller=hybrid_force"),
            "hybrid_force feels; take a controller that gives torques and feels",
        ),
    ],
)
def test_what_does_not_fit_is_refused(overrides, expected):
    with pytest.raises(ConfigError) as caught:
        checked("robot=macro", "notch=torques", *overrides)
    assert expected in str(caught.value)
