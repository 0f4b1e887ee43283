"""Examination of a third-party URDF or MJCF, and the name of its robot."""

import copy
import re
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from runner.base.errors import ConfigError, RunnerError
from runner.base.sanitize import few
from runner.config.compose.files import group_options
from runner.doctor.bodies import check_joints, check_links, check_meshes, check_placements, check_units
from runner.doctor.engines import compare_engines
from runner.doctor.finding import DoctorFinding, together
from runner.doctor.postures import (
    check_gravity,
    check_mass_matrix,
    check_tasks,
    describe_singular,
    describe_workspace,
)
from runner.doctor.starting_point import StartingPoint, judge_home, propose
from runner.doctor.tip import choose_tip, name_tips
from runner.robots.canonical import write_text
from runner.robots.description import read_arm
from runner.robots.elements import TENSOR, number
from runner.robots.inertials import impossible_inertia
from runner.robots.joint_dynamics import FileDynamics, by_value, dynamics_of
from runner.robots.mjcf import Mjcf, read_mjcf
from runner.robots.model import STANDARD_GRAVITY, RobotModel
from runner.robots.tree import UrdfTree, is_mjcf

_GENERAL = {
    "arm_",
    "arm",
    "main",
    "mjcf",
    "model",
    "mujoco_model",
    "robot",
    "robots",
    "scene",
    "urdf",
    "xml",
}  # of any arm
_WORDS = {"false", "n", "no", "null", "off", "on", "true", "y", "yes"}  # that YAML takes for something else


def choose_name(path: Path, header: str, wanted: str | None) -> tuple[str, DoctorFinding]:
    """Return the name of an arm, of lower-case letters, digits and underscores, and what there is to say of it.

    It is the one wanted, else that of the file; where that could be any arm's, the one in the file, else that of the
    nearest folder around it. It begins with `my_` if a built-in robot has the name.

    Args:
        path: The arm's file.
        header: The name in the file.
        wanted: The name wanted; None for none.

    Raises:
        RunnerError: if the name wanted is that of a built-in robot, or holds other letters.
    """
    ours = group_options("robot")
    if wanted is not None:
        if wanted != _plain(wanted):
            raise RunnerError(f"--name: '{wanted}'; allowed: a lower-case letter, then such, digits and underscores")
        if wanted in ours:
            raise RunnerError(f"--name: '{wanted}' is one of our robots; choose another name, such as my_{wanted}")
        return wanted, DoctorFinding("note", "name", f"'{wanted}'")
    whole = path.resolve()
    stem = re.sub(r"(\.(urdf|xml|xacro|mjcf))+$", "", whole.name, flags=re.IGNORECASE)
    names = map(_plain, (stem, header, *(folder.name for folder in whole.parents)))
    own = next((name for name in names if name not in _GENERAL), "arm")
    name = f"my_{own}" if own in ours else own
    said = [f"'{name}'"] + [f"'{own}' is one of ours"] * (name != own)
    said += [f"the file says '{header}'"] if _plain(header) != own and header else []
    return name, DoctorFinding("note", "name", "; ".join(said), "--name gives another")


def _plain(name: str) -> str:
    plain = re.sub(r"\W+", "_", name.lower(), flags=re.ASCII).strip("_")
    return f"arm_{plain}" if plain in _WORDS or not plain[:1].isalpha() else plain


_POSTURES = 300


@dataclass(frozen=True)
class ExaminedArm:
    """An arm that the runner takes.

    Attributes:
        model: Its rigid-body model.
        start: Values to start with.
        has_mass: Whether its joints move mass, so that torques can move it; else only its kinematics are known.
        dynamics: What the file says of damping, friction and armature.
    """

    model: RobotModel
    start: StartingPoint
    has_mass: bool
    dynamics: FileDynamics


@dataclass(frozen=True)
class Examination:
    """Findings on an arm.

    Attributes:
        name: The name under which the robot is to be chosen; see choose_name.
        source: The file.
        mjcf: What was read of it where it is an MJCF, else None.
        tip: The link that is its tip.
        findings: What there is to say: what is refused, what was fixed, and notes.
        urdf: The text of the arm's URDF, fixed as far as it can be without a choice, without meshes.
        arm: The arm of that text; None where something is refused.
    """

    name: str
    source: Path
    mjcf: Mjcf | None
    tip: str
    findings: list[DoctorFinding]
    urdf: str
    arm: ExaminedArm | None


def examine(
    path: Path, wanted_tip: str | None = None, wanted_name: str | None = None, packages: Sequence[Path] = ()
) -> Examination:
    """Examine a URDF, or an MJCF as the URDF of the same arm.

    Args:
        path: The file.
        wanted_tip: Name of the link that is to be the tip; None for choose_tip to choose.
        wanted_name: Name under which the robot is to be chosen; see choose_name.
        packages: Folders that hold ROS packages.

    Raises:
        RunnerError: if it is none of one tree, has no such tip, or cannot have the name.
    """
    mjcf = read_mjcf(path) if is_mjcf(path) else None
    original = read_arm(path)
    name, named = choose_name(path, original.robot.get("name", ""), wanted_name)
    tree = copy.deepcopy(original)
    try:
        tip = choose_tip(original, wanted_tip)
    except RunnerError as error:
        others = [str(each) for each in (*check_placements(tree), *check_links(tree)) if each.grade == "refused"]
        raise ConfigError([str(error), *others]) if others else error from None
    findings = [named, name_tips(original, tip)]
    findings += [DoctorFinding("note", "names", few(original.renamed))] if original.renamed else []
    findings += [DoctorFinding("fixed", *change) for change in original.changes]
    findings += [*check_placements(tree), *check_meshes(tree, path, packages)]
    findings += [] if _refused(findings) else check_units(tree)
    impossible = {name: dict(part.attrib) for name, part in _impossible_inertias(tree).items()}
    findings += check_links(tree)
    findings += [*check_joints(tree, tip), *_left_out(tree, mjcf)]
    urdf = write_text(tree.robot)
    arm = None if _refused(findings) else _take(tree, path.name, urdf, tip, findings)
    if arm is not None and impossible:
        findings.append(_describe_mend(tree, impossible, arm.model))
    return Examination(name, path, mjcf, tip, together(findings), urdf, None if _refused(findings) else arm)


def _refused(findings: Sequence[DoctorFinding]) -> bool:
    return any(finding.grade == "refused" for finding in findings)


def _impossible_inertias(tree: UrdfTree) -> dict[str, ET.Element]:
    """Return the inertias that no rigid body has, by link."""
    inertias = {name: link.find("inertial/inertia") for name, link in tree.links.items()}
    complete = {
        name: inertia
        for name, inertia in inertias.items()
        if inertia is not None and np.isfinite([number(inertia, key) for key in TENSOR]).all()
    }
    return {name: inertia for name, inertia in complete.items() if impossible_inertia(tree.links[name])}


def _describe_mend(tree: UrdfTree, impossible: Mapping[str, Mapping[str, str]], model: RobotModel) -> DoctorFinding:
    """Return the effect of corrected inertias on the mass matrix, in the middle of the joint ranges."""
    before = copy.deepcopy(tree)
    for name, attributes in impossible.items():
        inertia = before.links[name].find("inertial/inertia")
        if inertia is not None:
            inertia.attrib.update(attributes)
    q = model.usual_range.mean(axis=0)
    M, written = model.mass_matrix(q), RobotModel(write_text(before.robot), model.tip_name).mass_matrix(q)
    diagonal = np.sqrt(np.maximum(np.diagonal(M), 1e-300))
    change = float(np.abs((M - written) / np.outer(diagonal, diagonal)).max())
    return DoctorFinding("note", "mass matrix", f"the corrected inertias change it by up to {100.0 * change:.2g} %")


def _take(tree: UrdfTree, source: str, urdf: str, tip: str, findings: list[DoctorFinding]) -> ExaminedArm | None:
    """Build an arm and look at what it can do; add what is found to the findings. None where that is refused."""
    try:
        model = RobotModel(urdf, tip)
    except ConfigError as error:
        findings += [
            DoctorFinding("refused", "model", problem.removeprefix("robot.urdf: ")) for problem in error.problems
        ]
        return None
    if model.nq == 1:
        findings.append(
            DoctorFinding("refused", "model", "one joint moves the tip; controllers take arms of two or more")
        )
        return None
    generator, (lower, upper) = np.random.default_rng(0), model.usual_range
    postures = generator.uniform(lower, upper, (_POSTURES, model.nq))
    findings += check_tasks(model)
    findings += [] if _refused(findings) else describe_singular(model, postures)
    if _refused(findings):
        return None
    massless = check_mass_matrix(tree, model, postures)
    findings += massless or [*check_gravity(model, postures), *compare_engines(urdf, model, generator)]
    findings += describe_workspace(model, generator)
    home, said = judge_home(model, tree.home)
    dynamics = dynamics_of(tree, source, STANDARD_GRAVITY)
    findings += [*said, *_taken(dynamics, model)]
    return ExaminedArm(model, propose(model, postures, home), not massless, dynamics)


def _left_out(tree: UrdfTree, mjcf: Mjcf | None) -> list[DoctorFinding]:
    """Return the properties of a file that runs leave out, and the unused parts of an MJCF.

    The copy of a URDF has no such elements. Runs of an MJCF report them again.
    """
    if mjcf is not None:
        moves = [DoctorFinding("note", "left out of the motion", text) for text in mjcf.left_out.motion]
        return [*moves, *(DoctorFinding("note", "left out", text) for text in mjcf.left_out.rest)]
    elements = tree.robot.findall("left_out")
    for element in elements:
        tree.robot.remove(element)
    return [DoctorFinding("note", "left out of the motion", element.get("text", "")) for element in elements]


def _taken(dynamics: FileDynamics, model: RobotModel) -> list[DoctorFinding]:
    """Return the values that the config takes from the file, without masses."""
    return [
        DoctorFinding("note", what, by_value(values, model.joint_names), f"--output gives it by {key}")
        for what, key, values in dynamics.by_key()
        if values.any()
    ]
