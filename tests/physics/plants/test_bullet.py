"""PyBullet's plant: one step against Pinocchio's dynamics, files it misreads, servers and resets."""

import numpy as np
import pytest
from support import strangers
from support.arms import urdf_of

from runner.base.errors import ConfigError
from runner.robots.description import find_urdf, read_urdf
from runner.robots.model import RobotModel

pybullet = pytest.importorskip("pybullet", reason="PyBullet is not installed")

from runner.plants.bullet import build, default_step  # noqa: E402
from runner.plants.bullet_engine import Bullet  # noqa: E402
from runner.plants.stepped_bullet import SteppedBullet  # noqa: E402

INERTIAL = '<inertial><mass value="{m}"/><inertia ixx="{i}" ixy="0" ixz="0" iyy="{i}" iyz="0" izz="{i}"/></inertial>'
NOTHING = INERTIAL.format(m=0, i=0)
LIMITS = '<limit lower="-1000" upper="1000" effort="1e9" velocity="1e9"/>'


def joint(name, parent, child, kind="revolute", rest=""):
    axis = "" if kind == "fixed" else f'<axis xyz="0 0 1"/>{LIMITS}'
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{axis}{rest}</joint>'


def link(name, inertial, rest=""):
    return f'<link name="{name}">{inertial}{rest}</link>'


def wheel(inertia=0.5, collision=""):
    """A single joint about the vertical that turns a wheel."""
    return (
        f'<robot name="wheel">{link("base", NOTHING)}{joint("q1", "base", "wheel")}'
        f"{link('wheel', INERTIAL.format(m=2.0, i=inertia), collision)}</robot>"
    )


@pytest.fixture
def make():
    """Make Bullet plants, released at the end of the test."""
    plants = []

    def make(urdf, tip="tip", step=1e-4, steps_per_tick=1, gravity=9.81):
        plants.append(Bullet(urdf, RobotModel(urdf, tip, gravity), step, steps_per_tick))
        return plants[-1]

    yield make
    for plant in plants:
        plant.close()


def states(plant, torques):
    rows = []
    for tau in torques:
        plant.advance(tau)
        rows.append(np.concatenate([plant.q, plant.dq]))
    return np.array(rows)


@pytest.mark.parametrize(("name", "L"), [("macro", 1.0), ("mini", 0.1)])
def test_one_step_is_semi_implicit_euler_on_the_forward_dynamics_of_pinocchio(make, name, L):
    urdf = urdf_of(name)
    model, h = RobotModel(urdf, "tip"), 1e-4
    plant, generator = make(urdf, step=h), np.random.default_rng(0)
    for _ in range(30):
        q, dq = generator.uniform(-2.0, 2.0, (2, 3))
        q[2] = generator.uniform(-1.0, 1.0)  # M itself is singular where the arm is folded
        tau = L**2 * generator.uniform(-20.0, 20.0, 3)
        plant.reset(q, dq / L)
        plant.advance(tau)
        acceleration = model.forward_dynamics(q, dq / L, tau)
        scale = np.abs(acceleration).max()
        np.testing.assert_allclose((plant.dq - dq / L) / h, acceleration, atol=1e-8 * scale)
        np.testing.assert_allclose(plant.q, q + h * plant.dq, atol=1e-14)


def test_motors_are_off(make, macro, macro_urdf):
    plant = make(macro_urdf)
    plant.reset(np.zeros(3), np.zeros(3))
    states(plant, np.zeros((1000, 3)))
    assert np.abs(plant.dq[1:]).min() > 0.1  # a velocity motor would hold the arm against gravity
    start = np.array([0.0, -0.3, 0.2])
    plant.reset(start, np.zeros(3))
    states(plant, [macro.gravity_torque(start)] * 100)
    np.testing.assert_allclose(plant.q, start, atol=1e-9)


@pytest.mark.parametrize("speed", [150.0, 1e4])
def test_no_speed_is_clamped(make, speed):
    plant = make(wheel(), "wheel", step=1e-3)
    plant.reset(np.zeros(1), np.array([0.9 * speed]))
    states(plant, np.full((10, 1), 0.5 * 0.1 * speed / 0.01))  # I times the missing tenth in 10 ms
    assert plant.dq[0] == pytest.approx(speed, rel=1e-12)


@pytest.mark.parametrize("dynamics", ["", '<dynamics damping="0.5" friction="0.5"/>'])
def test_a_spinning_joint_keeps_its_speed(make, dynamics):
    # The model has no friction, so the plant has none, whatever the file says.
    plant = make(wheel().replace(LIMITS, dynamics + LIMITS), "wheel", step=1e-3)
    plant.reset(np.zeros(1), np.array([20.0]))
    states(plant, np.zeros((2000, 1)))
    assert plant.dq[0] == pytest.approx(20.0, rel=1e-12)
    assert plant.q[0] == pytest.approx(40.0, rel=1e-12)


def test_the_inertia_is_the_file_s_and_not_the_collision_shape_s(make):
    box = '<collision><geometry><box size="1 1 1"/></geometry></collision>'
    plant = make(wheel(inertia=0.05, collision=box), "wheel", step=1e-3)  # the box's would be 2/6 kg m^2
    plant.advance(np.array([1.0]))
    assert plant.dq[0] == pytest.approx(1e-3 / 0.05, rel=1e-12)


def test_massless_links_weigh_nothing(make, macro_urdf):
    plant = make(macro_urdf)
    masses = [
        pybullet.getDynamicsInfo(plant._body, link, physicsClientId=plant._client)[0]
        for link in range(-1, pybullet.getNumJoints(plant._body, physicsClientId=plant._client))
    ]
    assert masses == [0.0, 0.0, 1.0, 1.0, 0.0]


def test_what_bullet_says_of_a_missing_inertial_is_told(make, macro_urdf):
    # The trap that read_urdf refuses: were it gone, the refusal could go too.
    head, tail = macro_urdf.split('<link name="tip">')
    bare = head + '<link name="tip">' + tail.replace(tail[tail.index("<inertial>") : tail.index("<visual>")], "")
    with pytest.raises(
        ConfigError, match=r"robot\.urdf: PyBullet does not accept it: No inertial data for link, using ma"
    ):
        make(bare)


def test_what_bullet_says_of_an_inertia_is_told_and_printed_nowhere(make, capfd):
    with pytest.raises(ConfigError) as raised:
        make(wheel().replace('izz="0.5"', 'izz="1.1"'), "wheel")
    assert "Bad inertia tensor properties, setting inertia to zero for link: wheel" in str(raised.value)
    assert "b3Warning" not in str(raised.value)
    pybullet.disconnect(pybullet.connect(pybullet.DIRECT))
    assert capfd.readouterr() == ("", "")


def test_more_links_than_bullet_has_room_for(make):
    end = "".join(
        link(f"x{i}", NOTHING) + joint(f"f{i}", f"x{i - 1}" if i else "wheel", f"x{i}", "fixed") for i in range(127)
    )
    with pytest.raises(ConfigError, match=r"it has 128 joints, fixed ones included; PyBullet takes up to 127"):
        make(wheel().replace("</robot>", end + "</robot>"), "wheel")


def test_two_arms_in_one_process_are_two_arms(make):
    # Bullet caches URDFs by file name, within a client at least.
    light, heavy = (read_urdf(find_urdf("macro.urdf"), {"link3": mass}) for mass in (1.0, 3.0))
    tau = np.array([1.0, 2.0, 3.0])
    for urdf in (light, heavy, light):
        plant = make(urdf)
        plant.advance(tau)
        expected = RobotModel(urdf, "tip").forward_dynamics(np.zeros(3), np.zeros(3), tau)
        np.testing.assert_allclose(plant.dq / 1e-4, expected, rtol=1e-9, atol=1e-9)


def test_the_step_is_the_one_asked_for(make):
    for step, steps in ((1e-3, 1), (1e-3, 4), (2.5e-4, 10)):
        plant = make(wheel(), "wheel", step=step, steps_per_tick=steps)
        plant.advance(np.array([1.0]))
        assert plant.dq[0] == pytest.approx(2.0 * step * steps, rel=1e-12)
        # Semi-implicit Euler: a h^2 (1 + 2 + ... + n).
        assert plant.q[0] == pytest.approx(2.0 * step**2 * steps * (steps + 1) / 2, rel=1e-12)


def test_a_torque_acts_for_one_tick_only(make):
    plant = make(wheel(), "wheel", step=1e-3)
    plant.advance(np.array([1.0]))
    after_one = plant.dq[0]
    plant.advance(np.zeros(1))
    assert plant.dq[0] == after_one


def test_reset_makes_a_second_run_bit_identical(make, macro_urdf):
    plant = make(macro_urdf, step=1e-3, steps_per_tick=10)
    start = np.array([0.2, -0.1, 0.4]), np.array([0.5, -0.6, 0.7])
    torques = np.random.default_rng(2).uniform(-20.0, 20.0, (50, 3))
    plant.reset(*start)
    np.testing.assert_array_equal(np.concatenate([plant.q, plant.dq]), np.concatenate(start))
    first = states(plant, torques)
    plant.reset(*start)
    np.testing.assert_array_equal(states(plant, torques), first)
    fresh = make(macro_urdf, step=1e-3, steps_per_tick=10)
    fresh.reset(*start)
    np.testing.assert_array_equal(states(fresh, torques), first)


def test_joints_are_ordered_by_name_as_in_the_model(make):
    # The file has a fixed joint first and names its branches in the order that Pinocchio reverses.
    urdf = (
        f'<robot name="tree">{link("base", NOTHING)}{joint("mount", "base", "stand", "fixed")}{link("stand", NOTHING)}'
        f"{joint('z', 'stand', 'heavy')}{link('heavy', INERTIAL.format(m=4, i=4))}"
        f"{joint('a', 'stand', 'light')}{link('light', INERTIAL.format(m=1, i=1))}</robot>"
    )
    model = RobotModel(urdf, "light")
    assert model.joint_names == ("a", "z")
    plant = make(urdf, "light")
    plant.reset(np.array([0.1, 0.2]), np.zeros(2))
    plant.advance(np.array([1.0, 8.0]))
    np.testing.assert_allclose(plant.dq / 1e-4, [1.0, 2.0], rtol=1e-9)
    np.testing.assert_allclose(plant.q, [0.1, 0.2], atol=1e-6)


def test_the_next_plant_of_an_arm_takes_its_server_and_is_as_fresh(macro_urdf):
    model, torques = RobotModel(macro_urdf, "tip"), np.random.default_rng(3).uniform(-20.0, 20.0, (50, 3))
    plant = Bullet(macro_urdf, model, 1e-3, 1)
    expected = states(plant, torques)
    plant.set_gravity(np.zeros(3))
    plant.close()
    again = Bullet(macro_urdf, model, 1e-3, 1)
    assert again._client == plant._client
    np.testing.assert_array_equal(states(again, torques), expected)
    again.close()


def test_an_arm_that_diverged_is_not_used_again(macro_urdf):
    model = RobotModel(macro_urdf, "tip")
    plant = Bullet(macro_urdf, model, 1e-3, 1)
    plant.advance(np.full(3, np.nan))
    plant.close()
    assert not pybullet.isConnected(plant._client)


def test_closed_plants_leave_a_bounded_number_of_servers():
    def servers():
        return sum(pybullet.isConnected(client) for client in range(64))

    urdf = urdf_of("macro")
    for mass in range(1, 12):
        changed = urdf.replace('name="macro"', f'name="macro{mass}"')
        Bullet(changed, RobotModel(changed, "tip"), 1e-3, 1).close()
        assert servers() <= 4


def test_an_urdf_that_bullet_refuses_is_an_error_and_leaves_no_client(macro_urdf):
    model = RobotModel(macro_urdf, "tip")
    connected = [pybullet.isConnected(client) for client in range(64)]
    with pytest.raises(ConfigError, match=r"PyBullet does not accept it: Cannot load URDF file\.; No links found"):
        Bullet("<robot name='none'/>", model, 1e-3, 1)
    assert all(before or not pybullet.isConnected(client) for client, before in enumerate(connected))


@pytest.mark.parametrize("dynamics", ["coupled", "decoupled"])
@pytest.mark.parametrize("wrist_rotation", ["real", "parallel"])
def test_build_and_default_step(checked_config, macro_urdf, one_stage, dynamics, wrist_rotation):
    # One stage has nothing to couple: neither key has an effect.
    config = checked_config(
        "robot=macro", "plant=bullet", f"plant.dynamics={dynamics}", f"plant.wrist_rotation={wrist_rotation}"
    ).plant
    plant = build(config, one_stage(macro_urdf, RobotModel(macro_urdf, "tip")), 1e-3, 10)
    assert isinstance(plant, SteppedBullet)
    plant.close()
    assert default_step(0.01, 1) == pytest.approx(0.001)
    assert default_step(0.001, 2) == pytest.approx(0.00025)


def test_a_text_in_one_long_line_is_read_as_it_is_written():
    # Bullet reads 1,000 characters at a time, and breaks names and numbers there.
    text = strangers.MADE["snake"].replace("\n", "")
    model = RobotModel(text, "tip")
    plant, q = Bullet(text, model, 1e-3, 1), np.full(30, 0.3)
    try:
        np.testing.assert_allclose(plant.mass_matrix(q), model.mass_matrix(q), atol=1e-12)
    finally:
        plant.close()


def test_the_mass_matrix_counts_joints_as_the_model_does():
    arm = strangers.config("crane").arm
    plant = Bullet(arm.urdf, arm.model, 1e-3, 1)
    try:
        for q in np.random.default_rng(0).uniform(-0.4, 0.4, (5, 3)):
            np.testing.assert_allclose(plant.mass_matrix(q), arm.model.mass_matrix(q), atol=1e-10)
    finally:
        plant.close()
