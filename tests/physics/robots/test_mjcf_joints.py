"""Grippers of MJCF files: fixed fingers, compared with MuJoCo's own model of the whole file."""

import mujoco
import numpy as np
import pytest
from support import strangers
from support.mjcf_arms import CHAIN, own_model, written

from runner.base.errors import ConfigError
from runner.doctor.examination import examine
from runner.robots.description import read_arm, read_urdf
from runner.robots.joint_dynamics import dynamics_of
from runner.robots.mjcf import read_mjcf
from runner.robots.model import RobotModel

JAW = (
    '<body name="{name}" pos="0.2 0 0.02" euler="0 {turn} 0"><joint name="{name}_slide" type="slide" axis="1 0 0" '
    'range="0.01 0.04" stiffness="3" armature="0.2" damping="4"/><geom size="0.01" fromto="0 0 0 0.03 0 0.05"/></body>'
)
LEVER = (
    '<body name="lever" pos="0.1 0.02 0"><joint name="lift" axis="0 1 1" pos="0.01 0 0.02"/>'
    '<geom size="0.01" fromto="0 0 0 0.1 0 0"/><body name="rod" pos="0.1 0 0"><joint name="twist" axis="1 0 0"/>'
    '<geom size="0.01" fromto="0 0 0 0.05 0 0"/><site name="rod_end"/></body></body>'
)
BESIDE = """
<tendon>
  <fixed name="grip"><joint joint="left_slide" coef="0.5"/><joint joint="right_slide" coef="0.5"/></fixed>
  <spatial name="cord"><site site="palm"/><site site="rod_end"/></spatial>
</tendon>
<equality><joint joint1="left_slide" joint2="right_slide"/><connect body1="rod" body2="left" anchor="0 0 0"/></equality>
<actuator>
  <position name="close" tendon="grip" kp="10"/><motor joint="lift" gear="2"/><motor name="m2" joint="q2" gear="3"
  armature="0.01" damping="0.2"/><muscle name="thumb" joint="lift"/>
</actuator>
<sensor><tendonpos tendon="grip"/><jointpos joint="twist"/><actuatorpos actuator="close"/></sensor>
<contact><exclude body1="left" body2="right"/></contact>
"""
SITES = '<site name="palm" pos="0.1 0 0"/><site name="tcp"'
GRIPPER = (
    CHAIN.replace('name="q1"', 'name="q1" armature="0.3" damping="2" frictionloss="0.5"')
    .replace('<site name="tcp"', JAW.format(name="left", turn=90) + JAW.format(name="right", turn=-90) + LEVER + SITES)
    .replace("</worldbody>", f"</worldbody>{BESIDE}")
)
KEYFRAME = '<keyframe><key name="home" qpos="0.1 0.5 1 0.02 0.03 0.4 -0.3"/></keyframe>'
AT_HOME = {"left_slide": 0.02, "right_slide": 0.03, "lift": 0.4, "twist": -0.3}
AT_ZERO = {"left_slide": 0.01, "right_slide": 0.01, "lift": 0.0, "twist": 0.0}


def examined(path, tip="tcp"):
    with strangers.short_examination():
        return examine(path, tip)


@pytest.mark.parametrize(("keyframe", "held"), [(KEYFRAME, AT_HOME), ("", AT_ZERO)], ids=["at home", "at zero"])
def test_an_arm_with_its_fingers_held_is_mujocos(tmp_path, keyframe, held):
    path = written(tmp_path, GRIPPER.replace("</mujoco>", f"{keyframe}</mujoco>"))
    ours, theirs = examined(path).arm.model, own_model(path)
    assert ours.joint_names == ("q1", "q2", "q3")
    theirs.dof_armature[:3] = 0.3, 0.0, 0.0  # own_model takes it out
    data, generator = mujoco.MjData(theirs), np.random.default_rng(0)
    data.qpos[3:] = list(held.values())
    for _ in range(20):
        q, dq = generator.uniform(-2.5, 2.5, (2, 3))
        data.qpos[:3], data.qvel[:3] = q, dq
        M, bias = np.zeros((7, 7)), np.zeros(7)
        for step in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_tendon, mujoco.mj_transmission, mujoco.mj_makeM,
                     mujoco.mj_comVel):  # fmt: skip
            step(theirs, data)
        mujoco.mj_rne(theirs, data, 0, bias)
        mujoco.mj_fullM(theirs, data, M)
        np.testing.assert_allclose(ours.mass_matrix(q), M[:3, :3], atol=1e-12 * np.abs(M[:3, :3]).max())
        bent = ours.gravity_torque(q) + ours.coriolis_torque(q, dq)
        np.testing.assert_allclose(bent, bias[:3], atol=1e-12 * np.abs(bias[:3]).max())
        np.testing.assert_allclose(ours.tip_position(q), data.site("tcp").xpos, atol=1e-12)


def test_each_joint_that_is_held_is_named_with_what_tied_it(tmp_path):
    path = written(tmp_path, GRIPPER.replace("</mujoco>", f"{KEYFRAME}</mujoco>"))
    said = {f.place: f"{f.text}; {f.remedy}" for f in examined(path).findings}
    beside = "moves, but not the tip, and is"
    home = "as the keyframe 'home' has it"
    assert said["joint 'left_slide'"] == f"{beside} tied by a tendon 'grip'; now held at 0.02 m, {home}"
    assert said["joint 'lift'"] == f"{beside} pulled by a muscle 'thumb'; now held at 0.4 rad, {home}"
    assert said["joint 'twist'"] == f"{beside} tied by a tendon 'cord'; now held at -0.3 rad, {home}"


ON_THE_WAY = {
    "a tendon": '<tendon><fixed name="rope"><joint joint="q2" coef="1"/></fixed></tendon>',
    "a tendon over bodies": '<tendon><spatial name="rope"><site site="s"/><site site="palm"/></spatial></tendon>',
    "a muscle": '<actuator><muscle name="biceps" joint="q2"/></actuator>',
    "an equality constraint": '<equality><joint name="together" joint1="q1" joint2="q2"/></equality>',
    "one to nothing": '<equality><joint name="stiff" joint1="q2"/></equality>',
    "one of bodies": '<equality><weld name="glue" body1="upper" body2="hand"/></equality>',
    "one to the world": '<equality><connect name="pin" body1="fore" anchor="0 0 0"/></equality>',
    "one of sites": '<equality><connect name="pin" site1="s" site2="palm"/></equality>',
    "one of a tendon": '<tendon><fixed name="rope"><joint joint="q2" coef="1"/></fixed></tendon>'
    '<equality><tendon name="taut" tendon1="rope"/></equality>',
}  # fmt: skip
TOLD = {
    "a tendon": "is tied by a tendon 'rope'",
    "a tendon over bodies": "is tied by a tendon 'rope'",
    "a muscle": "is pulled by a muscle 'biceps'",
    "an equality constraint": "is tied by an equality constraint 'together'",
    "one to nothing": "is tied by an equality constraint 'stiff'",
    "one of bodies": "is tied by an equality constraint 'glue'",
    "one to the world": "is tied by an equality constraint 'pin'",
    "one of sites": "is tied by an equality constraint 'pin'",
    "one of a tendon": "is tied by a tendon 'rope'",
}


@pytest.mark.parametrize("name", ON_THE_WAY)
def test_what_ties_a_joint_that_moves_the_tip_is_refused_by_name(tmp_path, name):
    text = CHAIN.replace('<site name="tcp"', SITES).replace('<body name="fore"', '<site name="s"/><body name="fore"')
    path = written(tmp_path, text.replace("</worldbody>", f"</worldbody>{ON_THE_WAY[name]}"))
    (finding,) = [f for f in examined(path).findings if f.grade == "refused" and "'q2'" in f.place]
    assert finding.text == f"it moves the tip and {TOLD[name]}, and engines would let it move freely"
    with pytest.raises(ConfigError, match=f"joint 'q2' in .* {TOLD[name]}, and its motion would be free"):
        read_urdf(path, {})


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('name="q2"', 'name="q2" stiffness="3"', "has a spring (stiffness, springdamper)"),
        ('name="q2"', 'name="q2" springdamper="1 1"', "has a spring (stiffness, springdamper)"),
        ('name="q2"', 'name="q2" type="slide" limited="false"', "slides without a range"),
    ],
)
def test_a_joint_that_is_sprung_or_endless_is_tied(tmp_path, old, new, told):
    assert read_mjcf(written(tmp_path, CHAIN.replace(old, new))).ties == {"q2": told}


def test_a_constraint_that_is_switched_off_ties_nothing(tmp_path):
    off = '</worldbody><equality><joint joint1="q1" joint2="q2" active="false"/></equality>'
    assert read_mjcf(written(tmp_path, CHAIN.replace("</worldbody>", off))).ties == {}


def test_what_moves_both_ends_alike_is_not_tied(tmp_path):
    text = CHAIN.replace('<site name="tcp"', f"{LEVER}{SITES}")
    bolt = '</worldbody><equality><weld body1="lever" body2="hand"/></equality>'
    assert set(read_mjcf(written(tmp_path, text.replace("</worldbody>", bolt))).ties) == {"lift"}


@pytest.mark.parametrize(
    ("motor", "effort", "said"),
    [
        ('nominal="24 3 300" gear="10" armature="0.001"', 30.0, "(torque_limits.no_load_speed): no-load speed of the "
         "joint in SI units 30"),
        ('motorconst="0.08" resistance="0.64" ctrlrange="-12 12"', 1.5, "no-load speed of the joint in SI units 150"),
        ('motorconst="0.08" resistance="0.64" saturation="2"', 2.0, "(torque_limits.no_load_speed): its voltage is not "
         "given"),
    ],
)  # fmt: skip
def test_a_direct_current_motor_limits_torque_and_speed(tmp_path, motor, effort, said):
    actuator = f'<actuator><dcmotor name="m" joint="q2" {motor}/></actuator></mujoco>'
    path = written(tmp_path, CHAIN.replace("</mujoco>", actuator))
    model = RobotModel(read_urdf(path, {}), "tcp")
    assert model.effort_limits.tolist() == [np.inf, pytest.approx(effort), np.inf]
    given = dynamics_of(read_arm(path), "arm.xml", 9.81)
    (text,) = given.left_out
    assert text.startswith("back-EMF of the dc motors m ")
    assert text.endswith(said)
    assert given.armature[1] == pytest.approx(0.1 if "armature" in motor else 0.0)
