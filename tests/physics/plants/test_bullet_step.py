"""Compiled step of plant=bullet: the links, steps, limits and hand-overs of PyBullet, bit for bit."""

import numpy as np
import pytest
from support import strangers
from support.made_arms import Writer, make_arm

from runner.plants import stepped_bullet
from runner.plants.bullet import make_arm as arm_of
from runner.plants.bullet_links import read_arm
from runner.plants.compiled_bullet import CompiledBullet
from runner.plants.stepped_bullet import SteppedBullet, divides, find_step, substep
from runner.robots.description import read_urdf
from runner.robots.model import RobotModel

pybullet = pytest.importorskip("pybullet", reason="PyBullet is not installed")

from runner.plants.bullet_engine import Bullet  # noqa: E402

ARMS = ("macro", "mini", "combined", "meca500", "xarm7", "panda", "ur5e", "sawyer", "so101", "z1")
STEP = 5e-4


def torques(model, state, generator):
    """Return random torques of at most some 30 rad/s^2, with some damping."""
    q, dq = np.split(state, 2)
    pushed = generator.uniform(-30.0, 30.0, model.nq) - 2.0 * dq
    return model.gravity_torque(q) + np.diagonal(model.mass_matrix(q)) * pushed


def ticks_alike(urdf, model, ticks, steps=2, seed=0):
    """Compare the step with PyBullet from the middle of the joints' ranges; return the ticks until a limit."""
    generator, n = np.random.default_rng(seed), model.nq
    at_once = 1 if model.armature.any() else steps
    code = CompiledBullet(model, read_arm(urdf, model.joint_names), substep(STEP, at_once))
    plant, state = Bullet(urdf, model, STEP, steps), np.concatenate([model.usual_range.mean(axis=0), np.zeros(n)])
    try:
        plant.reset(*np.split(state, 2))
        for tick in range(ticks):
            tau = torques(model, state, generator)
            if not code.advance(state, tau, steps):
                return tick
            plant.advance(tau)
            assert np.array_equal(np.concatenate([plant.q, plant.dq]), state), tick
        return ticks
    finally:
        plant.close()


@pytest.mark.costs(4)
@pytest.mark.parametrize("name", ARMS)
def test_built_in_arms_have_the_bits_of_bullet_over_3000_ticks_or_until_a_limit(name, checked_config):
    arm = checked_config(f"robot={name}").arm
    assert ticks_alike(arm.urdf, arm.model, 3000) > 2000


@pytest.mark.costs(4)
@pytest.mark.parametrize("seed", range(6))
def test_made_arms_have_the_bits_of_bullet(seed, tmp_path):
    """Prismatic joints at any place, side branches, turned inertials and axes, links in any order."""
    path = tmp_path / "made.urdf"
    path.write_text(Writer(np.random.default_rng(seed)).write(make_arm(np.random.default_rng(seed))))
    urdf = read_urdf(path, {})
    assert ticks_alike(urdf, RobotModel(urdf, "tip"), 200, seed=seed) > 20


@pytest.mark.parametrize("name", ["crane"])
def test_another_order_of_joints(name):
    arm = strangers.config(name).arm
    assert ticks_alike(arm.urdf, arm.model, 200) > 20


@pytest.mark.parametrize("name", ARMS)
def test_the_links_are_those_that_bullet_reads(name, checked_config):
    arm = checked_config(f"robot={name}").arm
    plant = Bullet(arm.urdf, arm.model, STEP, 1)
    body, client = plant._body, plant._client
    for index, link in enumerate(read_arm(arm.urdf, arm.model.joint_names).links):
        joint, dynamics = pybullet.getJointInfo(body, index, client), pybullet.getDynamicsInfo(body, index, client)
        assert (link.mass, tuple(link.inertia)) == (dynamics[0], dynamics[2])
        assert (-1 if link.parent is None else link.parent) == joint[16]
        if link.turn is not None:
            assert (*link.angular, *link.pivot, *link.turn) == (*joint[13], *joint[14], *joint[15])
    plant.close()


def plants(urdf, model, steps=2):
    """Return the same arm by its step and by PyBullet's own steps."""
    stepped, other = arm_of(urdf, model, STEP, steps), Bullet(urdf, model, STEP, steps)
    assert isinstance(stepped, SteppedBullet)
    return stepped, other


@pytest.mark.costs(2)
@pytest.mark.parametrize("name", ["macro", "so101", "xarm7"])
def test_a_hand_over_at_a_limit_has_the_bits_of_bullet(name, checked_config):
    """Another gravity, a joint at its limit and away from it, and a second use after a reset."""
    arm = checked_config(f"robot={name}", "robot.armature=0").arm
    model, generator = arm.model, np.random.default_rng(1)
    pair, start = plants(limited(arm.urdf), model), model.usual_range.mean(axis=0)
    for plant in pair:
        plant.set_gravity(np.array([1.0, -2.0, -9.0]))
    for outwards in (1.0, -1.0):
        for plant in pair:
            plant.reset(start, np.zeros(model.nq))
        handed = 0
        for tick in range(400):
            sign = outwards if tick < 300 else -outwards
            tau = model.gravity_torque(pair[1].q) + sign * np.diagonal(model.mass_matrix(pair[1].q)) * 60.0
            tau = tau * generator.uniform(0.5, 1.0, model.nq)
            for plant in pair:
                plant.advance(tau)
            handed += pair[0]._by_engine
            for part in ("q", "dq"):
                assert np.array_equal(*(getattr(plant, part) for plant in pair)), tick
        assert 0 < handed < 400
    for plant in pair:
        plant.close()


def limited(urdf):
    """Return the text with limits of 3 rad instead of 1,000."""
    return urdf.replace('"-1000.0"', '"-3.0"').replace('"1000.0"', '"3.0"')


def test_a_run_with_a_wall_is_that_of_bullet(checked_config, monkeypatch):
    from runner.simulation.run import simulate_repetition

    overrides = ("robot=meca500", "environment=wall", "controller=operational_space", "duration=0.1", "plant=bullet")
    with_step = simulate_repetition(checked_config(*overrides), 0)
    monkeypatch.setattr("runner.plants.bullet.find_step", lambda *_: None)
    other = simulate_repetition(checked_config(*overrides), 0)
    assert np.array_equal(with_step.q, other.q)
    assert np.array_equal(with_step.contact.load, other.contact.load)


def test_a_step_with_other_bits_is_not_used(checked_config, monkeypatch, capsys):
    arm = checked_config("robot=macro").arm
    assert find_step(arm.urdf, arm.model, STEP, 2) is not None
    stepped_bullet.find_arm.cache_clear()
    monkeypatch.setattr(stepped_bullet, "read_answer", lambda _: None)
    monkeypatch.setattr(stepped_bullet, "write_answer", lambda *_: None)  # other tests share the cache
    monkeypatch.setattr(stepped_bullet, "has_bits_of_bullet", lambda *_: False)
    assert find_step(arm.urdf, arm.model, STEP, 2) is None
    assert "differs from the installed PyBullet, which moves the arm" in capsys.readouterr().err
    stepped_bullet.find_arm.cache_clear()


def test_an_arm_with_code_that_was_compared_takes_fewer_ticks(checked_config, monkeypatch):
    kept, ticks = {}, []
    monkeypatch.setattr(stepped_bullet, "read_answer", kept.get)
    monkeypatch.setattr(stepped_bullet, "write_answer", kept.__setitem__)
    monkeypatch.setattr(stepped_bullet, "has_bits_of_bullet", lambda *given: ticks.append(given[3]) or True)
    for payload in ("0.1", "0.2", "0.1"):
        arm = checked_config("robot=ur5e", f"robot.payload.mass={payload}").arm
        stepped_bullet.find_arm.cache_clear()
        assert find_step(arm.urdf, arm.model, STEP, 2) is not None
    assert ticks == [500, 50]
    stepped_bullet.find_arm.cache_clear()


def test_the_judge_finds_a_wrong_bit(checked_config, monkeypatch):
    from runner.plants.agreement import has_bits_of_bullet

    arm = checked_config("robot=macro").arm
    own = read_arm(arm.urdf, arm.model.joint_names)
    assert has_bits_of_bullet(arm.urdf, arm.model, own, 50, np.random.default_rng(0))
    wrong = [link._replace(mass=np.nextafter(link.mass, 9.0).item()) for link in own.links]
    assert not has_bits_of_bullet(arm.urdf, arm.model, own._replace(links=wrong), 50, np.random.default_rng(0))


def test_ticks_that_bullet_does_not_divide_as_asked_are_left_to_it():
    """Bullet divides the time that has passed by the step, rounds down, and keeps the rest for the next tick."""
    steps = np.random.default_rng(0).uniform(1e-4, 1e-2, 1000).tolist()
    assert all(divides(step, count) for step in steps for count in (1, 2, 4, 10, 12))
    assert not all(divides(step, 13) for step in steps)


def test_what_is_left_to_bullet(checked_config):
    """An arm with a tool, for its sensor, and a joint type whose step is not known."""
    arm = checked_config("robot=macro").arm
    assert find_step(arm.urdf.replace('"tip"', '"tool_mount"'), arm.model, STEP, 2) is None
    assert read_arm(arm.urdf.replace('type="fixed"', 'type="planar"'), arm.model.joint_names) is None
