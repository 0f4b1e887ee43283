"""Forces of environments on links and joints, by statics, virtual work and energy."""

import re
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from support.engines import ASKED

import runner
from runner.base.errors import ConfigError
from runner.environments import ENVIRONMENTS, Environment
from runner.environments.external_wrench import Interaction
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders, make_wrist_sensor

NOTHING = np.zeros(6)


PUSHED = ("robot=macro", "plant=rk4", "gravity=0", "trajectory=goal", "controller=held_torques", "controller.torques=0",
          "duration=0.05", "environment=push", "environment.force=[0,0,0]")  # fmt: skip


def test_an_impulse_on_the_tip_is_the_change_of_the_joints_momentum(tmp_path):
    J = np.array([0.02, -0.01, 0.03])
    run = runner.run(*PUSHED, f"environment.impulse={J.tolist()}", "environment.start_time=0.02", outputs=tmp_path)
    after = int(np.searchsorted(run.t, 0.03 - 1e-9))
    assert not run.joints("dq")[: after - 1].any()
    q, dq = run.joints("q")[after], run.joints("dq")[after]
    np.testing.assert_allclose(run.model.mass_matrix(q) @ dq, run.model.tip_jacobian(q)[:3].T @ J, rtol=2e-3)


def test_a_random_push_follows_from_seed_and_repetition(tmp_path):
    def pushed(folder, *more):
        shaking = ("environment.noise=3", "environment.bandwidth=50", "environment.start_time=0", "repetitions=2")
        return runner.run(*PUSHED, *shaking, *more, outputs=tmp_path / folder).values("peak_joint_speed")

    first, again, other = pushed("a"), pushed("b"), pushed("a", "seed=1")
    np.testing.assert_array_equal(first, again)
    assert len({*first, *other}) == 4


class Free(Environment):
    def reset(self, tip):
        pass

    def wrench(self, time, tip, velocity):
        return NOTHING


class Pushes(Free):
    def __init__(self, force, points=None, law=None):
        self.points = {"link2": [0.1, -0.2, 0.7]} if points is None else points
        self._force, self._law = np.array(force), law

    def link_forces(self, time, positions, velocities):
        return self._force[None] if self._law is None else self._law(positions, velocities)


class Loads(Free):
    def __init__(self, law):
        self._law = law

    def joint_torques(self, time, q, dq):
        return self._law(time, q, dq)


class Both(Pushes, Loads):
    def __init__(self):
        Pushes.__init__(self, [1.0, 0.0, 0.0])

    def joint_torques(self, time, q, dq):
        return np.full(3, 2.0)


@pytest.fixture
def run_in(checked_config, closed_loop):
    """Run a Macro in an environment; return the trace."""

    def run(environment, *overrides):
        asked = ("robot=macro", "controller=held_torques", "duration=0.3", *overrides)
        config, loop = checked_config(*asked), closed_loop(*asked)
        loop = replace(loop, interaction=Interaction(loop.robot, environment, loop.tick), compiled=None)
        return simulate(
            loop, make_encoders(loop, config.noise, 0, 0), make_wrist_sensor(loop, config.wrist_sensor, 0, 0)
        )

    return run


@pytest.mark.parametrize("link", ["link1", "link2", "link3", "tip"])
def test_torques_of_a_force_do_its_virtual_work(checked_config, link):
    arm = checked_config("robot=macro").arm
    generator = np.random.default_rng(3)
    point, force, q = generator.normal(size=3), generator.normal(size=3), generator.normal(size=3)

    def place(at):
        return arm.model.frame_poses(at, (link,))[0] @ [*point, 1.0]

    interaction = Interaction(arm, Pushes(force, {link: point}), 1e-3)
    interaction.reset(q)
    found = interaction.update(0.0, q, np.zeros(3), NOTHING)
    step = 1e-6
    work = [(place(q + step * e) - place(q - step * e))[:3] @ force / (2.0 * step) for e in np.eye(3)]
    assert found == pytest.approx(np.array(work), abs=1e-7)


def test_it_is_told_where_its_points_are_and_how_fast(checked_config):
    arm, seen = checked_config("robot=macro").arm, {}

    def law(positions, velocities):
        seen.update(positions=positions, velocities=velocities)
        return np.zeros((2, 3))

    interaction = Interaction(arm, Pushes([], {"link3": [0.0, 0.1, 0.2], "link1": [0.3, 0.0, 0.0]}, law), 1e-3)
    q, dq, step = np.array([0.3, -0.5, 0.8]), np.array([0.7, -1.1, 0.4]), 1e-6
    interaction.reset(q)
    interaction.update(0.0, q, dq, NOTHING)
    after, before = (
        np.array([arm.model.frame_poses(q + way * step * dq, (link,))[0] @ [*point, 1.0] for link, point in (
            ("link3", [0.0, 0.1, 0.2]), ("link1", [0.3, 0.0, 0.0]))])[:, :3]
        for way in (1.0, -1.0)
    )  # fmt: skip
    assert seen["positions"] == pytest.approx((after + before) / 2.0, abs=1e-9)
    assert seen["velocities"] == pytest.approx((after - before) / (2.0 * step), abs=1e-7)


@pytest.mark.parametrize("plant", ["rk4", ASKED.removeprefix("plant="), "mujoco"])
def test_torques_that_bear_the_weight_of_an_arm_hold_it(run_in, checked_config, plant):
    model = checked_config("robot=macro").arm.model

    def bear(time, q, dq):
        return model.gravity_torque(q)

    trace = run_in(Loads(bear), f"plant={plant}")
    assert trace.failure is None
    assert np.ptp(trace.q, axis=0) == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize("plant", ["rk4", ASKED.removeprefix("plant=")])
def test_a_torque_at_a_joint_accelerates_as_the_equations_of_motion_say(run_in, checked_config, plant):
    model = checked_config("robot=macro").arm.model
    load = np.array([2.0, -1.0, 0.5])
    trace = run_in(Loads(lambda time, q, dq: load), f"plant={plant}", "duration=0.02", "controller.period=0.001")
    expected = model.forward_dynamics(trace.q[0], np.zeros(3), load)
    tick = trace.t[1]
    assert trace.dq[1] / tick == pytest.approx(expected, rel=2e-3)


def test_both_add_up(checked_config):
    arm = checked_config("robot=macro").arm
    q = arm.home
    sums = []
    for environment in (Pushes([1.0, 0.0, 0.0]), Loads(lambda *_: np.full(3, 2.0)), Both()):
        interaction = Interaction(arm, environment, 1e-3)
        interaction.reset(q)
        sums.append(interaction.update(0.0, q, np.zeros(3), NOTHING))
    assert sums[2] == pytest.approx(sums[0] + sums[1])


def test_an_environment_without_points_pushes_nothing(checked_config):
    arm = checked_config("robot=macro").arm
    interaction = Interaction(arm, Pushes([], {}, lambda positions, velocities: -velocities), 1e-3)
    interaction.reset(arm.home)
    assert interaction.update(0.0, arm.home, np.ones(3), NOTHING).tolist() == [0.0, 0.0, 0.0]


def test_a_link_that_is_not_there(checked_config):
    with pytest.raises(ConfigError, match=r"pushes the link 'lnk2'.* \(did you mean link2\?\); links: base, link1"):
        Interaction(checked_config("robot=macro").arm, Pushes([], {"lnk2": [0.0, 0.0, 0.0]}), 1e-3)


@pytest.mark.parametrize(
    ("environment", "reason"),
    [
        (
            Pushes([1.0, 2.0]),
            r"Pushes.link_forces \(test_external_wrench.py, line \d+\) gave an array of shape \(1, 2\)",
        ),
        (Pushes([np.nan, 0.0, 0.0]), r"Pushes.link_forces .* gave nan at index \[0, 0\]; it must be finite"),
        (Loads(lambda *_: np.zeros(2)), r"Loads.joint_torques .* gave an array of shape \(2,\)"),
        (Loads(lambda *_: 1 / 0), r"ZeroDivisionError: division by zero \(test_external_wrench.py, line \d+"),
    ],
    ids=["shape of forces", "nan", "shape of torques", "raises"],
)
def test_what_goes_wrong_ends_the_run_with_the_place(run_in, environment, reason):
    trace = run_in(ENVIRONMENTS.guard(environment))
    assert trace.failure.time == 0.0
    assert re.search(reason, trace.failure.reason), trace.failure.reason


@pytest.mark.parametrize("argument", [1, 2])
def test_what_it_is_handed_cannot_be_changed(run_in, argument):
    def write(*handed):
        handed[argument][:] = 1.0

    trace = run_in(ENVIRONMENTS.guard(Loads(write)))
    assert re.search(r"read-only \(test_external_wrench.py, line \d+, in write\)", trace.failure.reason)
    trace = run_in(ENVIRONMENTS.guard(Pushes([], None, lambda *handed: write(None, *handed))))
    assert re.search(r"read-only \(test_external_wrench.py, line \d+, in write\)", trace.failure.reason)


@pytest.mark.parametrize("points", [{"link2": [0.0, 1.0]}, {"link2": [np.inf, 0.0, 0.0]}, 5])
def test_points_that_are_none(checked_config, points):
    with pytest.raises(ConfigError, match=r"environment.kind: its points?"):
        Interaction(checked_config("robot=macro").arm, ENVIRONMENTS.guard(Pushes([], points)), 1e-3)


def test_the_guarded_offer_what_is_within_and_defaults_for_the_rest():
    class Duck:
        reset, wrench = Free.reset, Free.wrench

    bare, both = ENVIRONMENTS.guard(Duck()), ENVIRONMENTS.guard(Both())
    assert (dict(bare.points), bare.joint_torques(0.0, np.zeros(3), np.zeros(3))) == ({}, None)
    assert list(both.points) == ["link2"]
    assert both.joint_torques(0.0, np.zeros(3), np.zeros(3)).tolist() == [2.0, 2.0, 2.0]


def test_pinocchio_agrees_on_the_point(checked_config):
    """The same by a frame of Pinocchio's own that is put on the point."""
    model = checked_config("robot=macro").arm.model.copy()
    point, force, q = np.array([0.1, 0.2, 0.3]), np.array([3.0, -1.0, 2.0]), np.array([0.3, -0.5, 0.8])
    body = model.pin_model.frames[model.pin_model.getFrameId("link3")]
    frame = pin.Frame("point", body.parentJoint, body.placement * pin.SE3(np.eye(3), point), pin.FrameType.OP_FRAME)
    data = (added := pin.Model(model.pin_model)).addFrame(frame) and added.createData()
    J = pin.computeFrameJacobian(added, data, q, added.getFrameId("point"), pin.LOCAL_WORLD_ALIGNED)
    interaction = Interaction(checked_config("robot=macro").arm, Pushes(force, {"link3": point}), 1e-3)
    interaction.reset(q)
    assert interaction.update(0.0, q, np.zeros(3), NOTHING) == pytest.approx(J[:3].T @ force)
