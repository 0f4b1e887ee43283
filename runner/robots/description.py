"""URDF of a robot: file lookup, checks, and changes from the config."""

import contextlib
import math
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from runner.base.errors import ConfigError, nearest
from runner.base.paths import check_inside, robots_dir
from runner.robots.canonical import write_text
from runner.robots.elements import (
    TENSOR,
    absurd_inertial,
    moves,
    number,
    wrong_friction,
    wrong_limits,
    wrong_mass,
    wrong_places,
)
from runner.robots.inertials import (
    Payload,
    add_payload,
    armature_by_joint,
    impossible_inertia,
    make_massless,
    replace_inertials,
    scale_inertial,
    write_armature,
)
from runner.robots.tree import UrdfTree, is_mjcf, read_tree, tree_of

if TYPE_CHECKING:
    from runner.robots.mjcf import Mjcf


def find_urdf(name: str, config_dirs: Sequence[Path] = ()) -> Path:
    """Return the path of a URDF from the value of `robot.urdf`; see find_file."""
    return find_file("robot.urdf", name, config_dirs)


def find_file(key: str, name: str, config_dirs: Sequence[Path] = ()) -> Path:
    """Return the path of the file of an arm.

    Args:
        key: The config key, `robot.urdf` or `robot.mjcf`.
        name: Value of the key: an absolute path, or a file in a user-supplied config folder or of a built-in robot.
        config_dirs: User-supplied config folders; each is searched itself and in its subfolder `robots`.

    Raises:
        ConfigError: if the file does not exist, with the folders searched, or if it is outside these folders.
    """
    if ".." in Path(name).parts:
        raise ConfigError(f"{key}: '{name}' leads out of its folder; put the file there, or give its whole path")
    places = [place for folder in config_dirs for place in (folder / "robots", folder)] + [robots_dir()]
    candidates = [Path(name)] if Path(name).is_absolute() else [place / name for place in places]
    for candidate in candidates:
        with contextlib.suppress(OSError):  # a name that is too long for a file, a folder that cannot be read
            if candidate.is_file():
                check_inside(candidate, config_dirs)
                return candidate
    own = sorted(path.name for path in robots_dir().glob("*.urdf" if key == "robot.urdf" else "*.xml"))
    ours = f"; ours: {', '.join(own)}" if own else ""
    raise ConfigError(
        f"{key}: no file '{name}'{nearest(name, own)}; looked in {', '.join(str(c.parent) for c in candidates)}{ours}"
    )


def read_arm(path: Path) -> UrdfTree:
    """Read the file of an arm, a URDF or an MJCF, as the tree of links of a URDF.

    Raises:
        ConfigError: if the file is neither; see read_tree and read_mjcf.
    """
    if is_mjcf(path):
        mjcf = mjcf_of(path)
        return replace(tree_of(mjcf.urdf, path), ties=mjcf.ties, home=mjcf.home)
    return read_tree(path)


def mjcf_of(path: Path) -> "Mjcf":
    """Read an MJCF; see read_mjcf. The first call imports MuJoCo, which takes 0.25 s."""
    from runner.robots.mjcf import read_mjcf

    return read_mjcf(path)


def read_urdf(
    path: Path,
    masses: Mapping[str, float],
    armature: float | Sequence[float] | str = 0.0,
    inertials: str | None = None,
    velocity_limits: Mapping[str, float] | None = None,
) -> str:
    """Return the canonical text of an arm with the given changes; see write_text.

    Args:
        path: File of the arm, a URDF or an MJCF.
        masses: Mass of links by name, in kg. The inertia is scaled with the mass (a uniform change of density). Other
            links do not change.
        armature: Reflected inertia of motor and gear, in kg m^2, which is added to the diagonal of the mass matrix
            only. One value for all joints, a list with one for each, or the name of a set; see armature_by_joint.
        inertials: Set of inertials that replaces those of the file, before `masses`; see replace_inertials.
        velocity_limits: Largest speed of joints by name, in rad/s; other joints do not change.

    Raises:
        ConfigError: if the file does not describe one serial arm, if a set, link or joint does not exist, if a link in
            `masses` has no mass, or if a mass, inertia, position or limit is impossible for an arm.
    """
    tree = read_arm(path)
    links = tree.links
    from_set = {} if inertials is None else replace_inertials(links, path, inertials)
    problems = _check_numbers(path, tree, from_set) + _check_joints(path, tree)
    for name in masses:
        if name not in links:
            problems.append(f"robot.masses.{name}: no such link{nearest(name, links)}; links: {', '.join(links)}")
        elif not _mass(links[name]) > 0.0:
            problems.append(f"robot.masses.{name}: link '{name}' is massless in {path.name}; its mass cannot be scaled")
    for name, speed in (velocity_limits or {}).items():
        if name not in tree.chain:
            problems.append(f"robot.velocity_limits.{name}: {tree.no_joint(name)}")
            continue
        for limit in tree.joints[name].findall("limit"):
            limit.set("velocity", repr(float(speed)))
    if problems:
        raise ConfigError(problems)
    for link in links.values():
        if link.find("inertial/inertia") is None:
            make_massless(link)
    for name, mass in masses.items():
        scale_inertial(links[name], mass)
    write_armature(tree, armature_by_joint(tree, path, armature))
    return write_text(tree.robot)


def with_payloads(urdf: str, payloads: Sequence[Payload]) -> str:
    """Return a URDF with point masses fixed on links.

    Raises:
        ConfigError: if a payload is on a frame that is not a link.
    """
    if not any(payload.mass for payload in payloads):
        return urdf
    robot = ET.fromstring(urdf)  # noqa: S314 - our own text
    links = {link.get("name", ""): link for link in robot.findall("link")}
    for payload in payloads:
        if payload.mass:
            add_payload(links, payload)
    return write_text(robot)


def _check_joints(path: Path, tree: UrdfTree) -> list[str]:
    """Return messages about branches, coupled joints and their types: each file must describe one serial arm."""
    chain = tree.chain
    beside = sorted(name for name, joint in tree.joints.items() if moves(joint) and name not in chain)
    held = "`runner doctor FILE --tip FRAME --output DIR` holds fixed what does not move the tip"
    if beside:
        return [
            f"robot.urdf: {path} branches: {', '.join(beside)} move in addition to {', '.join(sorted(chain))}; "
            f"allowed: a serial arm; {held}"
        ]
    tied = [
        f"robot.urdf: joint '{name}' in {path} {tree.ties[name]}, and its motion would be free; take that out; {held}"
        for name in chain
        if name in tree.ties
    ]
    kinds = {name: tree.joints[name].get("type", "") for name in chain}
    allowed = "allowed: revolute or prismatic; `runner doctor FILE --output DIR` makes a continuous joint revolute"
    return tied + [
        f"robot.urdf: joint '{name}' in {path} is {kind or 'of no type'}; {allowed}"
        for name, kind in kinds.items()
        if kind not in ("revolute", "prismatic")
    ]


def _check_numbers(path: Path, tree: UrdfTree, from_set: Mapping[str, str]) -> list[str]:
    """Return messages about impossible numbers; `from_set` is the source of inertials that are not from the file."""
    problems = []
    for name, link in tree.links.items():
        places = [f"{text}; {remedy}" for text, remedy in wrong_places(link)]
        whence = from_set.get(name, f"robot.urdf: link '{name}' in {path} has")
        problems += [f"robot.urdf: link '{name}' in {path} has {bad}" for bad in places]
        problems += [] if places else [f"{whence} {bad}" for bad in _bad_inertial(link)]
    for name, joint in tree.joints.items():
        places = [f"{text}; {remedy}" for text, remedy in wrong_places(joint)]
        wrong = [*places, *wrong_limits(joint), *wrong_friction(joint)]
        problems += [f"robot.urdf: joint '{name}' in {path} has {bad}" for bad in wrong]
    return problems


def _mass(link: ET.Element) -> float:
    return number(link.find("inertial/mass"), "value")


def _bad_inertial(link: ET.Element) -> list[str]:
    if link.find("inertial") is None:
        return []  # a massless frame
    if link.find("inertial/mass") is None:
        return ["an <inertial> without <mass>: write its mass, in kg"]
    return [*wrong_mass(link), *absurd_inertial(link)] or _bad_inertia(link)


def _bad_inertia(link: ET.Element) -> list[str]:
    inertia = link.find("inertial/inertia")
    if inertia is None:
        lost = "no <inertia>, and Pinocchio would leave its mass out: write all six moments, in kg m^2"
        return [lost] if _mass(link) > 0.0 else []
    values = {key: number(inertia, key) for key in TENSOR}
    wrong = [
        f"inertia {key} that is missing or no finite number"
        for key, value in values.items()
        if not math.isfinite(value)
    ]
    return wrong or impossible_inertia(link)
