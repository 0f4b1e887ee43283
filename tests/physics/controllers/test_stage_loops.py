"""When the Mini follows and when it holds, whose turn it is, and the two rates of the loops."""

import dataclasses

import numpy as np
import pytest

from runner.assembly.assemble import assemble
from runner.controllers.macro_mini.stage_loops import MacroController, MiniController, mini_moves
from runner.robots.robot import end_points
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders
from runner.symbolic.maths import NUMPY

REACH = 0.2


class Spy:
    """In a stage's law's place: keeps what it receives."""

    gravity_compensation, parameters = True, ()

    def __init__(self, model):
        self.model, self.told, self.gravity = model, [], None

    def move(self, arm, parameters, q, dq, reference, gravity=None):
        self.told.append(("move", np.array(reference)))
        self.gravity = gravity
        return np.zeros(3)

    def hold(self, arm, parameters, q, dq, posture, gravity=None):
        self.told.append(("hold", np.array(posture)))
        self.gravity = gravity
        return np.zeros(3)


@pytest.fixture
def mini_loop(combined):
    """A Mini's loop, and the reference of its law if the target is some way off its base."""

    def make(moving_target=True, stretch=False, turn=None, later=(0.0, 0.0, 0.0)):
        law = Spy(combined.stages[1].model)
        loop = MiniController(combined, 1, law, "rest", np.array(later), False, moving_target, REACH, stretch, turn)

        def ask(way, q=None, time=0.0):
            q = np.array([0.3, -0.5, 0.7, 0.2, -0.4, 0.9]) if q is None else q
            x_E = combined.stages[0].model.tip_position(q[:3])
            loop.torque(time, q, np.ones(6), np.array([x_E + way, np.ones(3), np.zeros(3)]))
            return law.told[-1]

        return loop, ask

    return make


def along(distance, direction=(1.0, 2.0, -2.0)):
    return distance * np.array(direction) / np.linalg.norm(direction)


# Reach.


@pytest.mark.parametrize("direction", [(1.0, 2.0, -2.0), (0.0, 0.0, 1.0), (-1.0, 1.0, 1.0)])
def test_the_mini_follows_up_to_its_reach(mini_loop, direction):
    _, ask = mini_loop()
    assert ask(along(REACH * (1.0 - 1e-9), direction))[0] == "move"
    assert ask(along(REACH * (1.0 + 1e-9), direction))[0] == "hold"
    assert ask(along(0.0, direction))[0] == "move"


def test_beyond_it_the_mini_holds_the_posture_of_the_moment_it_lost_reach(mini_loop):
    loop, ask = mini_loop()
    near, far = along(0.1), along(0.3)
    first, second, third = (np.array([0.1, 0.2, 0.3, *own]) for own in ([0.4, 0.5, 0.6], [1.4, 0.5, 0.6], [0.0] * 3))
    assert ask(near, first)[0] == "move"
    np.testing.assert_array_equal(ask(far, first)[1], first[3:])
    np.testing.assert_array_equal(ask(far, second)[1], first[3:])  # still the one of the moment
    assert ask(near, second)[0] == "move"  # released
    np.testing.assert_array_equal(ask(far, third)[1], third[3:])  # a new hold, a new posture
    loop.reset()
    np.testing.assert_array_equal(ask(far, second)[1], second[3:])


def test_the_posture_held_is_a_copy(mini_loop):
    _, ask = mini_loop()
    q = np.zeros(6)
    ask(along(0.3), q)
    q += 1.0
    np.testing.assert_array_equal(ask(along(0.3), q)[1], np.zeros(3))


@pytest.mark.parametrize("distance", [0.1, 0.2 * (1.0 - 1e-9), 0.2 * (1.0 + 1e-9), 0.5, 3.0])
def test_a_stretching_mini_goes_towards_the_target_as_far_as_it_reaches(mini_loop, distance):
    _, ask = mini_loop(stretch=True)
    kind, target = ask(along(distance))
    assert kind == "move"
    assert np.linalg.norm(target[0]) == pytest.approx(min(distance, REACH), rel=1e-12)
    reachable = mini_loop()[1](along(0.1))[1][0]
    np.testing.assert_allclose(target[0] / np.linalg.norm(target[0]), reachable / 0.1, atol=1e-12)
    assert (np.abs(target[1]).max() > 0.0) == (distance <= REACH)  # at its limit it is at rest
    np.testing.assert_array_equal(target[2], 0.0)


# Later stages.

LATER = np.array([0.02, -0.3, 0.1])  # home offset of the stage on the Mini, longer than the Mini's reach


@pytest.mark.parametrize("stretch", [False, True])
def test_what_later_stages_make_up_for_is_taken_off_the_way(mini_loop, stretch):
    way = along(0.1)
    _, alone = mini_loop(stretch=stretch)[1](way)
    kind, target = mini_loop(stretch=stretch, later=LATER)[1](way + LATER)
    assert kind == "move"
    np.testing.assert_allclose(target, alone, atol=1e-12)
    assert np.linalg.norm(target[0]) == pytest.approx(0.1)


@pytest.mark.parametrize("direction", [(1.0, 2.0, -2.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0), (0.0, 1.0, 0.0)])
def test_reach_counts_to_where_later_stages_begin(mini_loop, direction):
    _, ask = mini_loop(later=LATER)
    assert ask(along(REACH * (1.0 - 1e-9), direction) + LATER)[0] == "move"
    assert ask(along(REACH * (1.0 + 1e-9), direction) + LATER)[0] == "hold"


@pytest.fixture(scope="module")
def three_stages(checked_config):
    """A Mini on the Mini on the Macro."""
    return checked_config("robot=macro_mini_mini").arm


Q_NINE = np.array([0.3, -0.5, 0.7, 0.2, -0.4, 0.9, -0.6, 0.5, 0.1])


@pytest.mark.parametrize("direction", [(1.0, 2.0, -2.0), (0.0, 1.0, 1.0), (0.0, -1.0, -1.0)])
def test_the_carrier_s_turn_ends_where_the_first_rider_reaches_its_own_target(three_stages, direction):
    law = Spy(three_stages.stages[0].model)
    macro_loop = MacroController(three_stages, law, np.zeros(3), False, REACH, 0.01)
    x_E = three_stages.stages[0].model.tip_position(Q_NINE[:3])
    later = np.array([0.0, 0.1, 0.1])  # at home the second Mini is on the first, as this on the Macro
    for distance, expected in ((REACH * (1.0 - 1e-9), "hold"), (REACH * (1.0 + 1e-9), "move")):
        target = np.array([x_E + later + along(distance, direction), np.zeros(3), np.zeros(3)])
        macro_loop.torque(0.01, Q_NINE, np.zeros(9), target)
        assert law.told[-1][0] == expected


def test_in_two_way_coupling_the_carrier_makes_up_for_all_its_riders(three_stages):
    law = Spy(three_stages.stages[0].model)
    macro_loop = MacroController(three_stages, law, None, False, REACH, None)
    desired = np.array([[0.4, 1.0, 0.8], [0.1, 0.2, 0.3], [0.0, 0.0, 1.0]])
    macro_loop.torque(0.0, Q_NINE, np.zeros(9), desired)
    riders = three_stages.model.tip_position(Q_NINE) - three_stages.stages[0].model.tip_position(Q_NINE[:3])
    np.testing.assert_allclose(law.told[-1][1][0], desired[0] - riders, atol=1e-12)
    np.testing.assert_array_equal(law.told[-1][1][1:], desired[1:])


def test_the_rider_sees_target_and_gravity_from_its_base(combined):
    """R^T (x_d - x_E), R^T (xd_d - xd_E - w x (x_d - x_E)) and R^T g, R turned by every joint of the Macro."""
    law = Spy(combined.stages[1].model)
    loop = MiniController(combined, 1, law, "rest", np.zeros(3), False, True, REACH, False, None)
    macro, generator = combined.stages[0].model, np.random.default_rng(2)
    for _ in range(5):
        q, dq = generator.uniform(-2.0, 2.0, (2, 6))
        desired, way = generator.uniform(-1.0, 1.0, (3, 3)), along(0.1)
        pose = macro.tip_pose(q[:3])
        R = pose[:3, :3] @ np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # as the Mini is mounted
        velocity, spin = np.split(macro.tip_jacobian(q[:3]) @ dq[:3], 2)
        desired[0] = pose[:3, 3] + way
        loop.torque(0.0, q, dq, desired)
        _, target = law.told[-1]
        np.testing.assert_allclose(target[0], R.T @ way, atol=1e-12)
        np.testing.assert_allclose(target[1], R.T @ (desired[1] - velocity - np.cross(spin, way)), atol=1e-12)
        np.testing.assert_allclose(law.gravity, R.T @ [0.0, 0.0, -9.81], atol=1e-12)


def test_under_bases_taken_parallel_the_second_rider_sees_offsets_that_do_not_turn(three_stages):
    """R_0^T (x_d - x_E) and its rate, with the x_E that end_points gives where bases keep the orientation of home."""
    law = Spy(three_stages.stages[2].model)
    loop = MiniController(three_stages, 2, law, "rest", np.zeros(3), True, True, 10.0, False, None)
    R = three_stages.model.with_tip(three_stages.stages[2].base_frame).tip_pose(three_stages.home)[:3, :3]
    generator, step = np.random.default_rng(3), 1e-6
    for _ in range(5):
        q, dq = generator.uniform(-2.0, 2.0, (2, 9))
        desired = generator.uniform(-1.0, 1.0, (3, 3))
        rows = q + step * np.array([[-1.0], [0.0], [1.0]]) * dq
        before, now, after = end_points(three_stages, rows, ignore_base_rotation=True)[1]
        loop.torque(0.0, q, dq, desired)
        _, target = law.told[-1]
        np.testing.assert_allclose(target[0], R.T @ (desired[0] - now), atol=1e-12)
        np.testing.assert_allclose(target[1], R.T @ (desired[1] - (after - before) / (2.0 * step)), atol=1e-8)


# Turns.


@pytest.mark.parametrize("period", [0.01, 0.03])
def test_turns_are_a_period_of_the_carrier_each_beginning_with_it(period):
    def moves(time):
        return mini_moves(NUMPY, period, time)

    for k in range(1, 2000):
        tick = k * 0.001
        assert moves(tick) == (round(tick * 1e6) // round(period * 1e6) % 2 == 1)
    assert not moves(0.0)
    for number in range(500):  # at the very start of each, whatever rounding leaves of it
        assert moves(number * period) == (number % 2 == 1)


def test_in_turns_each_arm_holds_while_the_other_moves(combined, mini_loop):
    law = Spy(combined.stages[0].model)
    macro_loop = MacroController(combined, law, np.zeros(3), False, REACH, 0.01)
    _, ask = mini_loop(turn=0.01)
    q = np.array([0.3, -0.5, 0.7, 0.2, -0.4, 0.9])
    x_E = combined.stages[0].model.tip_position(q[:3])
    for k in range(40):
        time, reference = k * 0.01, np.array([x_E + along(0.1), np.zeros(3), np.zeros(3)])
        macro_loop.torque(time, q, np.zeros(6), reference)
        kinds = law.told[-1][0], ask(along(0.1), q, time)[0]
        assert kinds == (("move", "hold") if k % 2 == 0 else ("hold", "move"))


def test_where_the_mini_cannot_reach_the_macro_moves_on(combined):
    law = Spy(combined.stages[0].model)
    macro_loop = MacroController(combined, law, np.zeros(3), False, REACH, 0.01)
    q = np.array([0.3, -0.5, 0.7, 0.2, -0.4, 0.9])
    x_E = combined.stages[0].model.tip_position(q[:3])
    macro_loop.torque(0.01, q, np.zeros(6), np.array([x_E + along(0.3), np.zeros(3), np.zeros(3)]))
    assert law.told[-1][0] == "move"
    macro_loop.torque(0.03, q, np.zeros(6), np.array([x_E + along(0.1), np.zeros(3), np.zeros(3)]))
    np.testing.assert_array_equal(law.told[-1][1], q[:3])
    later = q + 0.1
    x_E = combined.stages[0].model.tip_position(later[:3])
    macro_loop.torque(0.035, later, np.zeros(6), np.array([x_E + along(0.1), np.zeros(3), np.zeros(3)]))
    np.testing.assert_array_equal(law.told[-1][1], q[:3])  # the posture of the moment the hold began
    macro_loop.reset()
    macro_loop.torque(0.035, later, np.zeros(6), np.array([x_E + along(0.1), np.zeros(3), np.zeros(3)]))
    np.testing.assert_array_equal(law.told[-1][1], later[:3])


# Two rates, and what each loop measures.


@pytest.mark.parametrize(("period", "ticks"), [(0.01, 10), (0.03, 30), (0.001, 1)])
def test_a_macro_torque_is_held_for_its_own_period(simulated, period, ticks):
    overrides = (f"controller.period.macro={period}", "trajectory=quintic", "noise=thesis", "duration=0.3")
    trace = simulated("robot=combined", *overrides)
    macro, mini = trace.tau[:300, :3], trace.tau[:300, 3:]
    blocks = macro.reshape(-1, ticks, 3)
    np.testing.assert_array_equal(blocks, np.repeat(blocks[:, :1], ticks, axis=1))
    assert (np.diff(blocks[:, 0], axis=0) != 0.0).all()
    assert (np.diff(mini, axis=0) != 0.0).all()


class Recorder:
    """In a controller's place: keeps what it receives."""

    def __init__(self):
        self.calls = []

    def reset(self):
        self.calls = []

    def torque(self, time, q, dq, reference):
        self.calls.append((time, q.copy(), dq.copy()))
        return np.zeros(3)


def recorded(checked_config, *overrides, repetition=0):
    """Let loops of recorders run; return the trace and the calls of each."""
    config = checked_config("robot=combined", "duration=0.3", *overrides)
    closed = assemble(config)
    loops = tuple(dataclasses.replace(loop, controller=Recorder()) for loop in closed.loops)
    closed = dataclasses.replace(closed, loops=loops, compiled=None)
    try:
        trace = simulate(closed, make_encoders(closed, config.noise, config.settings.seed, repetition))
    finally:
        closed.plant.close()
    return trace, [loop.controller.calls for loop in loops]


def test_each_loop_reads_every_joint_afresh_at_its_own_ticks(checked_config):
    trace, (macro, mini) = recorded(checked_config, "noise=thesis")
    assert [call[0] for call in macro] == pytest.approx(np.arange(31) * 0.01)
    assert [call[0] for call in mini] == pytest.approx(np.arange(301) * 0.001)
    noise = [np.array([call[1] for call in calls]) - trace.q[::every] for calls, every in ((macro, 10), (mini, 1))]
    for found in noise:
        assert 0.9e-3 < np.abs(found[:, :3]).max() <= 1e-3
        assert 0.9e-5 < np.abs(found[:, 3:]).max() <= 1e-5 * (1.0 + 1e-9)
        assert len(np.unique(found)) == found.size
    assert np.abs(noise[0] - noise[1][::10]).min() > 0.0  # at the same instant, each its own draw
    for calls, every in ((macro, 10), (mini, 1)):
        np.testing.assert_array_equal([call[2] for call in calls], trace.dq[::every])


def test_each_loop_differences_over_its_own_period(checked_config):
    trace, loops = recorded(checked_config, "noise=thesis", "noise.velocity=finite_difference")
    for calls, period in zip(loops, (0.01, 0.001), strict=True):
        measured, velocity = (np.array([call[index] for call in calls]) for index in (1, 2))
        np.testing.assert_array_equal(velocity[0], 0.0)
        np.testing.assert_allclose(velocity[1:], np.diff(measured, axis=0) / period, rtol=1e-12, atol=1e-12)
    assert trace.failure is None


def test_a_loop_s_noise_does_not_depend_on_the_other_s_ticks(checked_config):
    def mini(*overrides, repetition=0):
        trace, (_, calls) = recorded(checked_config, "noise=thesis", *overrides, repetition=repetition)
        return (np.array([call[1] for call in calls]) - trace.q)[:300]

    first = mini()
    np.testing.assert_allclose(mini("controller.period.macro=0.03"), first, atol=1e-15)
    np.testing.assert_allclose(mini("duration=0.5"), first, atol=1e-15)
    assert np.abs(mini(repetition=1) - first).min() > 0.0
    assert np.abs(mini("seed=1") - first).min() > 0.0
