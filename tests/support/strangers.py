"""Third-party arms that the doctor writes from a URDF."""

import functools
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

import pytest
from fixtures.cost import counted_apart

from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.doctor import examination
from runner.doctor.config_folder import write_folder

_PACKAGE = find_spec("pybullet_data")
DATA = Path("none" if _PACKAGE is None else _PACKAGE.submodule_search_locations[0])

SHIPPED = {
    "kuka": ("kuka_iiwa/model.urdf", None),
    "xarm6": ("xarm/xarm6_robot.urdf", None),
    "xarm6_gripper": ("xarm/xarm6_with_gripper.urdf", "link6"),
    "franka": ("franka_panda/panda.urdf", "panda_grasptarget"),
    "planar_two": ("TwoJointRobot_w_fixedJoints.urdf", None),
    "pendulum": ("pendulum5.urdf", None),
}
"""Arms of the pybullet package, with the tip to name where there are several ends; skipped without it."""


def link(name, mass, length):
    across, along = mass * length**2 / 12.0, mass * length**2 / 100.0
    inertia = f'<inertia ixx="{across}" ixy="0" ixz="0" iyy="{across}" iyz="0" izz="{along}"/>'
    origin = f'<origin xyz="0 0 {length / 2}"/>'
    return f'<link name="{name}"><inertial>{origin}<mass value="{mass}"/>{inertia}</inertial></link>'


def joint(number, kind, axis, height, limits):
    lower, upper = limits
    return (
        f'<joint name="q{number + 1}" type="{kind}"><parent link="l{number}"/><child link="l{number + 1}"/>'
        f'<origin xyz="0 0 {height}"/><axis xyz="{axis}"/>'
        f'<limit lower="{lower}" upper="{upper}" effort="2000" velocity="20"/></joint>'
    )


def chain(name, kinds, length=0.3, mass=2.0, tip=(0.05, 0.0, 0.25)):
    """A URDF of joints given as (kind, axis), each a length above the one before, and a tip on the last link."""
    reach = {"revolute": (-2.8, 2.8), "prismatic": (-0.4, 0.4)}
    joints = [joint(i, kind, axis, length * (i > 0), reach[kind]) for i, (kind, axis) in enumerate(kinds)]
    links = [link("l0", 5.0, length), *(link(f"l{i + 1}", mass, length) for i in range(len(kinds)))]
    end = (
        '<link name="tip"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>'
        f'</inertial></link><joint name="end" type="fixed"><parent link="l{len(kinds)}"/><child link="tip"/>'
        f'<origin xyz="{tip[0]} {tip[1]} {tip[2]}"/></joint>'
    )
    lines = "\n".join([*links, *joints, end])
    return f'<robot name="{name}">\n{lines}\n</robot>'


X, Y, Z = "1 0 0", "0 1 0", "0 0 1"
MADE = {
    "scara": chain("scara", [("prismatic", Z), *3 * [("revolute", Z)]], tip=(0.3, 0.0, 0.0)).replace(
        '<origin xyz="0 0 0.3"/><axis', '<origin xyz="0.3 0 0"/><axis'
    ),
    "gantry": chain("gantry", [("prismatic", X), ("prismatic", Y), ("prismatic", Z)]),
    "crane": chain("crane", [("revolute", Z), ("revolute", Y), ("prismatic", Z)]),
    "mixed": chain("mixed", [("prismatic", X), *[("revolute", axis) for axis in (Z, Y, X, Y, Z, Y)]]),
    "slide_and_turn": chain("slide_and_turn", [("prismatic", X), ("revolute", Y)]),
    "snake": chain("snake", [("revolute", (X, Y, Z)[i % 3]) for i in range(30)], length=0.06, mass=0.2),
}
"""Arms with sliding joints, in a plane, and of 30 joints."""

STRANGERS = (*SHIPPED, *MADE)


@functools.cache
def folder() -> Path:
    """A config folder with all of them, as the doctor writes it; made once in a process."""
    place = tempfile.TemporaryDirectory()
    _KEPT.append(place)
    return Path(place.name)


_KEPT: list[tempfile.TemporaryDirectory] = []


def _examine(name):
    if name in SHIPPED and _PACKAGE is None:
        pytest.skip("an arm of the pybullet package, which is not installed")
    if name in SHIPPED:
        path, tip = SHIPPED[name]
        return examination.examine(DATA / path, tip, name)
    path = folder() / f"{name}.urdf"
    path.write_text(MADE[name])
    return examination.examine(path, None, name)


@contextmanager
def short_examination() -> Iterator[None]:
    """Let the doctor compare no engines and search no workspace, which takes 1 s and changes no config."""
    with pytest.MonkeyPatch.context() as patch:
        for left_out in ("compare_engines", "describe_singular", "describe_workspace"):
            patch.setattr(examination, left_out, lambda *_: [])
        yield


@functools.cache
def robot(name) -> str:
    """The name of a third-party arm in the config folder."""
    with counted_apart():
        write_folder(read(name), folder())
    return read(name).name


@functools.cache
def read(name):
    """The doctor's short examination of a third-party arm."""
    with short_examination(), counted_apart():
        return _examine(name)


def config(name, *overrides):
    """The checked config of a run of a third-party arm."""
    return validate(compose([f"robot={robot(name)}", *overrides], [folder()]))
