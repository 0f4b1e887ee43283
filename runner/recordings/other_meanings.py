"""Other meanings of a log's columns: signs, units, orders and frames that its signals may fit better."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.recordings.columns_map import Signal
from runner.recordings.recording import Recording
from runner.robots.model import RobotModel
from runner.schema.units import WRITTEN

_SAME_UNIT = 1e-6
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
