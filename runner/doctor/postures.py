"""Checks of an arm's configurations: gravity, mass matrix, tasks, singularities and workspace."""

import math

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.sanitize import few
from runner.doctor.finding import DoctorFinding
from runner.robots.elements import number
from runner.robots.model import RobotModel
from runner.robots.task_space import task_basis
from runner.robots.tree import UrdfTree
from runner.robots.workspace import analyse

_REGULAR = 1e-9  # smallest eigenvalue of a mass matrix with a diagonal of 1
_NO_INERTIA = "links behind a joint have mass, but no inertia about its axis"
_CONDITION = 10.0  # of a Jacobian, above which a posture counts as nearly singular
_STARTS, _SMALL = 3, 12  # best postures for a search of gravity torques; of arms with more joints, one
_SWEEPS, _EVALUATIONS = 10, 30_000  # of that search, at most
SINGULAR = 0.1  # of the reach: the smallest singular value below which controllers damp


def check_gravity(model: RobotModel, postures: FloatArray) -> list[DoctorFinding]:
    """Return the joints whose effort limit is below the largest gravity torque found; see find_largest_gravity."""
    largest = find_largest_gravity(model, postures)
    findings = []
    for name, need, effort, unit in zip(
        model.joint_names, largest, model.effort_limits, model.joint_units, strict=True
    ):
        torque = "N" if unit == "m" else "N m"
        if need > effort:
            asked = f"gravity asks for {need:.3g} {torque} in the worst posture found"
            text = f"{asked}, and its effort limit is {effort:.3g} {torque}"
            findings.append(
                DoctorFinding("note", f"joint '{name}'", text, "check masses and effort; or keep it upright")
            )
    if not findings:
        share = largest / model.effort_limits
        load = share if share.any() else largest
        most = int(np.argmax(load >= load.max() * (1.0 - 1e-6)))  # of equal ones the first
        unit = "N" if model.prismatic[most] else "N m"
        limit = f", {100.0 * share[most]:.2g} % of its effort limit" if share[most] else ", and has no effort limit"
        found = f"{largest[most]:.3g} {unit} in the worst posture found"
        text = f"joint '{model.joint_names[most]}' supports most: {found}{limit}"
        findings.append(DoctorFinding("note", "gravity", text))
    return findings


def find_largest_gravity(model: RobotModel, postures: FloatArray) -> FloatArray:
    """Return the largest gravity torque of each joint that a search within the usual ranges finds, shape (nq,), in N m.

    For each joint, the search starts at zero, in the middle and at those of some postures, shape (N, nq), in which the
    joint supports most. It moves one joint after the other to its best position.
    """
    (lower, upper), torques = model.usual_range, np.abs([model.gravity_torque(q) for q in postures])
    best = _STARTS if model.nq <= _SMALL else 1
    sweeps = max(1, min(_SWEEPS, _EVALUATIONS // (2 * (best + 2) * model.nq**2)))
    largest = torques.max(axis=0)
    for joint in range(model.nq):
        chosen = postures[np.argsort(-torques[:, joint], kind="stable")[:best]]
        starts = [*chosen, np.clip(np.zeros(model.nq), lower, upper), (lower + upper) / 2.0]
        found = [_climb(model, joint, np.array(start), sweeps) for start in starts]
        largest[joint] = max(largest[joint], *found)
    return np.asarray(largest)


def _climb(model: RobotModel, joint: int, q: FloatArray, sweeps: int) -> float:
    """Return the largest gravity torque of a joint near a posture, shape (nq,), which is changed; in N m.

    Along one joint the torque is exactly a constant and a sinusoid, or linear for a prismatic joint.
    """

    def torque(mover: int, position: float) -> float:
        q[mover] = position
        return float(model.gravity_torque(q)[joint])

    value = abs(torque(0, q[0]))
    for _ in range(sweeps):
        before = value
        for mover, (low, high) in enumerate(model.usual_range.T.tolist()):
            start = float(q[mover])
            places = [start, low, high]
            if not model.prismatic[mover]:
                here, across, opposite = (torque(mover, start + turn * np.pi / 2.0) for turn in range(3))
                top = start + math.atan2(across - (here + opposite) / 2.0, (here - opposite) / 2.0)
                inner = [low + (place - low) % (2.0 * np.pi) for place in (top, top + np.pi)]
                places += [place for place in inner if place <= high]
            value, q[mover] = max((abs(torque(mover, place)), place) for place in places)
        if value <= before * (1.0 + 1e-6):
            break
    return value


def check_mass_matrix(tree: UrdfTree, model: RobotModel, postures: FloatArray) -> list[DoctorFinding]:
    """Return why torques cannot move the arm, whose mass matrix is singular in one of some postures, shape (N, nq)."""
    least = min(float(np.linalg.eigvalsh(_scaled(model.mass_matrix(q)))[0]) for q in postures)
    if least > _REGULAR:
        return []
    heavy = {name for name, link in tree.links.items() if number(link.find("inertial/mass"), "value") > 0.0}
    free = [joint for joint in model.joint_names if not any(joint in tree.way(link) for link in heavy)]
    why = "no link has a mass" if len(free) == model.nq else f"no mass behind {few(free)}" if free else _NO_INERTIA
    text = f"{why}: torques cannot move it; the config takes plant=kinematic, whose joints follow every command"
    return [
        DoctorFinding("note", "mass", text, "for torques, give the links behind every joint <inertial> with their mass")
    ]


def _scaled(M: FloatArray) -> FloatArray:
    size = np.sqrt(np.maximum(np.diagonal(M), 1e-300))
    return np.asarray(M / np.outer(size, size))


def check_tasks(model: RobotModel) -> list[DoctorFinding]:
    """Return the tasks for which the arm has enough joints."""
    position, pose = (len(task_basis(model, turned)) for turned in (False, True))
    if not position:
        text = f"no joint moves '{model.tip_name}' from its place: the axes pass through it"
        return [
            DoctorFinding("refused", "tip", text, "choose another by --tip, or add a link at the tool centre point")
        ]
    if position > model.nq:
        text = f"{model.nq} joints move the tip in {position} dependent directions: no built-in controller fits"
        return [DoctorFinding("refused", "tasks", text, "choose another by --tip")]
    where = {3: "in 3 directions", 2: "in a plane", 1: "along a line"}[position]
    turned = f"a pose has {pose} dimensions" + ("" if pose <= model.nq else ", more than there are joints")
    spare = f", {model.nq - position} of them redundant," if model.nq > position else ""
    return [DoctorFinding("note", "tasks", f"{model.nq} joints{spare} move the tip {where}; {turned}")]


def smallest_singular_values(model: RobotModel, postures: FloatArray, pose: bool) -> FloatArray:
    """Return the smallest singular value of the task's Jacobian at postures, shape (N, nq) to (N,), in m."""
    return _singular_values(model, postures, pose)[:, -1]


def _singular_values(model: RobotModel, postures: FloatArray, pose: bool) -> FloatArray:
    """Return the singular values of the task's Jacobian at postures, shape (N, nq) to (N, k), the largest first, in m.

    Turns count as the way that they move a point a reach away, and so do slides against turns.
    """
    directions = task_basis(model, pose)
    rows = np.where(directions[:, :3].any(axis=1), 1.0, model.reach)
    columns = np.where(model.prismatic, model.reach, 1.0)
    J = [rows[:, None] * (directions @ model.tip_jacobian(q)[: directions.shape[1]]) * columns for q in postures]
    return np.asarray(np.linalg.svd(np.array(J), compute_uv=False))


def describe_singular(model: RobotModel, postures: FloatArray) -> list[DoctorFinding]:
    """Return the fraction of postures, shape (N, nq), that are nearly singular for the tip's position."""
    if model.nq < len(task_basis(model, pose=False)):
        return []
    values = _singular_values(model, postures, pose=False)
    smallest = values[:, -1]
    worst = postures[int(smallest.argmin())]
    if smallest.max() < 1e-9 * model.reach:
        text = "the tip's position is singular in every posture: a joint's axis passes through it"
        return [
            DoctorFinding("refused", "tip", text, "choose another by --tip, or add a link at the tool centre point")
        ]
    share = float((values[:, 0] > _CONDITION * smallest).mean())
    slides = f", with slides counted as shares of the reach, {model.reach:.3g} m," if model.prismatic.any() else ""
    text = (
        f"in {100.0 * share:.0f} % of all postures the Jacobian of the tip's position{slides} has a condition number "
        f"above {_CONDITION:g}; the nearest to a singular one that was found is q = {np.round(worst, 2).tolist()}"
    )
    return [DoctorFinding("note", "singular postures", text, "keep paths away, or singularity_damping above 0")]


def describe_workspace(model: RobotModel, generator: np.random.Generator) -> list[DoctorFinding]:
    """Return the range of distances of the tip from the first joint, and of its heights."""
    found = analyse(model, 200, generator)
    near, far, low, high = np.round([found.inner, found.outer, *np.quantile(found.tips[:, 2], (0.0, 1.0))], 3)
    text = (
        f"the tip comes {near:g} to {far:g} m from the first joint at {np.round(model.shoulder, 3).tolist()} m, "
        f"and was seen at heights from {low:g} to {high:g} m"
    )
    return [DoctorFinding("note", "workspace", text)]
