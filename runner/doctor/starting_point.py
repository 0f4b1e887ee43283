"""Start values for a robot: home configuration, goal, and natural frequency of the controller."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.doctor.finding import DoctorFinding
from runner.doctor.postures import SINGULAR, smallest_singular_values
from runner.robots.model import RobotModel
from runner.robots.task_space import distance_beside, task_basis

_STEP = 0.15  # of the reach, from home to goal
_FAR = 1.0  # rad: farther no joint turns to the goal
_FASTEST, _SLOWEST = 20.0, 2.0  # rad/s
_SPARE = 0.5  # of the effort that gravity leaves at home


@dataclass(frozen=True)
class StartingPoint:
    """Values that a robot's file needs in addition to its URDF.

    Attributes:
        home: Joint positions, shape (nq,), in rad (m for prismatic joints).
        goal: Tip position, shape (3,), in m.
        natural_frequency: omega_n of its controller, in rad/s.
    """

    home: FloatArray
    goal: FloatArray
    natural_frequency: float


def propose(model: RobotModel, postures: FloatArray, home: FloatArray | None) -> StartingPoint:
    """Return values for an arm.

    Home is the one given, shape (nq,), or the posture above the ground that is farthest from singular configurations.

    The goal lies a small step away, where the joints can go; and the natural frequency is such that a sudden step to
    it asks for no more than half of the effort that gravity leaves, between 2 and 20 rad/s.
    """
    home = _home(model, postures) if home is None else home
    goal = _goal(model, home, postures)
    return StartingPoint(home, goal, _natural_frequency(model, home, goal))


def judge_home(model: RobotModel, given: Mapping[str, float]) -> tuple[FloatArray | None, list[DoctorFinding]]:
    """Return the posture of a file's keyframe `home`, by joint, and what there is to say of it.

    It is None where there is none, or where it does not serve as a home: beyond limits, singular, or too heavy to hold.
    """
    if not given:
        return None, []
    home = np.array([given[name] for name in model.joint_names])
    lower, upper = model.position_limits
    wrong = [
        f"it has '{name}' at {value:g} {unit}, and its limits are {low:g} to {high:g}"
        for name, unit, value, low, high in zip(model.joint_names, model.joint_units, home, lower, upper, strict=True)
        if not low <= value <= high
    ]
    if not wrong and smallest_singular_values(model, home[None], pose=False)[0] < SINGULAR * model.reach:
        wrong = ["it is singular for the tip's position, or nearly so"]
    if not wrong and (np.abs(model.gravity_torque(home)) > model.effort_limits).any():
        wrong = ["gravity asks for more there than the effort limits"]
    if wrong:
        return None, [DoctorFinding("note", "home", f"the keyframe 'home' is not taken: {'; '.join(wrong)}")]
    return home, [DoctorFinding("note", "home", "the keyframe 'home' is taken")]


def _home(model: RobotModel, postures: FloatArray) -> FloatArray:
    middle = postures.mean(axis=0)
    candidates = np.round(middle + 0.8 * (postures - middle), 2)
    pose = model.nq >= len(task_basis(model, pose=True))
    score = smallest_singular_values(model, candidates, pose) / model.reach
    lowest = [min(model.frame_poses(q, (*model.joint_names, model.tip_name))[1:, 2, 3]) for q in candidates]
    score = score - np.where(np.array(lowest) < min(0.0, float(model.shoulder[2])) - 1e-9, 1.0, 0.0)
    gravity = np.abs([model.gravity_torque(q) for q in candidates])
    score = score - np.where((gravity > 0.7 * model.effort_limits).any(axis=1), 0.5, 0.0)
    # Of equally good ones the one that turns least.
    return np.asarray(candidates[int(np.argmax(score - 0.01 * np.abs(candidates).max(axis=1)))])


def _goal(model: RobotModel, home: FloatArray, postures: FloatArray) -> FloatArray:
    """Return the tip positions on the way from home to the posture farthest from singular ones."""
    tip, (lower, upper) = model.tip_position(home), model.position_limits
    best, most = tip, -1.0
    for way in postures - home:
        moved = float(np.linalg.norm(model.tip_jacobian(home)[:3] @ way))
        q = home + way * min(_STEP * model.reach / max(moved, 1e-12), 1.0)
        room = float(smallest_singular_values(model, q[None], pose=False)[0])
        far = np.abs(q - home)[~model.prismatic].max(initial=0.0) > _FAR
        if room > most and not far and np.all((q >= lower) & (q <= upper)):
            best, most = model.tip_position(q), room
    rounded = np.round(best, 3)
    return np.asarray(rounded) if distance_beside(model, rounded[None])[0] < 1e-12 else best


def _natural_frequency(model: RobotModel, home: FloatArray, goal: FloatArray) -> float:
    J = task_basis(model, pose=False) @ model.tip_jacobian(home)[:3]
    step = task_basis(model, pose=False) @ (goal - model.tip_position(home))
    torque = np.abs(model.mass_matrix(home) @ np.linalg.lstsq(J, step, rcond=None)[0])  # at omega_n = 1 rad/s
    spare = _SPARE * (model.effort_limits - np.abs(model.gravity_torque(home)))
    with np.errstate(divide="ignore"):
        fastest = float(np.sqrt(np.maximum(np.min(spare / np.maximum(torque, 1e-12)), 0.0)))
    return float(np.floor(np.clip(fastest, _SLOWEST, _FASTEST)))
