"""Arms whose links bend, as plants: energy, modes, rest, and the rigid limit."""

from dataclasses import replace

import numpy as np
import pytest
from support.arms import checked
from support.physics import assert_energy_kept

from runner.base.errors import SimulationError
from runner.papers.studies.thesis_beyond.cantilever import clamped_arm
from runner.plants import PLANTS
from runner.plants.computation import EXACT
from runner.plants.rk4 import Rk4
from runner.plants.rk4_flexible_links import BeamConfig, FlexibleLinks, Rk4FlexibleLinksConfig
from runner.robots.vibration import Beam, cut, stiffen_robot

LENGTH = 1.5  # m
LOCKED = 1e12  # kg m^2, a motor that does not turn
POSTURE = np.array([0.2, 0.5, 0.6])


def macro():
    arm = checked("robot=macro").arm  # which other tests share
    return replace(arm, model=arm.model.copy())


def made(robot, EI, mass, parts, motors, step, steps=1, damping=0.0):
    beams = {"link2": Beam(EI, mass), "link3": Beam(EI, mass)}
    chain = cut(robot.model, robot.flange, beams, parts)
    damper = damping * np.diag(chain.stiffness)
    return FlexibleLinks(chain, motors * np.ones(3), damper, step, steps, [robot.model.tip_name])


@pytest.mark.parametrize(("mass", "parts", "step"), [(0.0, 1, 1e-3), (0.3, 2, 2.5e-4)])
def test_energy_is_kept_without_damping(mass, parts, step):
    plant = made(macro(), 300.0, mass, parts, 2.0, step, steps=round(0.1 / step))
    plant.reset(POSTURE, np.zeros(3))
    plant.speeds[plant._springs] = 0.2
    energies, moved = [plant.energy()], []
    for _ in range(50):
        plant.advance(np.zeros(3))
        energies.append(plant.energy())
        moved.append(np.abs(plant.q - POSTURE).max())
    assert_energy_kept(energies, 1e-6)
    assert max(moved) > 0.5


def test_damping_takes_energy_away():
    plant = made(macro(), 300.0, 0.0, 1, LOCKED, 1e-3, steps=100, damping=1e-3)
    plant.reset(POSTURE, np.zeros(3))
    plant.places[plant._springs] += 0.05
    energies = [plant.energy()]
    for _ in range(10):
        plant.advance(np.zeros(3))
        energies.append(plant.energy())
    assert np.all(np.diff(energies) < 0.0)


def test_at_rest_the_springs_carry_the_weight_and_the_tip_sags_as_a_beam_does():
    """A straight level link under the weight of only its end: m g L^3/(3 EI) (1 - 1/(4 n^2)), for small bends."""
    arm = clamped_arm(LENGTH, 0.5)
    arm.pin_model.gravity.linear = np.array([0.0, 0.0, -9.81])
    for parts in (1, 3):
        chain = cut(arm, "tip", {"beam": Beam(4e3, 1e-9)}, parts)
        plant = FlexibleLinks(chain, np.ones(1), np.zeros((2 * parts, 2 * parts)), 1e-5, 1, ["tip"])
        plant.reset(np.zeros(1), np.zeros(1))
        sag = 0.5 * 9.81 * LENGTH**3 / (3.0 * 4e3) * (1.0 - 0.25 / parts**2)
        assert plant.end_points()[0] == pytest.approx([0.0, LENGTH, -sag], abs=1e-5)
        assert plant.end_points()[0, 2] == pytest.approx(-sag, rel=1e-4)
    plant = made(macro(), 300.0, 0.2, 2, LOCKED, 1e-4, steps=1000)
    plant.reset(POSTURE, np.zeros(3))
    before = plant.places.copy()
    plant.advance(np.zeros(3))
    assert np.abs(before[plant._springs]).max() > 1e-3
    assert plant.places == pytest.approx(before, abs=1e-9)


def test_links_that_are_too_soft_for_their_weight_are_told():
    plant = made(macro(), 1e-3, 0.0, 1, 2.0, 1e-3)
    with pytest.raises(SimulationError, match=r"bends by more than 0\.5 rad under their weight"):
        plant.reset(np.array([0.0, np.pi / 2, 0.3]), np.zeros(3))


def test_the_velocity_of_the_tip_is_how_it_moves():
    plant = made(macro(), 300.0, 0.2, 2, 2.0, 1e-5)
    plant.reset(POSTURE, np.array([0.3, -0.2, 0.5]))
    plant.speeds[plant._springs] = 0.1
    tips = []
    for _ in range(3):
        tips.append(plant.tip_motion())
        plant.advance(np.zeros(3))
    assert (tips[2][0] - tips[0][0]) / 2e-5 == pytest.approx(tips[1][1], rel=1e-4)
    assert plant.tip_motion()[0] == pytest.approx(plant.end_points()[-1], abs=1e-15)


@pytest.mark.parametrize(("mass", "parts"), [(0.0, 1), (0.3, 2)])
def test_with_held_motors_it_rings_as_its_modes_say(mass, parts):
    """Eigenvalues of the step, differentiated, against e^(s h) of the modes, damping included."""
    beam, step = BeamConfig(EI=300.0, mass=mass), 1e-4
    config = Rk4FlexibleLinksConfig(
        kind="rk4_flexible_links", step=None, links={"link2": beam, "link3": beam}, segments=parts,
        motor_inertia=LOCKED, damping_ratio=0.03, computation=EXACT,
    )  # fmt: skip
    robot = macro()
    robot.model.pin_model.gravity.linear = np.zeros(3)  # whose stiffness is not in the modes
    plant = PLANTS.build(config, robot, step, 1)
    plant.reset(robot.home, np.zeros(3))
    on = plant._springs

    def move(state):
        plant.places[on], plant.speeds[on] = np.split(state, 2)
        plant.places[plant._driven] = plant.speeds[plant._driven] = 0.0
        plant.advance(np.zeros(3))
        return np.concatenate([plant.places[on], plant.speeds[on]])

    bumps = 1e-6 * np.eye(2 * len(on))
    map_ = np.array([(move(bump) - move(-bump)) / 2e-6 for bump in bumps]).T
    rates = np.log(np.linalg.eigvals(map_).astype(complex)) / step
    ringing = sorted((abs(s) / (2 * np.pi), -s.real / abs(s)) for s in rates if s.imag > 0.0)
    modes = PLANTS.modes(config, robot, robot.home)
    assert [f for f, _ in ringing] == pytest.approx([mode.frequency for mode in modes], rel=1e-5)
    assert [zeta for _, zeta in ringing] == pytest.approx([0.03] * len(modes), rel=2e-3)
    assert [mode.damping_ratio for mode in modes] == pytest.approx([0.03] * len(modes), rel=1e-6)


def test_the_distance_to_the_rigid_arm_falls_as_one_over_the_stiffness():
    robot, torque = macro(), np.array([2.0, 25.0, 8.0])
    rigid = stiffen_robot(robot, {"link2": Beam(1.0, 0.3), "link3": Beam(1.0, 0.3)}).model.copy()
    rigid.pin_model.armature = 2.0 * np.ones(3)
    reference = _moved(rigid, torque)
    stiffness, distances = np.array([3e3, 6e3, 1.2e4]), []
    for EI in stiffness:
        plant = made(robot, EI, 0.3, 1, 2.0, 1e-4, steps=3000, damping=5e-3)
        plant.reset(POSTURE, np.zeros(3))
        plant.advance(torque)
        distances.append(np.linalg.norm(plant.q - reference))
    assert np.polyfit(np.log(stiffness), np.log(distances), 1)[0] == pytest.approx(-1.0, abs=0.05)


def _moved(model, torque):
    """Return the rigid arm's positions after 0.3 s, shape (nq,), by Pinocchio: compiled code has no motors."""
    plant = Rk4(model, 1e-4, 3000)
    plant._compiled = None
    plant.reset(POSTURE, np.zeros(3))
    plant.advance(torque)
    return plant.q
