"""Model error of controllers: each term by its effect against a closed form."""

import numpy as np
import pinocchio as pin
import pytest

from runner.assembly.assemble import assemble
from runner.robots.mismatch import MismatchConfig, build
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders
from runner.sweeps.job import run

WN = 20.0  # rad/s
SAGGING = (
    "robot=macro",
    "plant=rk4",
    "trajectory.start=[0.7,0.6,1.2]",
    "trajectory.goal=[0.7,0.6,1.2]",
    f"controller.natural_frequency={WN}",
    "controller.singularity_damping=0",
)
NO_DIFFERENCE = {"mass": 1.0, "centre_of_mass": 1.0, "length": 1.0, "gravity": 1.0, "payload": 0.0, "spread": 0.0}
NO_DIFFERENCE |= {"link": {}}


def nominal_of(robot, seed=0, **terms):
    config = MismatchConfig(**(NO_DIFFERENCE | terms))
    return build(config, robot, np.random.default_rng(seed))


@pytest.fixture(scope="module")
def sag(simulated, checked_config):
    """Hold the Macro still under gravity; return the last error and joint positions, and the true arm's model."""

    def hold(*overrides):
        trace = simulated(*SAGGING, *overrides)
        assert np.abs(trace.dq[-1]).max() < 1e-6
        return trace.error[-1], trace.q[-1], checked_config(*SAGGING, *overrides).arm.model

    return hold


def predicted_sag(model, q, M, G):
    r"""Rest of M J^-1 wn^2 e + G_believed = G_true."""
    return model.tip_jacobian(q)[:3] @ np.linalg.solve(M, model.gravity_torque(q) - G) / WN**2


def test_without_difference_it_is_the_robot_itself(combined):
    assert nominal_of(combined) is combined


def test_with_the_right_model_nothing_sags(sag):
    assert np.abs(sag()[0]).max() < 1e-9


@pytest.mark.parametrize("factor", [0.0, 0.8, 1.2])
def test_gravity_believed_wrong_lets_the_tip_sag_by_what_is_missing(sag, factor):
    error, q, model = sag(f"mismatch.gravity={factor}")
    M, G = model.mass_matrix(q), model.gravity_torque(q)
    np.testing.assert_allclose(error, predicted_sag(model, q, M, factor * G), atol=1e-8)
    assert np.abs(error).max() > 1e-3


@pytest.mark.parametrize("factor", [0.8, 1.3])
def test_masses_believed_wrong_scale_inertia_and_weight_alike(sag, factor):
    error, q, model = sag(f"mismatch.mass={factor}")
    M, G = model.mass_matrix(q), model.gravity_torque(q)
    np.testing.assert_allclose(error, predicted_sag(model, q, factor * M, factor * G), atol=1e-8)
    assert np.abs(error).max() > 1e-3


def test_mass_and_gravity_believed_wrong_the_opposite_way_cancel_in_the_weight(sag):
    assert np.abs(sag("mismatch.mass=1.25", "mismatch.gravity=0.8")[0]).max() < 1e-9


@pytest.mark.parametrize("payload", [-1.5, 0.5])
def test_a_payload_believed_wrong_is_a_weight_at_the_tip(sag, payload):
    error, q, model = sag("robot.payload.mass=1.5", f"mismatch.payload={payload}")
    J = model.tip_jacobian(q)[:3]
    M, G = model.mass_matrix(q), model.gravity_torque(q)
    M, G = M + payload * J.T @ J, G - payload * J.T @ model.gravity
    np.testing.assert_allclose(error, predicted_sag(model, q, M, G), atol=1e-8)
    assert np.abs(error).max() > 1e-3


def test_a_payload_that_is_not_known_of_leaves_the_arm_without_it(checked_config):
    place = "robot.payload.position=[0.1,0.2,0.3]"
    loaded, bare = (checked_config("robot=xarm7", f"robot.payload.mass={mass}", place).arm for mass in (2.0, 0.0))
    config = MismatchConfig(**(NO_DIFFERENCE | {"payload": -2.0}))
    unaware = build(config, loaded, np.random.default_rng(0)).model
    q = np.linspace(-1.0, 1.0, 7)
    np.testing.assert_allclose(unaware.mass_matrix(q), bare.model.mass_matrix(q), atol=1e-12)
    np.testing.assert_allclose(unaware.gravity_torque(q), bare.model.gravity_torque(q), atol=1e-12)


@pytest.mark.parametrize("factors", [(1.3, 1.0, 1.0), (1.0, 1.2, 1.0), (1.0, 1.0, 2.0), (0.8, 0.7, 1.5)], ids=str)
def test_one_link_believed_wrong_changes_its_own_share_of_inertia_and_weight(sag, factors):
    mass, centre, inertia = factors
    link = f"mismatch.link.link2={{mass: {mass}, centre_of_mass: {centre}, inertia: {inertia}}}"
    error, q, model = sag(link)
    M, G = link_by_link(model, q, mass=[1.0, mass, 1.0], centre=[1.0, centre, 1.0], inertia=[1.0, inertia, 1.0])
    np.testing.assert_allclose(error, predicted_sag(model, q, M, G), atol=1e-8)
    assert (np.abs(error).max() > 1e-3) == (mass * centre != 1.0)


def test_inertia_about_the_centre_of_mass_changes_the_mass_matrix_and_no_weight(checked_config, macro):
    arm = nominal_of(checked_config("robot=macro").arm, link={"link3": {"inertia": 1.7}}).model
    q, ones = np.array([0.3, -0.5, 1.0]), np.ones(3)
    M, G = link_by_link(macro, q, ones, ones, [1.0, 1.0, 1.7])
    np.testing.assert_allclose(arm.mass_matrix(q), M, atol=1e-13)
    np.testing.assert_allclose(arm.gravity_torque(q), macro.gravity_torque(q), atol=1e-13)
    np.testing.assert_allclose(G, macro.gravity_torque(q), atol=1e-13)


def link_by_link(model, q, mass, centre, inertia):
    """M and G as sums of J^T M J over the links, with factors on mass, lever and inertia about the centre of mass."""
    M, G = np.zeros((model.nq, model.nq)), np.zeros(model.nq)
    data = model.pin_model.createData()
    pin.computeJointJacobians(model.pin_model, data, q)
    for joint, (m, c, i) in enumerate(zip(mass, centre, inertia, strict=True), start=1):
        body, R = model.pin_model.inertias[joint], data.oMi[joint].rotation
        J = pin.getJointJacobian(model.pin_model, data, joint, pin.LOCAL_WORLD_ALIGNED)
        at_centre = J[:3] - pin.skew(R @ (c * body.lever)) @ J[3:]
        M += m * (body.mass * at_centre.T @ at_centre + i * J[3:].T @ R @ body.inertia @ R.T @ J[3:])
        G -= m * body.mass * at_centre.T @ model.gravity
    return M, G


def test_a_centre_of_mass_believed_wrong_shifts_the_weight_along_the_link(sag, checked_config):
    error, q, model = sag("mismatch.centre_of_mass=1.1")
    M, G = link_by_link(model, q, np.ones(3), np.full(3, 1.1), np.ones(3))
    np.testing.assert_allclose(error, predicted_sag(model, q, M, G), atol=1e-8)
    assert np.abs(error).max() > 1e-3


@pytest.mark.parametrize("factor", [0.95, 1.05])
def test_lengths_believed_wrong_scale_where_the_tip_comes_to_rest(simulated, factor):
    """The controller brings the tip of its model, k x, to the goal."""
    goal = np.array([0.5, 0.1, 0.2])
    trace = simulated(
        "robot=xarm7",
        "trajectory=quintic",
        "trajectory.start=null",
        f"trajectory.goal={goal.tolist()}",
        "trajectory.duration=1",
        "duration=3",
        f"mismatch.length={factor}",
    )
    np.testing.assert_allclose(factor * trace.tip[-1], goal, atol=1e-6)


def test_lengths_scale_kinematics_and_leave_each_link_its_weight(xarm7):
    q = np.linspace(-1.0, 1.0, 7)
    longer = nominal_of(xarm7, length=1.2).model
    np.testing.assert_allclose(longer.tip_position(q), 1.2 * xarm7.model.tip_position(q), atol=1e-12)
    assert longer.reach == pytest.approx(1.2 * xarm7.model.reach)
    np.testing.assert_allclose(longer.shoulder, 1.2 * xarm7.model.shoulder)
    assert longer.mass == pytest.approx(xarm7.model.mass)


def test_servos_believe_what_controllers_do(simulated, checked_config):
    """K (q_c - q) = (1 + A M^-1) (G - k G), A = h D + h^2 K: the servo relies on its predicted motion."""
    still = ("robot=xarm7", "trajectory=goal", "trajectory.start=null", "trajectory.goal=[0.604294,0,0.150872]")
    held = ("controller.gain=0", "controller.null_space.task=none", "plant=rk4", "mismatch.gravity=0.9", "duration=3")
    trace = simulated(*still, *held)
    arm = checked_config(*still).arm
    M, G = arm.model.mass_matrix(trace.q[-1]), arm.model.gravity_torque(trace.q[-1])
    A = np.diag(1e-3 * 2.0 * np.sqrt(1500.0 * np.diagonal(arm.model.mass_matrix(arm.home))) + 1e-6 * 1500.0)
    expected = 0.1 * (G + A @ np.linalg.solve(M, G))
    np.testing.assert_allclose(1500.0 * (trace.q_command - trace.q)[-1], expected, atol=1e-6)
    assert np.abs(G).max() > 1.0


def test_the_wrist_believes_in_a_tool_of_the_mass_that_the_link_is_believed_to_have(simulated):
    """At rest, nothing touched: what is felt is the weight of tool that is not taken off, 0.25 kg of it."""
    still = ("robot=meca500", "trajectory.start=null", "trajectory.goal=[0.18795,0,0.0592]", "duration=0.02")
    trace = simulated(*still, "mismatch.mass=0.6")
    np.testing.assert_allclose(trace.contact.felt[1, :3], [0.0, 0.0, -0.4 * 0.25 * 9.81], atol=1e-9)


def test_what_is_measured_is_the_true_arm(simulated, checked_config):
    trace = simulated("robot=macro", "trajectory=quintic", "mismatch.length=1.1", "mismatch.mass=2", "duration=0.5")
    true = checked_config("robot=macro").arm.model.tip_positions(trace.q)
    np.testing.assert_allclose(trace.tip, true, rtol=0.0, atol=1e-15)


@pytest.mark.parametrize("term", ["mass", "centre_of_mass"])
def test_drawn_errors_stay_within_their_spread_and_differ_from_link_to_link(xarm7, term):
    def ratio(seed):
        nominal, true = (robot.model.pin_model.inertias for robot in (nominal_of(xarm7, seed, spread=0.2), xarm7))
        pairs = list(zip(list(nominal)[1:], list(true)[1:], strict=True))
        if term == "mass":
            return np.array([b.mass / t.mass for b, t in pairs])
        return np.array([np.linalg.norm(b.lever) / np.linalg.norm(t.lever) for b, t in pairs])

    ratios = np.array([ratio(seed) for seed in range(200)])
    assert np.abs(ratios - 1.0).max() <= 0.2 + 1e-12
    assert ratios.std() == pytest.approx(0.2 / np.sqrt(3.0), rel=0.05)
    assert np.abs(np.corrcoef(ratios.T) - np.eye(7)).max() < 4.0 / np.sqrt(200)
    np.testing.assert_array_equal(ratio(3), ratios[3])


def test_the_whole_and_its_stages_are_believed_alike(combined):
    robot = nominal_of(combined, mass=1.2, centre_of_mass=0.9, length=1.1, gravity=0.7, payload=0.05, spread=0.1)
    mini, whole = robot.stages[1].model, robot.model
    for own, within in zip(list(mini.pin_model.inertias)[1:], list(whole.pin_model.inertias)[4:], strict=True):
        np.testing.assert_allclose(own.toDynamicParameters(), within.toDynamicParameters(), atol=1e-12)
    np.testing.assert_allclose(robot.stages[0].model.gravity, whole.gravity)
    home = robot.stages[0].model.tip_position(np.zeros(3))
    np.testing.assert_allclose(home, 1.1 * combined.stages[0].model.tip_position(np.zeros(3)), atol=1e-12)


def test_each_repetition_draws_anew_from_seed_and_repetition_alone(checked_config, tmp_path):
    overrides = ("robot=macro", "trajectory=quintic", "mismatch=sampled", "noise=thesis", "duration=0.3")
    config = checked_config(*overrides)

    def trace(repetition):
        closed = assemble(config, repetition)
        try:
            return simulate(closed, make_encoders(closed, config.noise, config.settings.seed, repetition))
        finally:
            closed.plant.close()

    values = run(*overrides, "repetitions=3", f"outputs={tmp_path}").metrics["peak_torque"].values
    assert list(values) == [float(np.abs(trace(repetition).tau).max()) for repetition in range(3)]
    assert len(set(values)) == 3
    first, again = trace(2), trace(2)
    np.testing.assert_array_equal(first.q, again.q)


def test_beliefs_leave_the_noise_alone(checked_config):
    def reading(*overrides):
        config = checked_config("robot=macro", "noise=thesis", *overrides)
        closed = assemble(config)
        closed.plant.close()
        (sensor,) = make_encoders(closed, config.noise, config.settings.seed, 0)
        return sensor.measure(0, np.zeros(3), np.zeros(3))[0]

    np.testing.assert_array_equal(reading("mismatch=sampled"), reading())


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (("mismatch.mass=0",), "mismatch.mass: must be above 0; found 0"),
        (("mismatch.length=-1",), "mismatch.length: must be above 0; found -1"),
        (("mismatch.gravity=-1",), "mismatch.gravity: must be 0 or more; found -1"),
        (("mismatch.spread=1",), "mismatch.spread: must be below 1; found 1"),
        (("mismatch.lenght=1.1",), "mismatch.lenght: unknown key (did you mean length?)"),
        (("mismatch=some",), "mismatch: no 'some' (did you mean sampled?); known: none, sampled"),
        (("mismatch.link.link2.mass=0",), "mismatch.link.link2.mass: must be above 0; found 0"),
        (("mismatch.link.link2.mas=1",), "mismatch.link.link2.mas: unknown key (did you mean mass?)"),
        (
            ("mismatch.link.lin2.mass=1.1",),
            "mismatch.link.lin2: no such moving link (did you mean link2?); moving links: link1, link2, link3",
        ),
        (
            ("mismatch.payload=-2", "robot.payload.mass=1.5"),
            "mismatch.payload: -2 kg is less than nothing of the true payload, robot.payload.mass with 1.5 kg; "
            "allowed: -1.5 or more",
        ),
    ],
    ids=["mass", "length", "gravity", "spread", "key", "group", "link_mass", "link_key", "link", "payload"],
)
def test_beliefs_that_cannot_be(cli, overrides, message):
    ending = cli("robot=macro", *overrides)
    assert ending.code == 2
    assert message in ending.err
