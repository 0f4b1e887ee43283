"""What each engine does with an unchanged file: the rows of the table in docs/robots.md."""

import tempfile

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from support.unusual_arms import INERTIA, LIMIT, Z, arm, joint, link

from runner.base.errors import ConfigError
from runner.base.paths import package_dir
from runner.robots.model import _read

Q = np.array([0.1, 0.4, 0.9])
COMPILER = '<mujoco><compiler fusestatic="false" inertiafromgeom="false"/></mujoco></robot>'
REFUSED = "refused"


def in_pinocchio(text):
    """Acceleration of the first joint under 1 N m without gravity, in rad/s^2, and the limits of the joint."""
    try:
        model, _ = _read(text)
    except ConfigError:
        return REFUSED, None
    model.gravity.linear = np.zeros(3)
    acceleration = pin.aba(model, model.createData(), Q, np.zeros(3), np.array([1.0, 0.0, 0.0]))[0]
    return acceleration, (model.lowerPositionLimit[0], model.upperPositionLimit[0])


def in_mujoco(text):
    try:
        model = mujoco.MjModel.from_xml_string(text.replace("</robot>", COMPILER))
    except ValueError:
        return REFUSED, None
    data = mujoco.MjData(model)
    model.opt.gravity[:] = 0.0
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    data.qpos[:], data.qfrc_applied[0] = Q, 1.0
    mujoco.mj_forward(model, data)
    limits = tuple(model.jnt_range[0]) if model.jnt_limited[0] else (-np.inf, np.inf)
    return data.qacc[0], limits


def in_bullet(text):
    import pybullet

    client = pybullet.connect(pybullet.DIRECT)
    with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
        file.write(text)
        file.flush()
        body = pybullet.loadURDF(
            file.name, useFixedBase=True, flags=pybullet.URDF_USE_INERTIA_FROM_FILE, physicsClientId=client
        )
    for number in range(-1, 3):
        undamped = {"linearDamping": 0.0, "angularDamping": 0.0, "jointDamping": 0.0}
        pybullet.changeDynamics(body, number, **undamped, physicsClientId=client)
    joints = [0, 1, 2]
    off, on = pybullet.VELOCITY_CONTROL, pybullet.TORQUE_CONTROL
    pybullet.setJointMotorControlArray(body, joints, off, forces=[0.0] * 3, physicsClientId=client)
    for number, angle in zip(joints, Q.tolist(), strict=True):
        pybullet.resetJointState(body, number, angle, 0.0, client)
    limits = pybullet.getJointInfo(body, 0, client)[8:10]
    pybullet.setPhysicsEngineParameter(fixedTimeStep=1e-4, physicsClientId=client)
    pybullet.setJointMotorControlArray(body, joints, on, forces=[1.0, 0.0, 0.0], physicsClientId=client)
    pybullet.stepSimulation(client)
    acceleration = pybullet.getJointState(body, 0, client)[1] / 1e-4
    pybullet.disconnect(client)
    return acceleration, limits


def raw(**changed):
    return arm(tool="", **changed)


def moving_first(**changed):
    return raw(first=joint("j1", "base", "l1", **({"axis": Z} | changed)))


def links(**changed):
    """The links, some of them changed."""
    return "".join(changed.get(name, link(name)) for name in ("base", "l1", "l2", "l3"))


PLAIN, X_AXIS = raw(), '<axis xyz="1 0 0"/>'
TURNED = joint("j2", "l1", "l2", origin='<origin xyz="0 0 0.3" rpy="0.7853981633974483 0 0"/>')
HALF_TURN = 'quat_xyzw="0.3826834323650898 0 0 0.9238795325112867"'
QUATERNION = joint("j2", "l1", "l2", origin=f'<origin xyz="0 0 0.3" {HALF_TURN}/>')
BLANK = links(l1=link("l1", inertia=INERTIA.replace('"0.008"', '"0.008 "')))
LOST = links(l1=link("l1", inertia='ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"'))
INFINITE = LIMIT.replace('"-2"', '"-inf"').replace('"2"', '"inf"')
IMPOSSIBLE = links(l2=link("l2", inertia='ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.028"'))
POINT = links(l2=link("l2", inertia='ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"'))
BARE = links(l3='<link name="l3"/>')
UNIT = links(l3=link("l3", "1", 'ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"', "0 0 0"))
SCALING = '<contact><inertia_scaling value="9"/></contact></link>'
NINE = links(l1=link("l1", inertia='ixx="0.09" ixy="0" ixz="0" iyy="0.108" iyz="0" izz="0.072"'))
SAFETY = '<safety_controller soft_lower_limit="-1" soft_upper_limit="1" k_position="9" k_velocity="1"/>'
RATES = {"limit": LIMIT.replace("/>", ' acceleration="1" jerk="1"/>'), "more": SAFETY, "axis": Z}
ACCELERATIONS = {
    "axis of length 2": (moving_first(axis='<axis xyz="0 0 2"/>'), PLAIN, 0.25, PLAIN),
    "no axis": (raw(second=joint("j2", "l1", "l2", "")), *3 * [raw(second=joint("j2", "l1", "l2", X_AXIS))]),
    "`quat_xyzw`, version 1.1": (raw(head=' version="1.1"', second=QUATERNION), raw(second=TURNED), PLAIN, PLAIN),
    "`quat_xyzw`, no version": (raw(second=QUATERNION), PLAIN, PLAIN, PLAIN),
    "blank after a number": (raw(links=BLANK), raw(links=LOST), PLAIN, PLAIN),
    "limits of inf": (moving_first(limit=INFINITE), REFUSED, PLAIN, PLAIN),
    "version 1 or 1.3": (raw(head=' version="1.3"'), REFUSED, PLAIN, PLAIN),
    "impossible inertia": (raw(links=IMPOSSIBLE), raw(links=IMPOSSIBLE), raw(links=POINT), REFUSED),
    "moving link without inertial": (raw(links=BARE), None, raw(links=UNIT), REFUSED),
    "`inertia_scaling`": (raw(links=links(l1=link("l1").replace("</link>", SCALING))), PLAIN, raw(links=NINE), PLAIN),
    "acceleration, jerk, `safety_controller`": (
        raw(head=' version="1.2"', first=joint("j1", "base", "l1", **RATES)), PLAIN, PLAIN, PLAIN
    ),
}  # fmt: skip
"""An unchanged file, and the usual arm that Pinocchio, PyBullet and MuJoCo move instead; a number is a factor."""
ENGINES = [in_pinocchio, pytest.param(in_bullet, marks=pytest.mark.bullet), in_mujoco]
NAMES = ("in_pinocchio", "in_bullet", "in_mujoco")


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("row", ACCELERATIONS)
def test_an_engine_moves_the_arm_of_the_row(engine, row):
    text, *arms = ACCELERATIONS[row]
    expected, found = arms[NAMES.index(engine.__name__)], engine(text)[0]
    if expected is None:
        assert not np.isfinite(found) or found > 1e3  # no mass behind a joint
    elif expected == REFUSED:
        assert found == REFUSED
    elif isinstance(expected, float):
        assert found == pytest.approx(expected * in_pinocchio(PLAIN)[0], rel=1e-9)
    else:
        assert found == pytest.approx(in_pinocchio(expected)[0], rel=1e-9)


NONE = (-np.inf, np.inf)
LIMITS = {
    "only an upper limit": (LIMIT.replace('lower="-2" ', ""), ((0.0, 2.0), (0.0, 2.0), NONE)),
    "only a lower limit": (LIMIT.replace('upper="2" ', ""), ((-2.0, 0.0), (-2.0, -1.0), NONE)),
    "no position limits": ('<limit effort="1" velocity="1"/>', ((0.0, 0.0), (0.0, -1.0), NONE)),
}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("row", LIMITS)
def test_an_engine_reads_the_limits_of_the_row(engine, row):
    limit, limits = LIMITS[row]
    assert tuple(engine(moving_first(limit=limit))[1]) == limits[NAMES.index(engine.__name__)]


MIMIC = raw(third=joint("j3", "l2", "l3", more='<mimic joint="j2" multiplier="2" offset="0.1"/>'))
DYNAMICS = raw(third=joint("j3", "l2", "l3", more='<dynamics damping="0.7" friction="0.3"/>'))


def test_mujoco_alone_couples_a_mimic_and_rubs():
    model = mujoco.MjModel.from_xml_string(MIMIC.replace("</robot>", COMPILER))
    assert (model.neq, model.eq_data[0, :2].tolist()) == (1, [0.1, 2.0])
    assert pin.buildModelFromXML(MIMIC).nq == 3
    rubbing = mujoco.MjModel.from_xml_string(DYNAMICS.replace("</robot>", COMPILER))
    assert (rubbing.dof_damping[2], rubbing.dof_frictionloss[2]) == (0.7, 0.3)
    model = pin.buildModelFromXML(DYNAMICS)
    rest, moving, none = np.zeros(3), np.array([0.0, 0.0, 1.0]), np.zeros(3)
    model.gravity.linear = none
    bias = pin.rnea(model, model.createData(), Q, moving, none)[2]
    assert abs(bias) < 0.1  # of 0.7 N m at 1 rad/s
    assert pin.rnea(model, model.createData(), Q, rest, none).tolist() == [0.0, 0.0, 0.0]


def test_the_page_has_each_row():
    page = (package_dir().parent / "docs" / "robots.md").read_text()
    first_cells = {line.split("|")[1].strip() for line in page.splitlines() if line.startswith("|")}
    assert {*ACCELERATIONS, *LIMITS, "`mimic`", "`dynamics`"} - first_cells == set()
