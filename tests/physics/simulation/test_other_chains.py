"""Chains beyond the thesis' own, each one YAML: a third stage on the Macro and Mini, and a Mini on an xArm7."""

from collections.abc import Callable

import numpy as np
import pinocchio as pin
import pytest
from support import strangers
from support.arms import tip_numbers

from runner.assembly.assemble import assemble
from runner.base.errors import ConfigError
from runner.controllers.macro_mini.macro_mini import later_home_offset
from runner.controllers.macro_mini.stage_loops import MacroController, MiniController, StageLaw
from runner.controllers.operational_space.operational_space import OperationalSpace
from runner.controllers.operational_space.whole_body import WholeBody
from runner.controllers.torque_law import PinocchioArm
from runner.metrics.summary import evaluate
from runner.plugins.metric_units import units
from runner.robots.description import find_urdf, read_urdf
from runner.robots.model import RobotModel
from runner.robots.robot import end_points
from runner.simulation.results import metric_context

CHAINS = ["macro_mini_mini", "xarm7_mini"]
PLANTS = ["default", "rk4"]
XARM7_HOME = np.array([0.0, 0.75, 0.0, 1.5, 0.0, 0.75, 0.0])
NUMBERS = tip_numbers(30.0, 1.0, True, True, 0.3)


@pytest.fixture(scope="module")
def moved(simulated) -> Callable:
    """Simulate a second of an experiment, once each."""
    known = {}

    def make(*overrides: str):
        if overrides not in known:
            known[overrides] = simulated(*overrides, "duration=1")
        return known[overrides]

    return make


@pytest.fixture(scope="module")
def xarm7() -> RobotModel:
    return RobotModel(read_urdf(find_urdf("xarm7.urdf"), {}, armature=0.1), "flange")


def largest_error(trace, stage):
    """Largest axis error of a stage's end point once the start has died away."""
    return np.abs(trace.at_stage(stage).error[trace.t > 0.3]).max()


def settle(model, torque, q, seconds=2.0, tick=1e-3):
    dq = np.zeros(model.nq)
    for _ in range(round(seconds / tick)):
        dq = dq + tick * model.forward_dynamics(q, dq, torque(q, dq))
        q = q + tick * dq
    return q, dq


# The experiments


@pytest.mark.parametrize("plant", PLANTS)
def test_a_mini_on_an_xarm7_makes_up_for_its_errors(moved, plant):
    trace = moved("experiment=staged/xarm7_mini", f"plant={plant}")
    assert trace.failure is None
    assert largest_error(trace, 1) < 0.1 * largest_error(trace, 0)


@pytest.mark.parametrize("plant", PLANTS)
def test_each_of_two_minis_makes_up_for_what_is_left(moved, plant):
    trace = moved("experiment=staged/macro_mini_mini", f"plant={plant}")
    assert trace.failure is None
    macro, mini, tip = (largest_error(trace, stage) for stage in range(3))
    assert mini < 0.8 * macro  # the Mini leaves only the Macro's encoder noise
    assert tip < 0.5 * mini
    assert tip < 0.25 * macro


@pytest.mark.parametrize("plant", PLANTS)
def test_without_noise_each_stage_gains_a_decade(moved, plant):
    trace = moved("experiment=staged/macro_mini_mini", f"plant={plant}", "noise=none")
    macro, mini, tip = (largest_error(trace, stage) for stage in range(3))
    assert mini < 0.1 * macro
    assert tip < 0.3 * mini


@pytest.mark.parametrize("coupling", [pytest.param("one_way", marks=pytest.mark.slow), "two_way"])  # the richer one
def test_where_bases_do_not_turn_three_stages_track_as_where_they_do(moved, coupling):
    apart = ("plant=rk4", "noise=none", "preset.dynamics=decoupled", f"controller.coupling={coupling}")
    turning = moved("experiment=staged/macro_mini_mini", *apart)
    parallel = moved("experiment=staged/macro_mini_mini", *apart, "preset.wrist_rotation=parallel")
    assert largest_error(parallel, 2) < 2.0 * largest_error(turning, 2)


@pytest.mark.parametrize("chain", CHAINS)
def test_the_plants_agree(moved, chain):
    default, rk4 = (moved(f"experiment=staged/{chain}", f"plant={plant}", "noise=none") for plant in PLANTS)
    np.testing.assert_allclose(default.end_points, rk4.end_points, rtol=0, atol=2e-5)


@pytest.mark.parametrize("chain", CHAINS)
def test_no_torque_is_beyond_its_limit(moved, chain):
    far = ("trajectory=goal", "noise=thesis", "torque_limits=thesis", "plant=rk4")
    trace = moved(f"robot={chain}", *far)
    peaks = np.abs(trace.tau).max(axis=0)
    assert (peaks <= trace.limits).all()
    assert (peaks == trace.limits).any()


def test_the_xarm7_stays_within_its_limits(moved, checked_config):
    trace = moved("experiment=staged/xarm7_mini", "plant=default")
    model = checked_config("experiment=staged/xarm7_mini").arm.stages[0].model
    q, dq = trace.q[:, :7], trace.dq[:, :7]
    np.testing.assert_array_equal(trace.limits[:7], model.effort_limits)
    assert (q > model.pin_model.lowerPositionLimit).all()
    assert (q < model.pin_model.upperPositionLimit).all()
    assert (np.abs(dq) < model.pin_model.upperVelocityLimit).all()


def test_the_xarm7_has_its_efforts_where_no_limit_is_asked_for(checked_config):
    assert checked_config("robot=xarm7_mini").torque_limits.max[:7].tolist() == [50, 50, 30, 30, 30, 20, 20]


# The chains


def test_joints_carry_their_stage_s_name(checked_config):
    nine, ten = (checked_config(f"robot={chain}").arm for chain in CHAINS)
    macro = ("q1", "q2", "q3")
    assert nine.model.joint_names == (*macro, *(f"mini_{q}" for q in macro), *(f"mini2_{q}" for q in macro))
    assert ten.model.joint_names == (*(f"joint{i}" for i in range(1, 8)), *(f"mini_{q}" for q in macro))
    assert [stage.base_frame for stage in nine.stages] == [None, "mini_base", "mini2_base"]


def test_at_home_each_mini_stands_as_its_carrier(checked_config):
    arm = checked_config("robot=macro_mini_mini").arm
    points = end_points(arm, arm.home[None])[:, 0]
    np.testing.assert_allclose(points, [[0, 1, 1], [0, 1.1, 1.1], [0, 1.2, 1.2]], atol=1e-15)
    np.testing.assert_allclose(later_home_offset(arm, 1), [0, 0.1, 0.1], atol=1e-15)


def test_at_home_the_mini_hangs_ahead_of_the_xarm7(checked_config):
    arm = checked_config("robot=xarm7_mini").arm
    np.testing.assert_allclose(later_home_offset(arm, 0), [0.1, 0.0, -0.1], atol=1e-12)


@pytest.mark.parametrize("chain", CHAINS)
def test_the_mass_matrix_is_that_of_inverse_dynamics(checked_config, chain):
    model = checked_config(f"robot={chain}").arm.model
    data, rng = model.pin_model.createData(), np.random.default_rng(3)
    for q in rng.uniform(-np.pi, np.pi, (20, model.nq)):
        still = np.zeros(model.nq)
        gravity = pin.rnea(model.pin_model, data, q, still, still).copy()
        columns = [pin.rnea(model.pin_model, data, q, still, unit) - gravity for unit in np.eye(model.nq)]
        np.testing.assert_allclose(model.mass_matrix(q), np.transpose(columns), rtol=0, atol=1e-12)


def test_the_mass_of_the_chain_is_that_of_its_arms(checked_config):
    nine, ten = (checked_config(f"robot={chain}").arm for chain in CHAINS)
    assert nine.model.mass == pytest.approx(2.0 + 0.2 + 0.02, abs=1e-12)
    assert ten.model.mass == pytest.approx(10.4315 + 0.2, abs=1e-12)


def test_each_carrier_has_its_metrics(moved, checked_config):
    overrides = ("experiment=staged/macro_mini_mini", "plant=rk4")
    config = checked_config(*overrides, "duration=1")
    closed = assemble(config)
    values = evaluate(moved(*overrides), metric_context(config))
    closed.plant.close()
    for name in ("max_tracking_error", "rms_tracking_error", "cross_track_error", "settling_time"):
        assert {name, f"macro_{name}", f"mini_{name}"} <= set(values)
        assert f"mini2_{name}" not in values
        assert name in units()


def on_one_chain(cases):
    """Return ways of control with the chain of each in a session: code is compiled for each; the others are slow."""
    return [
        pytest.param(chain, way, marks=() if chain == chosen else pytest.mark.slow)
        for way, chosen in cases.items()
        for chain in CHAINS
    ]


NINE, TEN = CHAINS
COUPLINGS = {"two_way": TEN, "independent": NINE, "independent_base": NINE, "mini_held": NINE}
WAYS = {("controller.schedule=turns",): NINE, ("controller=whole_body", "noise=none"): NINE}


@pytest.mark.parametrize(("chain", "coupling"), on_one_chain(COUPLINGS))
def test_every_coupling_runs(simulated, chain, coupling):
    overrides = (f"experiment=staged/{chain}", "plant=rk4", f"controller.coupling={coupling}", "duration=0.1")
    assert simulated(*overrides).failure is None


@pytest.mark.parametrize(("chain", "changes"), on_one_chain(WAYS))
def test_other_ways_of_control_run(simulated, chain, changes):
    assert simulated(f"experiment=staged/{chain}", "plant=rk4", *changes, "duration=0.1").failure is None


# Targets along a chain of three


class Recorder:
    """A law that records its target, or None for the command to hold."""

    gravity_compensation, parameters = True, ()

    def __init__(self, stage):
        self.model, self.target = stage.model, None

    def move(self, arm, parameters, q, dq, reference, gravity=None):
        self.target = reference[0]
        return np.zeros(3)

    def hold(self, arm, parameters, q, dq, posture, gravity=None):
        self.target = None
        return np.zeros(3)


@pytest.fixture
def bent(checked_config):
    """Nine joints away from home, their end points, and a desired motion 5 cm away from the tip."""
    arm = checked_config("robot=macro_mini_mini").arm
    q = np.array([0.4, -0.3, 0.2, 0.3, 0.2, -0.2, -0.3, 0.2, 0.1])
    points = end_points(arm, q[None])[:, 0]
    desired = np.zeros((3, 3))
    desired[0] = points[-1] + np.array([0.03, 0.0, -0.04])
    return arm, q, points, desired


@pytest.mark.parametrize("stage", [1, 2])
def test_a_rider_s_target_leaves_the_later_ones_at_their_home_offset(bent, stage):
    arm, q, points, desired = bent
    law, later = Recorder(arm.stages[stage]), later_home_offset(arm, stage)
    mini_loop = MiniController(arm, stage, law, "rest", later, False, True, 0.25, False, None)
    mini_loop.torque(0.0, q, np.zeros(9), desired)
    R = arm.model.frame_poses(q, (arm.stages[stage].base_frame,))[0, :3, :3]
    np.testing.assert_allclose(law.target, R.T @ (desired[0] - later - points[stage - 1]), atol=1e-12)


def test_reach_counts_to_the_stage_s_own_target(bent):
    arm, q, points, desired = bent
    law, later = Recorder(arm.stages[1]), later_home_offset(arm, 1)
    assert np.linalg.norm(desired[0] - points[0]) > 0.2 > np.linalg.norm(desired[0] - later - points[0])
    MiniController(arm, 1, law, "rest", later, False, True, 0.2, False, None).torque(0.0, q, np.zeros(9), desired)
    assert law.target is not None
    desired[0] += 0.2
    MiniController(arm, 1, law, "rest", later, False, True, 0.2, False, None).torque(0.0, q, np.zeros(9), desired)
    assert law.target is None
    stretched = MiniController(arm, 1, law, "rest", later, False, True, 0.2, True, None)
    stretched.torque(0.0, q, np.zeros(9), desired)
    assert np.linalg.norm(law.target) == pytest.approx(0.2)


def test_two_way_makes_up_for_where_all_riders_stand(bent):
    arm, q, points, desired = bent
    law = Recorder(arm.stages[0])
    MacroController(arm, law, None, False, 0.2, None).torque(0.0, q, np.zeros(9), desired)
    np.testing.assert_allclose(law.target, desired[0] - (points[-1] - points[0]), atol=1e-12)


# The law of a stage with more than three joints


def move(law, q, dq, reference, gravity=None):
    return law.move(PinocchioArm(law.model, law.gravity_compensation), law.parameters, q, dq, reference, gravity)


def test_three_joints_keep_their_law_to_the_bit(macro):
    law, tip = StageLaw(macro, NUMBERS, np.zeros(3)), OperationalSpace(macro, NUMBERS)
    rng = np.random.default_rng(0)
    for _ in range(3):
        q, dq, reference = rng.normal(size=3), rng.normal(size=3), rng.normal(size=(3, 3))
        np.testing.assert_array_equal(move(law, q, dq, reference), tip.torque(0.0, q, dq, reference))


def test_seven_joints_hold_posture_and_tip(xarm7):
    law = StageLaw(xarm7, NUMBERS, XARM7_HOME)
    reference = np.zeros((3, 3))
    reference[0] = xarm7.tip_position(XARM7_HOME)
    pushed = XARM7_HOME + np.array([0.1, -0.05, 0.1, 0.05, -0.2, 0.1, 0.3])
    q, dq = settle(xarm7, lambda q, dq: move(law, q, dq, reference), pushed)
    np.testing.assert_allclose(q, XARM7_HOME, atol=1e-6)
    np.testing.assert_allclose(dq, 0.0, atol=1e-5)


def test_at_another_tip_position_the_posture_stays_close_to_home(xarm7):
    law = StageLaw(xarm7, NUMBERS, XARM7_HOME)
    reference = np.zeros((3, 3))
    reference[0] = xarm7.tip_position(XARM7_HOME) + np.array([-0.1, 0.1, 0.1])
    q, dq = settle(xarm7, lambda q, dq: move(law, q, dq, reference), XARM7_HOME)
    np.testing.assert_allclose(xarm7.tip_position(q), reference[0], atol=1e-6)
    np.testing.assert_allclose(dq, 0.0, atol=1e-4)
    # The null-space motion is finished: q - home lies in the range of J^T.
    J = xarm7.tip_jacobian(q)[:3]
    wanted = q - XARM7_HOME
    left = wanted - J.T @ np.linalg.lstsq(J.T, wanted, rcond=None)[0]
    assert np.linalg.norm(left) < 1e-4 * np.linalg.norm(wanted)


def test_the_posture_is_the_null_space_s_alone(xarm7):
    """At rest at the goal, wherever the posture, the tip is not pushed."""
    law = StageLaw(xarm7, NUMBERS, XARM7_HOME)
    q = XARM7_HOME + 0.2
    reference = np.zeros((3, 3))
    reference[0] = xarm7.tip_position(q)
    ddq = xarm7.forward_dynamics(q, np.zeros(7), move(law, q, np.zeros(7), reference))
    np.testing.assert_allclose(xarm7.tip_jacobian(q)[:3] @ ddq, 0.0, atol=1e-9)
    assert np.abs(ddq).max() > 1.0


def test_seven_joints_take_another_gravity(xarm7):
    law = StageLaw(xarm7, NUMBERS, XARM7_HOME)
    reference, still = np.zeros((3, 3)), np.zeros(7)
    reference[0] = xarm7.tip_position(XARM7_HOME)
    np.testing.assert_allclose(move(law, XARM7_HOME, still, reference), xarm7.gravity_torque(XARM7_HOME), atol=1e-9)
    arm, none = PinocchioArm(law.model), np.zeros(3)
    for tau in (
        law.move(arm, law.parameters, XARM7_HOME, still, reference, none),
        law.hold(arm, law.parameters, XARM7_HOME, still, XARM7_HOME, none),
    ):
        np.testing.assert_allclose(tau, 0.0, atol=1e-9)


def test_without_gravity_compensation_no_gravity_is_taken(xarm7):
    law = StageLaw(xarm7, tip_numbers(30.0, 1.0, False, True, 0.3), XARM7_HOME)
    reference, still = np.zeros((3, 3)), np.zeros(7)
    reference[0] = xarm7.tip_position(XARM7_HOME)
    tau = move(law, XARM7_HOME, still, reference, np.array([1.0, 2.0, 3.0]))
    np.testing.assert_allclose(tau, 0.0, atol=1e-9)


def test_two_joints_are_too_few():
    two = strangers.chain("two", [("revolute", strangers.X), ("revolute", strangers.Y)])
    model = RobotModel(two, "tip")
    with pytest.raises(ConfigError, match=r"needs 3 joints or more to .*; the arm has 2 \(q1, q2\)"):
        StageLaw(model, NUMBERS, np.zeros(2))


def test_the_joints_whose_posture_is_held_are_chosen(xarm7, checked_config):
    config = checked_config("robot=combined", "controller=whole_body").controller
    still, away = np.zeros(7), XARM7_HOME + np.array([0.3, 0.3, 0.3, 0.0, 0.0, 0.0, 0.0])
    reference = np.zeros((3, 3))
    reference[0] = xarm7.tip_position(away)
    only_later, every = (WholeBody(xarm7, config, XARM7_HOME, first_held=first) for first in (3, 0))
    free, held = (law.torque(0.0, away, still, reference) for law in (only_later, every))
    np.testing.assert_allclose(free, xarm7.gravity_torque(away), atol=1e-9)
    assert np.abs(held - free).max() > 1.0
