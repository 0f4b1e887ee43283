"""Plants of arms mounted on each other: coupled as one body, or each with its own dynamics."""

import numpy as np
import pytest
from support.physics import assert_order

from runner.base.errors import ConfigError
from runner.plants import PLANTS
from runner.plants.decoupled import Decoupled
from runner.plants.rk4 import Rk4
from runner.robots.robot import StageBase

STEP = 5e-4
PRINTED = np.array([0.3, -0.5, 0.7, 0.2, -0.4, 0.9]), np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
TORQUES = np.random.default_rng(5).uniform(-1.0, 1.0, (200, 6)) * [20.0, 20.0, 10.0, 0.05, 0.05, 0.05]
DYNAMICS = ("coupled", "decoupled")


def random_states(count, seed=0):
    generator = np.random.default_rng(seed)
    return [(generator.uniform(-np.pi, np.pi, 6), generator.uniform(-1.0, 1.0, 6)) for _ in range(count)]


@pytest.fixture(scope="module")
def free(checked_config):
    """The combined arm without gravity."""
    return checked_config("robot=combined", "gravity=0").arm.model


@pytest.fixture
def make(combined, checked_config):
    """Make staged plants, released at the end of the test."""
    plants = []

    def make(kind="rk4", dynamics="decoupled", wrist_rotation="real", step=1e-3, steps_per_tick=1, robot=combined):
        config = checked_config(
            "robot=combined", f"plant={kind}", f"plant.dynamics={dynamics}", f"plant.wrist_rotation={wrist_rotation}"
        )
        plants.append(PLANTS.build(config.plant, robot, step, steps_per_tick))
        return plants[-1]

    yield make
    for plant in plants:
        plant.close()


def drift(model, q, dq, step=STEP, seconds=10.0):
    """Largest relative change of energy over a free motion, looked at every 20 ms."""
    plant = Rk4(model, step, round(0.02 / step))
    plant.reset(q, dq)
    start, worst = model.energy(q, dq), 0.0
    for _ in range(round(seconds / 0.02)):
        plant.advance(np.zeros(6))
        worst = max(worst, abs(model.energy(plant.q, plant.dq) - start))
    assert np.abs(plant.q - q).max() > 1.0
    return worst / start


# The coupled arm.


@pytest.mark.parametrize("state", [PRINTED, *random_states(10)], ids=lambda state: f"{state[0][0]:.2f}")
def test_a_free_coupled_arm_keeps_its_energy(free, state):
    assert drift(free, *state) < 1e-6


def test_beside_a_singular_mass_matrix_energy_is_kept_by_a_smaller_step(free):
    # Of ninety random postures two come closer to the Mini lying folded along joint 4's axis than the step of 0.5 ms
    # resolves: the smallest eigenvalue of M falls to 5e-7 kg m^2, a hundredth of what the others meet. It is the
    # integrator's error, of fourth order, not the plant's: a quarter of the step leaves less than a hundredth of it.
    q = np.array([-0.59293, 2.32016, -0.39075, 2.40887, 0.47138, -0.47244])
    generator = np.random.default_rng(0)
    states = [(generator.uniform(-np.pi, np.pi, 6), generator.uniform(-1.0, 1.0, 6)) for _ in range(90)]
    start = min(states, key=lambda state: np.abs(state[0] - q).max())
    np.testing.assert_allclose(start[0], q, atol=0.01)
    coarse, fine = drift(free, *start, seconds=6.0), drift(free, *start, step=STEP / 4, seconds=6.0)
    assert coarse > 1e-6
    assert fine < 1e-7


def test_the_mass_matrix_is_singular_where_the_mini_lies_folded_along_joint_4(free):
    folded = np.array([0.3, 0.2, 0.1, 0.4, np.pi / 2, np.pi / 2])
    assert np.linalg.eigvalsh(free.mass_matrix(folded))[0] < 1e-15
    folded[4] = 0.5  # folded, but across that axis
    assert np.linalg.eigvalsh(free.mass_matrix(folded))[0] > 1e-5


@pytest.mark.bullet
@pytest.mark.parametrize("seed", range(3))
def test_one_step_of_bullet_is_semi_implicit_euler_on_the_forward_dynamics(combined, seed):
    from runner.plants.bullet_engine import Bullet

    h, plant = 1e-5, Bullet(combined.urdf, combined.model, 1e-5, 1)
    try:
        for q, dq in random_states(5, seed):
            tau = TORQUES[seed]
            plant.reset(q, dq)
            plant.advance(tau)
            acceleration = combined.model.forward_dynamics(q, dq, tau)
            scale = np.abs(acceleration).max()
            np.testing.assert_allclose((plant.dq - dq) / h, acceleration, atol=1e-7 * scale)
            np.testing.assert_allclose(plant.q, q + h * plant.dq, atol=1e-13)
    finally:
        plant.close()


@pytest.mark.bullet
@pytest.mark.parametrize("dynamics", ["coupled", "decoupled"])
def test_bullet_converges_to_rk4_at_first_order(simulated, dynamics):
    def final_state(plant, steps_per_tick):
        trace = simulated(
            "robot=combined",
            f"plant={plant}",
            f"plant.step={1e-3 / steps_per_tick!r}",
            f"plant.dynamics={dynamics}",
            "trajectory=quintic",
            "trajectory.duration=2",
            "duration=0.8",
        )
        assert trace.failure is None
        return np.concatenate([trace.q[-1], trace.dq[-1] / 30.0])

    reference = final_state("rk4", 2)
    differences = [np.linalg.norm(final_state("bullet", n) - reference) for n in (4, 8, 16)]
    assert differences[0] < 0.01
    assert_order(differences, 1, within=0.13)


# The decoupled one.


@pytest.mark.parametrize("kind", ["bullet", "mujoco", "rk4"])
@pytest.mark.parametrize("wrist_rotation", ["real", "parallel"])
def test_the_macro_moves_as_the_macro_alone(make, engine, macro, macro_urdf, kind, wrist_rotation):
    plant = make(kind, wrist_rotation=wrist_rotation, steps_per_tick=2)
    alone = engine("compiled rk4" if kind == "rk4" else kind, macro_urdf, macro, 1e-3, 2)
    plant.reset(*PRINTED)
    alone.reset(PRINTED[0][:3], PRINTED[1][:3])
    for tau in TORQUES:
        plant.advance(tau)
        alone.advance(tau[:3])
        np.testing.assert_array_equal(plant.q[:3], alone.q)
        np.testing.assert_array_equal(plant.dq[:3], alone.dq)
    assert np.abs(plant.q[:3] - PRINTED[0][:3]).max() > 0.1


class Rock:
    """A plant that rests."""

    def __init__(self, q):
        self.q, self.dq = np.array(q), np.zeros(3)

    def reset(self, q, dq):
        pass

    def set_gravity(self, gravity):
        pass

    def advance(self, tau):
        pass

    def close(self):
        pass


@pytest.mark.parametrize("ignore_base_rotation", [False, True])
def test_the_mini_on_a_macro_that_stands_moves_as_a_mini_alone_under_turned_gravity(
    combined, mini, ignore_base_rotation
):
    posture = PRINTED[0][:3]
    plant = Decoupled(combined, [Rock(posture), Rk4(mini, 1e-3, 1)], ignore_base_rotation)
    alone, base = Rk4(mini, 1e-3, 1), StageBase(combined, 1, ignore_base_rotation)
    base.update(PRINTED[0], np.zeros(6))
    gravity = base.rotation.T @ [0.0, 0.0, -9.81]
    assert (np.abs(gravity - [0.0, 0.0, -9.81]).max() > 1.0) != ignore_base_rotation
    alone.set_gravity(gravity)
    plant.reset(*PRINTED)
    alone.reset(PRINTED[0][3:], PRINTED[1][3:])
    for tau in TORQUES:
        plant.advance(tau)
        alone.advance(tau[3:])
        np.testing.assert_array_equal(plant.q[3:], alone.q)
        np.testing.assert_array_equal(plant.dq[3:], alone.dq)
    np.testing.assert_array_equal(plant.q[:3], posture)


def test_another_gravity_reaches_both_arms(make):
    plant, weightless = make(), make()
    weightless.set_gravity(np.zeros(3))
    moved = []
    for one in (plant, weightless):
        one.reset(np.zeros(6), np.zeros(6))
        for _ in range(20):
            one.advance(np.zeros(6))
        moved.append(one.q.copy())
    assert np.abs(moved[0][[1, 4]]).min() > 1e-4
    np.testing.assert_array_equal(moved[1], 0.0)


@pytest.mark.parametrize("kind", ["bullet", "mujoco", "rk4"])
@pytest.mark.parametrize("dynamics", ["coupled", "decoupled"])
def test_reset_makes_a_second_run_bit_identical(make, kind, dynamics):
    plant, runs = make(kind, dynamics), []
    for _ in range(2):
        plant.reset(*PRINTED)
        np.testing.assert_array_equal(np.concatenate([plant.q, plant.dq]), np.concatenate(PRINTED))
        for tau in TORQUES[:50]:
            plant.advance(tau)
        runs.append(np.concatenate([plant.q, plant.dq]))
    np.testing.assert_array_equal(*runs)


def test_the_state_is_renewed_in_place(make):
    for dynamics in ("coupled", "decoupled"):
        plant = make(dynamics=dynamics)
        q, dq = plant.q, plant.dq
        plant.reset(*PRINTED)
        plant.advance(TORQUES[0])
        assert (plant.q is q, plant.dq is dq) == (True, True)


def test_the_coupled_macro_converges_to_the_decoupled_one_in_proportion_to_the_mini_s_mass(simulated):
    def motions(mass):
        masses = f"robot.stages.mini.masses={{link2: {mass}, link3: {mass}}}"
        goal = ("trajectory.goal=[0.3,0.9,1.2]", "duration=1")
        pair = [simulated("robot=combined", "plant=rk4", f"plant.dynamics={d}", masses, *goal) for d in DYNAMICS]
        return [trace.q for trace in pair]

    macro, mini = [], []
    for mass in (0.1, 0.01, 0.001):
        coupled, decoupled = motions(mass)
        macro.append(np.abs(coupled - decoupled)[:, :3].max())
        mini.append(np.abs(coupled - decoupled)[:, 3:].max())
    assert macro == pytest.approx([1.2e-2, 1.2e-3, 1.2e-4], rel=0.1)
    # The Mini itself does not: the decoupled one feels nothing of its base's acceleration, however light it is.
    assert mini[2] == pytest.approx(mini[1], rel=0.05)
    assert mini[2] > 0.01


@pytest.mark.parametrize("kind", ["bullet", "mujoco", "rk4"])
def test_a_coupled_base_that_does_not_turn_is_refused(make, cli, kind):
    with pytest.raises(ConfigError, match=r"plant\.wrist_rotation: parallel leaves the rider's base unturned"):
        make(kind, "coupled", "parallel")
    ending = cli("robot=combined", f"plant={kind}", "plant.wrist_rotation=parallel", "duration=0.01")
    assert ending.code == 2
    assert "set plant.dynamics=decoupled, or plant.wrist_rotation=real" in ending.err


def test_default_steps_resolve_the_fastest_loop(checked_config):
    assert checked_config("robot=combined").timing.step == pytest.approx(2.5e-4)
    assert checked_config("robot=combined", "plant=rk4").timing.step == pytest.approx(1e-3)
    assert checked_config("robot=combined").timing.steps_per_tick == 4
