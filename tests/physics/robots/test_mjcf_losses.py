"""Parts of an MJCF that an arm cannot have: refused or named."""

import pytest
from support.mjcf_arms import CHAIN, written

from runner.base.errors import ConfigError
from runner.robots.description import read_urdf
from runner.robots.mjcf import read_mjcf


def beside(text, where="</worldbody>"):
    """The chain with something after its bodies, or before the end of them."""
    return CHAIN.replace(where, f"</worldbody>{text}" if where == "</worldbody>" else f"{text}{where}")


SECOND = '<body name="other"><joint name="p" axis="0 1 0"/><geom size="0.1 0.1"/></body></worldbody>'
FREE = SECOND.replace('<joint name="p" axis="0 1 0"/>', '<freejoint name="f"/>')
REFUSED = {
    "mocap bodies": (
        CHAIN.replace("</worldbody>", '<body name="hand2" mocap="true"/></worldbody>'),
        "holds mocap bodies: 'hand2'",
    ),
    "ball joints": (CHAIN.replace('name="q2"', 'name="q2" type="ball"'), "holds ball joints: 'q2'"),
    "several trees": (CHAIN.replace("</worldbody>", SECOND), "branches: p move in addition to q1, q2, q3; allowed"),
    "branches": (
        CHAIN.replace('<site name="tcp" pos="0.2 0 0"/></body>', "").replace(
            '<site name="tcp"', '<body name="finger"><joint name="f"/><geom size="0.01 0.1"/></body>'
            '<body name="finger2"><joint name="f2"/><geom size="0.01 0.1"/></body><site name="tcp"'
        ),
        "branches: f2 move in addition to f, q1, q2, q3; allowed: a serial arm",
    ),
    "a reference nowhere": (CHAIN.replace('name="q2"', 'name="q2" ref="nan"'), "holds a ref that is not finite: 'q2'"),
    "no joint": ("<mujoco><worldbody><body/></worldbody></mujoco>", "has no joint: it is not an arm"),
    "a body without mass": (
        CHAIN.replace('<geom fromto="0 0 0 0.2 0 0"/>', ""),
        "MuJoCo does not take it: Error: mass and inertia of moving bodies must be larger than .* 'hand', id 4",
    ),
    "what MuJoCo does not know": (CHAIN.replace("<site ", "<sight "), "take it: XML Error: .*'sight', line"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_no_arm_of_ours_has_is_refused_by_name(tmp_path, name):
    text, told = REFUSED[name]
    path = written(tmp_path, text)
    with pytest.raises(ConfigError, match=told) as error:
        read_urdf(path, {})
    (problem,) = error.value.problems
    assert str(path) in problem
    assert "\n" not in problem


def test_all_that_is_refused_is_told_at_once(tmp_path):
    text = CHAIN.replace('name="q2"', 'name="q2" type="ball"')
    with pytest.raises(ConfigError) as error:
        read_mjcf(written(tmp_path, text.replace("</worldbody>", '<body name="hand2" mocap="true"/></worldbody>')))
    assert len(error.value.problems) == 2


LEFT_OUT = {
    "damping that grows": (
        CHAIN.replace('name="q1"', 'name="q1" damping="2 0.5"'),
        "damping that grows with the speed: q1",
    ),
    "a body that is free": (
        beside('<actuator><motor joint="f" gear="1 0 0 0 0 0"/></actuator>').replace("</worldbody>", FREE),
        "free joints of the bodies other, which stand still here",
    ),
    "weight that is borne": (
        CHAIN.replace('name="fore"', 'name="fore" gravcomp="0.5"'),
        "gravity compensation (gravcomp) of the bodies fore, which weigh here",
    ),
    "gravity": (
        CHAIN.replace("<default>", '<option gravity="0 0 -1.62"/><default>'),
        "gravity of 0, 0, -1.62 m/s^2 (gravity, along -z)",
    ),
    "no gravity": (
        CHAIN.replace("<default>", '<option><flag gravity="disable"/></option><default>'),
        "gravity switched off by a flag (gravity=0)",
    ),
    "air": (CHAIN.replace("<default>", '<option density="1.2"/><default>'), "density of the air of 1.2 in SI units"),
    "wind": (CHAIN.replace("<default>", '<option wind="0 3 0"/><default>'), "wind of 0, 3, 0 m/s"),
}  # fmt: skip


@pytest.mark.parametrize("name", LEFT_OUT)
def test_what_would_change_the_motion_is_named(tmp_path, name):
    text, told = LEFT_OUT[name]
    assert told in read_mjcf(written(tmp_path, text)).left_out.motion


def test_an_arm_without_such_things_leaves_nothing_out_that_moves(tmp_path):
    assert read_mjcf(written(tmp_path, CHAIN)).left_out.motion == {}


def test_the_rest_is_named_too(tmp_path):
    text = beside(
        '<sensor><jointpos joint="q1"/><jointvel joint="q1"/></sensor><actuator><velocity name="v" joint="q1" kv="1"/>'
        '<motor name="m" site="tcp"/></actuator><keyframe><key name="home" qpos="0 0.5 1"/><key name="up"/></keyframe>'
        '<contact><exclude body1="upper" body2="hand"/></contact>'
    ).replace(
        "<worldbody>", '<option integrator="implicit"/><worldbody><camera/><light/><geom type="plane" size="1 1 1"/>'
    )
    assert read_mjcf(written(tmp_path, text)).left_out.rest == (
        "gains, dynamics and transmissions of the actuators v, m: controllers command the joints",
        "shapes (4): no wall touches them, and the arm is drawn by its joints",
        "2 sensors",
        "1 camera",
        "1 light",
        "1 contact exclusion",
        "1 other keyframe",
        "time step and integrator (plant.step, plant.integrator)",
    )
