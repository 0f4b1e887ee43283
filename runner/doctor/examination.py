"""The whole examination of a stranger's URDF or MJCF."""

import copy
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from runner.doctor.engines import compare_engines, compare_readings
from runner.doctor.finding import Finding
from runner.doctor.joints import check_joints
from runner.doctor.links import check_links
from runner.doctor.meshes import check_meshes
from runner.doctor.names import choose_name
from runner.doctor.placements import check_placements
from runner.doctor.postures import (
    check_gravity,
    check_mass_matrix,
    check_tasks,
    describe_singular,
    describe_workspace,
)
from runner.doctor.starting_point import StartingPoint, judge_home, propose
from runner.doctor.tip import choose_tip, frames_at_the_end
from runner.errors import ConfigError
from runner.robots.description import drop_meshes, read_arm
from runner.robots.joint_dynamics import FileDynamics, by_value, dynamics_of
from runner.robots.mjcf import Mjcf, read_mjcf
from runner.robots.mjcf_files import is_mjcf
from runner.robots.model import STANDARD_GRAVITY, RobotModel
from runner.robots.tree import UrdfTree

_POSTURES = 300


@dataclass(frozen=True)
class Examination:
    """What was found of an arm.

    Attributes:
        name: The name under which the robot is to be chosen; see choose_name.
        source: The file.
        mjcf: What was read of it where it is an MJCF, else None.
        tip: The link that is its tip.
        findings: What there is to say, in the order of the examination.
        urdf: The text of the arm's URDF, mended as far as it can be without a choice, without meshes.
        model: The arm of that text; None where something bars it.
        start: Values to start with; None where there is no model.
        dynamics: What the file says of damping, friction and armature; None where there is no model.
    """

    name: str
    source: Path
    mjcf: Mjcf | None
    tip: str
    findings: list[Finding]
    urdf: str
    model: RobotModel | None
    start: StartingPoint | None
    dynamics: FileDynamics | None = None


def examine(path: Path, wanted_tip: str | None, wanted_name: str | None = None) -> Examination:
    """Examine a URDF, or an MJCF as the URDF of the same arm.

    Args:
        path: The file.
        wanted_tip: Name of the link that is to be the tip; None takes the last one.
        wanted_name: Name under which the robot is to be chosen; see choose_name.

    Raises:
        RunnerError: if it is none of one tree, has no such tip, or cannot have the name.
    """
    mjcf = read_mjcf(path) if is_mjcf(path) else None
    original = read_arm(path)
    name, named = choose_name(path, original.robot.get("name", ""), wanted_name)
    tip = choose_tip(original, wanted_tip)
    tree = copy.deepcopy(original)
    findings = [named, *(Finding("note", "names", text) for text in original.renamed)]
    findings += [*check_placements(tree), *check_meshes(tree, path)]
    findings += [*check_links(tree), *check_joints(tree, tip), _name_frames(original, tip)]
    findings += [] if mjcf is None else _left_out(mjcf)
    drop_meshes(tree.links)
    ET.indent(tree.robot)
    urdf = ET.tostring(tree.robot, encoding="unicode")
    barred = [f for f in findings if f.grade == "refused" and ", mesh " not in f.place]
    try:
        model = None if barred else RobotModel(urdf, tip)
    except ConfigError as error:
        findings += [Finding("refused", "model", problem.removeprefix("robot.urdf: ")) for problem in error.problems]
        model = None
    if model is not None and model.nq == 1:
        text = "one joint moves the tip, and the controllers take arms of two or more"
        findings.append(Finding("refused", "model", text))
        model = None
    if model is None:
        return Examination(name, path, mjcf, tip, findings, urdf, None, None)
    generator, (lower, upper) = np.random.default_rng(0), model.usual_range
    postures = generator.uniform(lower, upper, (_POSTURES, model.nq))
    bars = [*check_mass_matrix(model, postures), *(f for f in check_tasks(model) if f.grade == "refused")]
    if bars:
        return Examination(name, path, mjcf, tip, [*findings, *bars], urdf, None, None)
    findings += check_gravity(model, postures)
    if mjcf is None and not any(finding.grade == "refused" for finding in findings):
        findings += compare_readings(path)
    findings += compare_engines(urdf, model, generator)
    findings += [*check_tasks(model), *describe_singular(model, postures), *describe_workspace(model, generator)]
    home, said = judge_home(model, tree.home)
    findings += said
    dynamics = dynamics_of(tree, path.name, STANDARD_GRAVITY)
    findings += _taken(dynamics, model)
    return Examination(name, path, mjcf, tip, findings, urdf, model, propose(model, postures, home), dynamics)


def _left_out(mjcf: Mjcf) -> list[Finding]:
    """Return what an MJCF holds beside bodies, joints and sites."""
    moves = [Finding("note", "left out of the motion", text) for text in mjcf.left_out.motion]
    return [*moves, *(Finding("note", "left out", text) for text in mjcf.left_out.rest)]


def _taken(dynamics: FileDynamics, model: RobotModel) -> list[Finding]:
    """Return what the config takes from the file beside masses."""
    return [
        Finding("note", what, by_value(values, model.joint_names), f"--write gives it by {key}")
        for what, key, values in dynamics.by_key()
        if values.any()
    ]


def _name_frames(tree: UrdfTree, tip: str) -> Finding:
    frames = frames_at_the_end(tree, tip)
    others = [frame for frame in frames if frame != tip]
    mend = f"--tip takes another that the same joints move: {', '.join(others)}" if others else ""
    return Finding("note", "tip", f"'{tip}'", mend)
