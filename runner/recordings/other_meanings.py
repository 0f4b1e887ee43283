"""Other meanings of a log's columns, and a payload that its torques may fit better instead."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from runner.base.arrays import FloatArray
from runner.recordings.columns_map import Signal
from runner.recordings.recording import Recording
from runner.robots.model import RobotModel
from runner.schema.units import WRITTEN

_SAME_UNIT = 1e-6
_ARM_OF_PAYLOAD = 0.3  # m, up to which the centre of a payload may be away from the tip
_LEAST_PAYLOAD = 1e-3  # kg
_HEAVIEST = 5.0  # times the arm
_BEYOND = 1.2  # times the limit of a joint's torque, which no payload reaches
_SWAPPED, _EACH = "fit if they are exchanged", "each the joint of the other"
_TURNED = "sign: -1 for both"
HALF_TURN = f"Say {_TURNED}."
"""End of the question whether the tip is said in a base that is turned by half a turn, as UR's controller has it."""
NO_GRAVITY = "holds: without_gravity"
"""The line that says that gravity is not in the torques."""
WITHOUT_GRAVITY = f"Say {NO_GRAVITY}."
"""End of the question whether gravity is in the torques."""
MOVES, OF_NOISE = 1e-4, 6.0
"""What moves by less shows nothing: in rad or m, and in rms of the noise of its encoder."""


@dataclass(frozen=True)
class EvenMotion:
    """Even rows of a log: positions with derivatives, and what they are compared with, NaN where not recorded.

    `moves` is True for each joint whose motion stands out from the noise of its encoder, shape (nq,).
    """

    moves: NDArray[np.bool_]
    q: FloatArray
    dq: FloatArray
    ddq: FloatArray
    torque: FloatArray
    tip: FloatArray
    reference: FloatArray


Change = Callable[[EvenMotion], EvenMotion]
"""Function of a motion that returns it with another meaning of its columns."""


@dataclass(frozen=True)
class OtherMeaning:
    """Another meaning of columns: its words, the line that settles it, and the motion that it makes."""

    words: str
    line: str
    change: Change


def other_meanings(model: RobotModel, recording: Recording, motion: EvenMotion) -> Iterator[OtherMeaning]:
    """Yield the meanings that columns may have instead of those that they are said to have.

    Args:
        model: The arm.
        recording: The log.
        motion: Its motion.
    """
    joints = model.joint_names
    columns = {signal: f"columns.{name}" for signal, name in recording.columns.items()}
    torques = [place for place in range(len(joints)) if not np.isnan(motion.torque[0, place])]
    moving = np.flatnonzero(motion.moves).tolist()
    for place in moving:
        name = columns[Signal("position", joints[place])]
        yield _opposite(recording, name, place, "q")
        for factor, unit in _others(recording, name, "rad", ("deg", "rad")):
            yield OtherMeaning(f"{name}: fits if it is in {unit}", f"unit: {unit}", scaled(place, factor))
    whole_in = columns[Signal("position", joints[0])]
    for factor, unit in _others(recording, whole_in, "rad", ("deg", "rad")):
        whole = f"columns of positions: fit if they are in {unit}"
        yield OtherMeaning(whole, f"unit: {unit}", _all_scaled(factor))
    for one, other in combinations(range(len(joints)), 2):
        pair = [columns[Signal("position", joints[place])] for place in (one, other)]
        yield OtherMeaning(f"{pair[0]} and {pair[1]}: {_SWAPPED}", _EACH, _exchanged(one, other, "q"))
    axes = np.flatnonzero(~np.isnan(motion.tip[0])).tolist()
    for place in axes:
        name = columns[Signal("tip", "xyz"[place])]
        yield _opposite(recording, name, place, "tip")
        for factor, unit in _others(recording, name, "m", ("mm", "m")):
            yield OtherMeaning(f"{name}: fits if it is in {unit}", f"unit: {unit}", scaled(place, factor, "tip"))
    if {0, 1} <= set(axes):
        pair = [columns[Signal("tip", axis)] for axis in "xy"]
        words = f"{pair[0]} and {pair[1]}: fit with opposite signs, as in a base that is turned by half a turn about z"
        yield OtherMeaning(words, _TURNED, lambda motion: replace(motion, tip=motion.tip * [-1.0, -1.0, 1.0]))
    for place in torques:
        yield _opposite(recording, columns[Signal("torque", joints[place])], place, "torque")
    for one, other in combinations(torques, 2):
        pair = [columns[Signal("torque", joints[place])] for place in (one, other)]
        yield OtherMeaning(f"{pair[0]} and {pair[1]}: {_SWAPPED}", _EACH, _exchanged(one, other, "torque"))
    if torques and recording.holds != "without_gravity":
        whole = "columns of torques: fit if gravity is not in them"
        yield OtherMeaning(whole, NO_GRAVITY, _gravity_added(model))


def _opposite(recording: Recording, name: str, place: int, what: str) -> OtherMeaning:
    sign = -1 if recording.units[name.removeprefix("columns.")].factor > 0.0 else 1
    return OtherMeaning(f"{name}: fits with the opposite sign", f"sign: {sign}", scaled(place, -1.0, what))


def _others(recording: Recording, column: str, si: str, units: Sequence[str]) -> Iterator[tuple[float, str]]:
    """Yield the units that a column is not said to have, each with the factor that it would change the signal by."""
    said = abs(recording.units[column.removeprefix("columns.")].factor)
    for unit in units:
        factor = float(WRITTEN[si][unit]) / said
        if abs(factor - 1.0) > _SAME_UNIT:
            yield factor, unit


def _gravity_added(model: RobotModel) -> Change:
    def change(motion: EvenMotion) -> EvenMotion:
        return replace(motion, torque=motion.torque + np.array([model.gravity_torque(q) for q in motion.q]))

    return change


def scaled(place: int, factor: float, what: str = "q") -> Change:
    """Return the change of one column by a factor.

    Args:
        place: Index of the joint or axis.
        factor: The factor.
        what: q, tip or torque.
    """

    def change(motion: EvenMotion) -> EvenMotion:
        factors = np.ones(getattr(motion, what).shape[1])
        factors[place] = factor
        return _times(motion, factors) if what == "q" else replace(motion, **{what: getattr(motion, what) * factors})

    return change


def _all_scaled(factor: float) -> Change:
    return lambda motion: _times(motion, np.full(motion.q.shape[1], factor))


def _times(motion: EvenMotion, factors: FloatArray) -> EvenMotion:
    return replace(motion, q=motion.q * factors, dq=motion.dq * factors, ddq=motion.ddq * factors)


def _exchanged(one: int, other: int, what: str) -> Change:
    def change(motion: EvenMotion) -> EvenMotion:
        order = np.arange(motion.q.shape[1])
        order[[one, other]] = other, one
        if what == "torque":
            return replace(motion, torque=motion.torque[:, order])
        return replace(motion, q=motion.q[:, order], dq=motion.dq[:, order], ddq=motion.ddq[:, order])

    return change


def fit_payload(
    model: RobotModel, motion: EvenMotion, torques_of: Callable[[RobotModel], FloatArray]
) -> tuple[float, FloatArray] | None:
    """Return the mass, in kg, and the centre in the frame of the tip, in m, that fit all torques best; None without.

    No payload explains torques far beyond their limits, or is as heavy as five arms. Joints weigh alike.
    Friction and the inertias of the rotors are free.

    Args:
        model: The arm.
        motion: The motion, with torques.
        torques_of: Torques of an arm at the motion, shape (N, nq).
    """
    recorded = np.flatnonzero(~np.isnan(motion.torque[0]))
    if not len(recorded) or np.any(np.abs(motion.torque[:, recorded]) > _BEYOND * model.effort_limits[recorded]):
        return None
    rigid = torques_of(model)
    size = np.maximum(np.linalg.norm(motion.torque[:, recorded], axis=0), 1e-9)

    def at(place: FloatArray) -> FloatArray:
        return np.asarray((torques_of(model.with_payload(1.0, place)) - rigid)[:, recorded] / size)

    arms = _ARM_OF_PAYLOAD * np.eye(3)
    moments = [0.5 * (at(arm) - at(-arm)) / _ARM_OF_PAYLOAD for arm in arms]
    speeds = (motion.ddq, motion.dq, np.sign(motion.dq))
    losses = [(values[:, recorded] / size)[:, :, None] * np.eye(len(recorded)) for values in speeds]
    y = ((motion.torque - rigid)[:, recorded] / size).ravel()

    def fit(payload: Sequence[FloatArray]) -> FloatArray:
        X = np.column_stack([*(part.ravel() for part in payload), *(part.reshape(len(y), -1) for part in losses)])
        least = np.zeros(X.shape[1])
        least[1 : len(payload)] = -np.inf
        return np.asarray(lsq_linear(X, y, (least, np.inf)).x[: len(payload)])

    at_tip, heaviest = at(np.zeros(3)), _HEAVIEST * sum(inertia.mass for inertia in model.pin_model.inertias)
    mass, *moment = fit([at_tip, *moments]).tolist()
    if _LEAST_PAYLOAD < mass < heaviest and np.linalg.norm(moment) <= _ARM_OF_PAYLOAD * mass:
        return mass, np.array(moment) / mass
    mass = float(fit([at_tip])[0])
    return (mass, np.zeros(3)) if _LEAST_PAYLOAD < mass < heaviest else None
