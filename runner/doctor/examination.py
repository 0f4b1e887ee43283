"""The whole examination of a stranger's URDF."""

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
from runner.doctor.placements import check_placements
from runner.doctor.postures import (
    check_gravity,
    check_mass_matrix,
    check_tasks,
    describe_singular,
    describe_workspace,
)
from runner.doctor.starting_point import StartingPoint, propose
from runner.doctor.tip import choose_tip, frames_at_the_end
from runner.errors import ConfigError
from runner.robots.description import drop_meshes
from runner.robots.model import RobotModel
from runner.robots.tree import UrdfTree, read_tree

_POSTURES = 300


@dataclass(frozen=True)
class Examination:
    """What was found of an arm.

    Attributes:
        name: The robot's own name.
        source: The file.
        tip: The link that is its tip.
        findings: What there is to say, in the order of the examination.
        urdf: The text mended as far as it can be without a choice, without meshes.
        model: The arm of that text; None where something bars it.
        start: Values to start with; None where there is no model.
    """

    name: str
    source: Path
    tip: str
    findings: list[Finding]
    urdf: str
    model: RobotModel | None
    start: StartingPoint | None


def examine(path: Path, wanted_tip: str | None) -> Examination:
    """Examine a URDF file.

    Args:
        path: The file.
        wanted_tip: Name of the link that is to be the tip; None takes the last one.

    Raises:
        RunnerError: if it is no URDF of one tree, or has no such tip.
    """
    original = read_tree(path)
    tip = choose_tip(original, wanted_tip)
    tree = copy.deepcopy(original)
    findings = [*check_placements(tree), *check_meshes(tree, path)]
    findings += [*check_links(tree), *check_joints(tree, tip), _name_frames(original, tip)]
    drop_meshes(tree.links)
    name = tree.robot.get("name") or path.stem
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
        return Examination(name, path, tip, findings, urdf, None, None)
    generator, (lower, upper) = np.random.default_rng(0), model.usual_range
    postures = generator.uniform(lower, upper, (_POSTURES, model.nq))
    bars = [*check_mass_matrix(model, postures), *(f for f in check_tasks(model) if f.grade == "refused")]
    if bars:
        return Examination(name, path, tip, [*findings, *bars], urdf, None, None)
    findings += check_gravity(model, postures)
    if not any(finding.grade == "refused" for finding in findings):
        findings += compare_readings(path)
    findings += compare_engines(urdf, model, generator)
    findings += [*check_tasks(model), *describe_singular(model, postures), *describe_workspace(model, generator)]
    return Examination(name, path, tip, findings, urdf, model, propose(model, postures))


def _name_frames(tree: UrdfTree, tip: str) -> Finding:
    frames = frames_at_the_end(tree, tip)
    others = [frame for frame in frames if frame != tip]
    mend = f"--tip takes another that the same joints move: {', '.join(others)}" if others else ""
    return Finding("note", "tip", f"'{tip}'", mend)
