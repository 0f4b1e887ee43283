"""Natural modes, and chains of segments and springs."""

import numpy as np
import pinocchio as pin
import pytest
from support.arms import checked

from runner.papers.studies.thesis_beyond.cantilever import cantilever, cantilever_roots, clamped_arm, frequency_errors
from runner.robots.vibration import Beam, Mode, cut, find_modes, largest_rate, stiffen_robot


def test_of_one_mass_on_a_spring():
    (mode,) = find_modes(np.array([[3.0]]), np.array([[1.2]]), np.array([[500.0]]))
    assert mode.frequency == pytest.approx(np.sqrt(500.0 / 3.0) / (2 * np.pi), rel=1e-12)
    assert mode.damping_ratio == pytest.approx(1.2 / (2 * np.sqrt(3.0 * 500.0)), rel=1e-12)


def test_of_a_chain_of_masses():
    """Three unit masses between walls, equal springs: omega_k = 2 sin(k pi / 8)."""
    K = 2.0 * np.eye(3) - np.eye(3, k=1) - np.eye(3, k=-1)
    modes = find_modes(np.eye(3), 0.1 * K, K)
    omega = 2.0 * np.sin(np.arange(1, 4) * np.pi / 8)
    assert [mode.frequency for mode in modes] == pytest.approx(list(omega / (2 * np.pi)), rel=1e-12)
    assert [mode.damping_ratio for mode in modes] == pytest.approx(list(0.05 * omega), rel=1e-10)


def test_what_creeps_back_is_no_vibration():
    assert find_modes(np.eye(2), np.diag([3.0, 0.1]), np.eye(2)) == [pytest.approx((1 / (2 * np.pi), 0.05))]


def test_its_amplitude_in_a_signal_is_that_at_the_time_asked_for():
    times = np.linspace(0.0, 3.0, 601)
    omega, zeta = 2 * np.pi * 2.0, 0.05
    signal = 4.0 + 0.3 * np.exp(-zeta * omega * times) * np.sin(omega * np.sqrt(1 - zeta**2) * times + 0.7)
    for after in (0.0, 1.0):
        amplitude = Mode(2.0, zeta).amplitude(times, signal, after)
        assert amplitude == pytest.approx(0.3 * np.exp(-zeta * omega * after), rel=1e-9)


def test_the_largest_rate_is_that_of_the_fastest_mode_or_of_what_creeps_fastest():
    assert largest_rate(np.eye(2), np.zeros((2, 2)), np.diag([4.0, 25.0])) == pytest.approx(5.0)
    assert largest_rate(np.eye(1), np.array([[10.0]]), np.eye(1)) == pytest.approx(5.0 + np.sqrt(24.0))
    free = np.array([[1.0, -1.0], [-1.0, 1.0]])  # two masses and a spring, free as a whole
    assert largest_rate(np.eye(2), 0.0 * free, free) == pytest.approx(np.sqrt(2.0))


EI, LENGTH = 70.0, 1.5  # N m^2, m


@pytest.mark.parametrize(
    ("tip_ratio", "mode", "errors"),
    [
        (0.0, 0, {1: 0.393, 2: 0.0608, 3: 0.0261, 4: 0.01453, 8: 0.00360, 16: 0.00090}),
        (0.0, 1, {2: 0.409, 3: 0.0971, 4: 0.0521, 8: 0.0126, 16: 0.0031}),
        (1.0, 0, {1: 0.189, 2: 0.0380, 3: 0.0164, 4: 0.0091, 8: 0.00225, 16: 0.00056}),
        (10.0, 0, {1: 0.159, 2: 0.0334, 3: 0.0144, 4: 0.0081, 8: 0.0020, 16: 0.0005}),
    ],
)
def test_frequencies_converge_from_above_with_the_second_order(tip_ratio, mode, errors):
    found = {parts: frequency_errors(tip_ratio, parts, mode + 1)[mode] for parts in errors}
    assert found == pytest.approx(errors, rel=0.02, abs=5e-5)
    orders = [np.log2(found[parts] / found[2 * parts]) for parts in (4, 8)]
    assert all(1.9 < order < 2.1 for order in orders)


def test_both_planes_bend_alike_and_units_are_si():
    chain = cantilever(Beam(EI, 0.8), LENGTH, 0.8, 3)
    M = chain.mass_matrix(np.zeros(1))[np.ix_(chain.springs, chain.springs)]
    found = [mode.frequency for mode in find_modes(M, 0.0 * M, np.diag(chain.stiffness))]
    assert found[::2] == pytest.approx(found[1::2], rel=1e-9)
    exact = next(cantilever_roots(1.0)) ** 2 * np.sqrt(EI / (0.8 * LENGTH**3)) / (2.0 * np.pi)
    assert found[0] == pytest.approx(exact * (1.0 + frequency_errors(1.0, 3, 1)[0]), rel=1e-9)


def compliance(chain):
    """Return the tip's way under a unit force, shape (3, 3), in m/N, with the motor held and links nearly straight."""
    model, q = chain.pin_model, np.zeros(chain.pin_model.nq)
    tip = model.getFrameId("tip")
    J = pin.computeFrameJacobian(model, model.createData(), q, tip, pin.LOCAL_WORLD_ALIGNED)[:3, chain.springs]
    return J / chain.stiffness @ J.T


@pytest.mark.parametrize("parts", [1, 2, 3, 8, 32])
def test_the_static_deflection_falls_short_by_a_quarter_over_the_square_of_the_parts(parts):
    chain = cantilever(Beam(EI, 0.0), LENGTH, 1.0, parts)
    beam = (1.0 - 0.25 / parts**2) * LENGTH**3 / (3.0 * EI)
    assert compliance(chain) == pytest.approx(np.diag([beam, 0.0, beam]), rel=1e-9, abs=1e-15)


def test_a_link_without_mass_has_one_mode_at_its_end_mass():
    """omega^2 = 3 EI/(m L^3), of one spring over 1 - 1/4."""
    chain = cantilever(Beam(EI, 0.0), LENGTH, 2.0, 1)
    M = chain.mass_matrix(np.zeros(1))[np.ix_(chain.springs, chain.springs)]
    omega = np.sqrt(np.diag(chain.stiffness) @ np.linalg.inv(M)).max()
    assert omega**2 == pytest.approx(3.0 * EI / (2.0 * LENGTH**3) / 0.75, rel=1e-12)


def test_with_straight_links_a_chain_is_the_rigid_arm():
    robot = checked("robot=combined").arm
    beams = {"link2": Beam(300.0, 0.3), "link3": Beam(100.0, 0.2)}
    chain, rigid = cut(robot.model, robot.flange, beams, 3), stiffen_robot(robot, beams).model
    q = np.array([0.3, -0.4, 1.1, 0.2, 0.7, -0.5])
    M = chain.mass_matrix(q)
    assert M[np.ix_(chain.motors, chain.motors)] == pytest.approx(rigid.mass_matrix(q), abs=1e-12)
    assert len(chain.springs) == 2 * 2 * 3
    straight, data = np.zeros(chain.pin_model.nq), chain.pin_model.createData()
    straight[chain.motors] = q
    pin.framesForwardKinematics(chain.pin_model, data, straight)
    for frame in ("tip", "mini_base", "mini_link2", "mini_tip", "link3"):
        place = data.oMf[chain.pin_model.getFrameId(frame)].homogeneous
        assert place == pytest.approx(rigid.frame_poses(q, (frame,))[0], abs=1e-12)


def test_what_the_file_gives_of_a_link_stays_where_its_centre_of_mass_is():
    """A point mass in the middle of the link lies behind one of two springs."""
    arm = clamped_arm(LENGTH, 1.0)
    arm.pin_model.inertias[1] = pin.Inertia(1.0, np.array([0.0, 0.5 * LENGTH, 0.0]), np.zeros((3, 3)))
    chain = cut(arm, "tip", {"beam": Beam(EI, 0.0)}, 2)
    M = chain.mass_matrix(np.zeros(1))
    way = 0.25 * LENGTH  # from the first spring to the mass
    assert np.diag(M)[chain.springs] == pytest.approx([way**2, way**2, 0.0, 0.0], abs=1e-15)
