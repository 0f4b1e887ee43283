"""Stage-wise control: what each coupling asks of the Macro and of the Mini, and what comes of it."""

import numpy as np
import pytest
from support.covers import covered

from runner.base.errors import ConfigError
from runner.controllers import CONTROLLERS
from runner.controllers.macro_mini import macro_mini
from runner.robots.robot import end_points

P = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # from the Mini's base into the Macro's tip frame
R_0 = np.array([0.0, 0.1, 0.1])
COUPLINGS = ("one_way", "two_way", "independent", "independent_base", "mini_held")
TARGETS = {"coupling": COUPLINGS, "macro_target": ("minus_home", "tip_goal"), "wrist_rotation": ("real", "parallel")}


class Spy:
    """In a stage's law's place: keeps what it receives."""

    def __init__(self, model, law, home):
        self.model, self.feedforward = model, law.feedforward
        self.parameters = (law.natural_frequency, law.damping_ratio, law.gravity_compensation)
        self.gravity_compensation = law.gravity_compensation
        self.gravity, self.told = None, []

    def move(self, arm, parameters, q, dq, reference, gravity=None):
        self.gravity = gravity
        self.told.append(("move", q.copy(), np.array(reference)))
        return np.zeros(3)

    def hold(self, arm, parameters, q, dq, posture, gravity=None):
        self.gravity = gravity
        self.told.append(("hold", q.copy(), np.array(posture)))
        return np.zeros(3)


@pytest.fixture
def spied(monkeypatch, checked_config):
    """Build the loops that overrides ask for, with a spy instead of each stage's law."""

    def make(*overrides):
        config = checked_config("robot=combined", *overrides)
        monkeypatch.setattr(macro_mini, "StageLaw", Spy)
        loops = CONTROLLERS.build(config.controller, config.arm)
        monkeypatch.undo()
        return loops, [loop.controller._law for loop in loops], config.arm

    return make


def random_states(count=6, seed=0, reach=0.15):
    """States of the arm, and a desired motion of the tip within the Mini's reach."""
    generator = np.random.default_rng(seed)
    for _ in range(count):
        q, dq = generator.uniform(-np.pi, np.pi, 6), generator.uniform(-1.0, 1.0, 6)
        way = generator.normal(size=3)
        yield q, dq, way * reach / np.linalg.norm(way), generator.uniform(-1.0, 1.0, (2, 3))


def place(arm, q, parallel=False):
    """Place of the Macro's end point, and the Mini's orientation."""
    pose = arm.stages[0].model.tip_pose(q[:3])
    return pose[:3, 3], np.eye(3) if parallel else pose[:3, :3] @ P


def ask(loop, law, q, dq, reference, time=0.0):
    loop.controller.torque(time, q, dq, np.array(reference))
    return law.told[-1]


# Targets.


@pytest.mark.parametrize("case", covered(TARGETS))
def test_the_macro_s_target(spied, case):
    coupling, macro_target, wrist_rotation = case.values()
    loops, laws, arm = spied(*(f"controller.{key}={value}" for key, value in case.items()))
    for q, dq, way, derivatives in random_states():
        x_E, R = place(arm, q, wrist_rotation == "parallel")
        reference = np.vstack([x_E + way, derivatives])
        kind, own, target = ask(loops[0], laws[0], q, dq, reference)
        offset = {
            "one_way": R_0 if macro_target == "minus_home" else np.zeros(3),
            "two_way": R @ arm.stages[1].model.tip_position(q[3:]),
            "independent": R_0,
            "independent_base": R_0,
            "mini_held": R_0,
        }[coupling]
        assert kind == "move"
        np.testing.assert_array_equal(own, q[:3])
        np.testing.assert_allclose(target[0], reference[0] - offset, atol=1e-12)
        np.testing.assert_array_equal(target[1:], reference[1:])


@pytest.mark.parametrize("coupling", ["one_way", "two_way"])
@pytest.mark.parametrize("wrist_rotation", ["real", "parallel"])
def test_the_mini_makes_up_for_the_rest_of_the_way(spied, coupling, wrist_rotation):
    loops, laws, arm = spied(f"controller.coupling={coupling}", f"controller.wrist_rotation={wrist_rotation}")
    for q, dq, way, derivatives in random_states():
        x_E, R = place(arm, q, wrist_rotation == "parallel")
        kind, own, target = ask(loops[1], laws[1], q, dq, np.vstack([x_E + way, derivatives]))
        assert kind == "move"
        np.testing.assert_array_equal(own, q[3:])
        np.testing.assert_allclose(target[0], R.T @ way, atol=1e-12)


def test_the_independent_mini_keeps_its_home_offset(spied):
    loops, laws, arm = spied("controller.coupling=independent")
    for q, dq, way, derivatives in random_states(reach=0.5):  # whatever its reach
        reference = np.vstack([place(arm, q)[0] + way, derivatives])
        kind, _, target = ask(loops[1], laws[1], q, dq, reference)
        assert kind == "move"
        np.testing.assert_allclose(target[0], R_0, atol=1e-15)
        np.testing.assert_array_equal(target[1:], 0.0)


@pytest.mark.parametrize("wrist_rotation", ["real", "parallel"])
@pytest.mark.parametrize("velocity", ["full", "zero"])
def test_the_mini_may_keep_its_home_offset_in_the_base_frame(spied, wrist_rotation, velocity):
    loops, laws, arm = spied(
        "controller.coupling=independent_base",
        f"controller.wrist_rotation={wrist_rotation}",
        f"controller.mini_reference_velocity={velocity}",
    )
    h = 1e-5
    for q, dq, way, derivatives in random_states(reach=0.5):  # whatever its reach
        reference = np.vstack([place(arm, q)[0] + way, derivatives])
        before, (kind, _, target), after = (ask(loops[1], laws[1], q + t * dq, dq, reference) for t in (-h, 0.0, h))
        assert kind == "move"
        np.testing.assert_allclose(target[0], place(arm, q, wrist_rotation == "parallel")[1].T @ R_0, atol=1e-12)
        moved = (after[2][0] - before[2][0]) / (2.0 * h)
        np.testing.assert_allclose(target[1], moved if velocity == "full" else 0.0, atol=1e-7)
        np.testing.assert_array_equal(target[2], 0.0)


def test_where_the_wrist_is_taken_parallel_both_frames_of_the_offset_are_one(simulated):
    common = (*TRACKED, "preset=as_reported", "duration=0.5")
    own, base = (simulated(*common, f"controller.coupling={c}") for c in ("independent", "independent_base"))
    np.testing.assert_allclose(own.q, base.q, atol=1e-9)


def test_with_the_offset_kept_in_the_base_frame_the_tip_misses_by_what_the_macro_misses(simulated, combined):
    own, base = (simulated(*TRACKED, f"controller.coupling={c}") for c in ("independent", "independent_base"))
    missed = base.at_stage(0).error
    np.testing.assert_allclose(base.error[-1], missed[-1], atol=1e-6)
    assert np.abs(base.error - missed).max() < 0.02 * np.abs(missed).max()
    turn = R_0 - place(combined, own.q[-1])[1] @ R_0  # in its own frame the offset turns with the wrist
    np.testing.assert_allclose(own.error[-1] - own.at_stage(0).error[-1], turn, atol=1e-5)
    assert np.abs(turn).max() > 50.0 * np.abs(base.error[-1]).max()


def test_the_held_mini_holds_its_joints_at_home(spied):
    loops, laws, arm = spied("controller.coupling=mini_held")
    for q, dq, way, derivatives in random_states(reach=0.5):
        reference = np.vstack([place(arm, q)[0] + way, derivatives])
        kind, own, posture = ask(loops[1], laws[1], q, dq, reference)
        assert kind == "hold"
        np.testing.assert_array_equal(own, q[3:])
        np.testing.assert_array_equal(posture, np.zeros(3))


@pytest.mark.parametrize("wrist_rotation", ["real", "parallel"])
def test_the_full_reference_velocity_is_that_of_the_target(spied, wrist_rotation):
    loops, laws, arm = spied(f"controller.wrist_rotation={wrist_rotation}", "controller.mini_reference_velocity=full")
    h, velocities = 1e-5, []
    for q, dq, way, derivatives in random_states():
        reference = np.vstack([place(arm, q)[0] + way, derivatives])
        targets = []
        for t in (-h, 0.0, h):
            moved = reference.copy()
            moved[0] += t * reference[1]
            targets.append(ask(loops[1], laws[1], q + t * dq, dq, moved)[2])
        difference = (targets[2][0] - targets[0][0]) / (2.0 * h)
        np.testing.assert_allclose(targets[1][1], difference, atol=1e-7)
        velocities.append(np.abs(difference).max())
        # And as written: R^T (xd_d - xd_E - w x (x_d - x_E)).
        J = arm.stages[0].model.tip_jacobian(q[:3]) @ dq[:3]
        spin = np.zeros(3) if wrist_rotation == "parallel" else J[3:]
        R = place(arm, q, wrist_rotation == "parallel")[1]
        np.testing.assert_allclose(targets[1][1], R.T @ (reference[1] - J[:3] - np.cross(spin, way)), atol=1e-12)
    assert min(velocities) > 0.05


def test_a_series_of_goals_has_no_velocity(spied):
    loops, laws, arm = spied("controller.mini_reference_velocity=zero")
    assert (laws[0].feedforward, laws[1].feedforward) == (True, False)
    for q, dq, way, derivatives in random_states():
        target = ask(loops[1], laws[1], q, dq, np.vstack([place(arm, q)[0] + way, derivatives]))[2]
        np.testing.assert_array_equal(target[1:], 0.0)


@pytest.mark.parametrize("coupling", COUPLINGS)
@pytest.mark.parametrize("wrist_rotation", ["real", "parallel"])
def test_the_mini_knows_gravity_as_its_base_sees_it(spied, coupling, wrist_rotation):
    loops, laws, arm = spied(f"controller.coupling={coupling}", f"controller.wrist_rotation={wrist_rotation}")
    for q, dq, way, derivatives in random_states():
        x_E, R = place(arm, q, wrist_rotation == "parallel")
        ask(loops[1], laws[1], q, dq, np.vstack([x_E + way, derivatives]))
        np.testing.assert_allclose(laws[1].gravity, R.T @ [0.0, 0.0, -9.81], atol=1e-12)
    assert laws[0].gravity is None  # the Macro is on the ground


def test_each_stage_gets_its_own_numbers(spied):
    loops, laws, _ = spied("controller.natural_frequency.mini=200", "controller.gravity_compensation=false")
    assert [law.parameters for law in laws] == [(30.0, 1.0, False), (200.0, 1.0, False)]
    assert [(loop.name, loop.joints, loop.period) for loop in loops] == [
        ("macro", slice(0, 3), 0.01),
        ("mini", slice(3, 6), 0.001),
    ]


@pytest.mark.parametrize(("payload", "mass"), [("unknown", 2.0), ("known", 2.2)])
def test_a_known_payload_is_the_mini_s_mass(spied, payload, mass):
    _, laws, _ = spied(f"controller.payload={payload}")
    assert laws[0].model.mass == pytest.approx(mass)
    assert laws[1].model.mass == pytest.approx(0.2)


def test_one_stage_has_nothing_to_couple(checked_config):
    with pytest.raises(ConfigError, match=r"macro_mini couples stages and the robot has one \(macro\)"):
        checked_config("robot=macro", "controller=macro_mini")


# Closed loops.

TRACKED = ("robot=combined", "trajectory=quintic", "trajectory.duration=3", "duration=3", "torque_limits=thesis")


def alone(goal, step, *overrides):
    shifted = (np.array(goal) - R_0).tolist()
    return (
        "robot=macro",
        f"plant.step={step}",
        "trajectory=quintic",
        f"trajectory.goal={shifted}".replace(" ", ""),
        "trajectory.duration=3",
        "duration=3",
        "torque_limits=thesis",
        *overrides,
    )


@pytest.mark.parametrize("preset", ["full_equations", "as_reported"])
@pytest.mark.parametrize("plant", ["bullet", "rk4"])
def test_with_the_mini_held_the_macro_is_the_macro_alone(simulated, checked_config, preset, plant):
    # Decoupled, and without singularity damping: it is scaled by the distance to x_d, and that is one rounding off.
    common = (f"preset={preset}", f"plant={plant}", "controller.singularity_damping=0")
    goal = checked_config("robot=combined").path.goal.tolist()
    both = simulated(*TRACKED, "controller.coupling=mini_held", "plant.dynamics=decoupled", "plant.step=1e-3", *common)
    single = simulated(*alone(goal, "1e-3"), *common)
    np.testing.assert_allclose(both.q[::10, :3], single.q, atol=1e-9)
    np.testing.assert_allclose(both.tau[::10, :3], single.tau, atol=1e-6)
    np.testing.assert_allclose(both.at_stage(0).error[::10], single.error, atol=1e-9)


def test_the_independent_mini_does_much_the_same_as_the_held_one(simulated):
    held, independent = (simulated(*TRACKED, f"controller.coupling={c}") for c in ("mini_held", "independent"))
    apart = np.linalg.norm(held.tip - independent.tip, axis=1).max()
    assert 0.0 < apart < 0.02 * np.abs(held.error).max()
    decoupled = [
        simulated(*TRACKED, f"controller.coupling={c}", "plant.dynamics=decoupled")
        for c in ("mini_held", "independent")
    ]
    np.testing.assert_array_equal(decoupled[0].q[:, :3], decoupled[1].q[:, :3])


def test_a_known_payload_lets_the_macro_sink_less(simulated, combined, macro):
    def sag(payload, model):
        trace = simulated(
            "robot=combined",
            "controller.coupling=mini_held",
            f"controller.payload={payload}",
            "trajectory=quintic",
            "trajectory.goal=[0.3,0.9,1.2]",
            "trajectory.duration=1",
            "duration=3",
        )
        assert np.abs(trace.dq[-1]).max() < 1e-6
        q = trace.q[-1]
        # The sag from the unknown part of the Mini's weight: J M^-1 (G - G_known) / omega_n^2.
        missing = combined.model.gravity_torque(q)[:3] - model.gravity_torque(q[:3])
        J, M = model.tip_jacobian(q[:3])[:3], model.mass_matrix(q[:3])
        error = trace.at_stage(0).error[-1]
        np.testing.assert_allclose(error, J @ np.linalg.solve(M, missing) / 30.0**2, atol=1e-8)
        return np.linalg.norm(error)

    assert sag("known", macro.with_payload(0.2)) < 0.2 * sag("unknown", macro)


def test_two_way_coupling_lets_the_mini_stretch(simulated):
    # The Macro yields to the Mini's position: nothing draws the Mini back.
    one_way, two_way = (simulated(*TRACKED, f"controller.coupling={c}") for c in ("one_way", "two_way"))

    def stretch(trace):
        return np.linalg.norm(trace.end_points[1] - trace.end_points[0], axis=1).max()

    assert stretch(two_way) > stretch(one_way) > np.linalg.norm(R_0)


def test_end_points_of_the_trace_are_those_of_the_robot(simulated, combined):
    for preset in ("full_equations", "as_reported"):
        trace = simulated("robot=combined", f"preset={preset}", "duration=0.1")
        points = end_points(combined, trace.q, preset == "as_reported")
        np.testing.assert_allclose(trace.end_points, points, rtol=0.0, atol=1e-15)
        np.testing.assert_allclose(trace.offsets, [R_0, np.zeros(3)], atol=1e-15)
