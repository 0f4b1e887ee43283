r"""Equations of motion of an arm at the rows of a log, behind the same low-pass on both sides.

Positions are differentiated after a low-pass filter that leaves the motion unchanged. Both sides of the equations then
pass a lower low-pass filter, all without delay. They are decimated to independent samples (Gautier, Dynamic
identification of robots with power model, IEEE ICRA 1997).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.quantities import quantity
from runner.recordings.columns_map import Signal
from runner.recordings.recording import Recording
from runner.recordings.smoothing import acceleration_noise, derivative, low_pass
from runner.robots.model import RobotModel

STANDSTILL = 0.05
"""Share of a joint's fastest speed: rows below it are near standstill."""

_FIRST = 5.0  # times the cut-off: that of the low-pass before the equations, which leaves the motion unchanged
_SAMPLES = 4.0  # times that, the fewest samples in a second at which the equations are evaluated
_SLOW = 0.01  # of the fastest speed of all joints of its kind: a joint that is slower creeps
_BRIEF = 5.0  # periods of the first low-pass, over which it spreads a single bad sample
_BRIEF_SHARE = 0.05  # of the rows, the most that are left out as such
_SPOILT = 2.0  # periods of the cut-off at both ends, where the low-pass knows only one side
_CLIPPED = 0.01  # of the rows at an end of the range of torques
_SAME = 1e-6  # of the range of torques: what differs less is one value, but for rounding
_PILED = 10  # times the rows next to it: rounding itself puts 1.4 times as many at the peak of a sine
_BEYOND = 5.0  # times the limit of a joint's speed: a jump
_APART = 10.0  # times other steps of the joint, in the log and next to it: a jump
_OTHERS = 0.01, 10  # share and least number of the steps that may be jumps
_BESIDE = 5  # rows on each side that are next to a jump
_ONE_WAY = 0.98  # of sgn behind the low-pass: below it the joint has just turned round
FEWEST = 10
"""Fewest rows of a joint in each direction."""


@dataclass(frozen=True)
class EvenRows:
    """Even rows at which the equations of an arm are evaluated.

    Attributes:
        model: The arm.
        period: Time between two rows, in s.
        frequency: Cut-off of the low-pass on both sides of the equations, in Hz.
        q: Positions, shape (N, nq), in rad.
        dq: Speeds, shape (N, nq), in rad/s.
        ddq: Accelerations, shape (N, nq), in rad/s^2.
        signs: Direction of motion, shape (N, nq): 1, -1, or between them where a joint turns round.
        torques: Shape (N, nq), in N m; NaN throughout for a joint without.
        acceleration_noise: Noise of the filtered accelerations that follows from that of the positions, shape (nq,), in
            rad/s^2; 0 if they are recorded.
        unusable: The reason why a joint's torque cannot be used, by joint; empty if it can.
    """

    model: RobotModel
    period: float
    frequency: float
    q: FloatArray
    dq: FloatArray
    ddq: FloatArray
    signs: FloatArray
    torques: FloatArray
    acceleration_noise: FloatArray
    unusable: tuple[str, ...]

    @cached_property
    def kept(self) -> NDArray[np.intp]:
        """Rows that are independent samples behind the low-pass, without the ends."""
        step = self.frequency * self.period
        edge = round(_SPOILT / step)
        return np.arange(edge, len(self.q) - edge, max(1, int(0.5 / step)))

    @cached_property
    def times(self) -> FloatArray:
        """Times of the kept rows, shape (M,), in s."""
        return np.asarray(self.kept * self.period, dtype=np.float64)

    def behind_filter(self, signals: FloatArray) -> FloatArray:
        """Return signals behind the low-pass at the kept rows, shapes (N, ...) to (M, ...)."""
        return low_pass(signals, self.period, self.frequency)[self.kept]

    @cached_property
    def fastest(self) -> FloatArray:
        """Fastest speed of each joint, shape (nq,), in rad/s; see fastest_speed."""
        return fastest_speed(self.dq, self.period, self.frequency)

    def creeps(self, joint: int) -> bool:
        """Return True if a joint hardly moves compared with the fastest joint of its kind."""
        alike = self.model.prismatic == self.model.prismatic[joint]
        return bool(self.fastest[joint] <= _SLOW * self.fastest[alike].max())

    def moving(self, joint: int, speed: FloatArray, sign: FloatArray) -> NDArray[np.bool_]:
        """Return the kept rows in which a joint moves in one direction, shape (M,), from its filtered speed and sgn."""
        moving: NDArray[np.bool_] = (np.abs(speed) > STANDSTILL * self.fastest[joint]) & (np.abs(sign) > _ONE_WAY)
        return moving & (not self.creeps(joint))

    def rigid_torques(self) -> FloatArray:
        """Return the torques of the model, M ddq + V + G, shape (N, nq), in N m."""
        pin_model, data = self.model.separate()
        return np.array([pin.rnea(pin_model, data, *row) for row in zip(self.q, self.dq, self.ddq, strict=True)])

    def regressor(self) -> FloatArray:
        """Return the linear model of the links' masses and inertias, shape (N, nq, 10 nq)."""
        pin_model, data = self.model.separate()
        Y = np.empty((len(self.q), self.model.nq, 10 * self.model.nq))
        for place, row in zip(Y, zip(self.q, self.dq, self.ddq, strict=True), strict=True):
            place[:] = np.reshape(pin.computeJointTorqueRegressor(pin_model, data, *row), place.shape)
        return Y


def motion_of(
    model: RobotModel,
    q: FloatArray,
    torques: FloatArray,
    period: float,
    frequency: float,
    speeds: FloatArray | None = None,
    accelerations: FloatArray | None = None,
) -> EvenRows:
    """Return the rows of a log at which the equations are evaluated.

    Args:
        model: The arm.
        q: Recorded positions, even samples, shape (N, nq), in rad.
        torques: Recorded torques, shape (N, nq), in N m; NaN throughout for a joint without.
        period: Time between two samples, in s.
        frequency: Cut-off of the low-pass on both sides, in Hz.
        speeds: Recorded speeds, shape (N, nq), in rad/s; None for the derivative of the positions.
        accelerations: Recorded accelerations, shape (N, nq), in rad/s^2; None for the derivative of the speeds.
    """
    first = min(_FIRST * frequency, 0.25 / period)
    every = max(1, int(1.0 / (_SAMPLES * first * period)))
    smooth, measured = low_pass(q, period, first), torques
    speed = derivative(smooth, period) if speeds is None else low_pass(speeds, period, first)
    if speeds is None:
        # The mean of sgn over a sample, as torques are means: a joint that turns round does so within one.
        signs = np.clip(speed / np.maximum(0.5 * period * np.abs(derivative(speed, period)), 1e-12), -1.0, 1.0)
    else:
        signs = np.sign(speeds)
    above = 1.4826 * np.median(np.abs(q - smooth), axis=0) / np.sqrt(1.0 - 2.0 * first * period)
    noise = acceleration_noise(above, period, frequency)
    fastest = fastest_speed(speed, period, frequency)
    unusable = tuple(_unusable(*each) for each in zip(measured.T, np.abs(speed).T, fastest.tolist(), strict=True))
    q, torques, signs = smooth[::every], *(low_pass(signals, period, first)[::every] for signals in (torques, signs))
    period *= every
    dq = derivative(q, period) if speeds is None else speed[::every]
    ddq = derivative(dq, period) if accelerations is None else low_pass(accelerations, period / every, first)[::every]
    noise = noise if accelerations is None else np.zeros(model.nq)
    return EvenRows(model, period, frequency, q, dq, ddq, signs, torques, noise, unusable)


def fastest_speed(speeds: FloatArray, period: float, frequency: float) -> FloatArray:
    """Return the largest speed that lasts longer than what a single bad sample makes, shapes (N, nq) to (nq,).

    Args:
        speeds: Speeds behind the first low-pass, shape (N, nq), in rad/s.
        period: Time between two rows, in s.
        frequency: Cut-off of the low-pass on both sides of the equations, in Hz.
    """
    first = min(_FIRST * frequency, 0.25 / period)
    brief = min(round(_BRIEF / (first * period)), int(_BRIEF_SHARE * len(speeds)))
    place = len(speeds) - 1 - brief
    fastest: FloatArray = np.partition(np.abs(speeds), place, axis=0)[place]
    return fastest


def find_jumps(model: RobotModel, recording: Recording) -> Iterator[str]:
    """Yield a sentence for each joint whose position jumps between two rows, far beyond its speed limit.

    A jump also exceeds the other steps of the joint by far: those of the whole log, of which positions that stay equal
    over several rows have many, and those of the rows next to it. A joint without a limit is judged by these only.
    """
    times = np.maximum(np.diff(recording.t), recording.period)
    for joint, limit in zip(model.joint_names, model.velocity_limits.tolist(), strict=True):
        signal = Signal("position", joint)
        if signal not in recording.signals:
            continue
        steps = np.diff(recording.signals[signal])
        sizes = np.abs(steps)
        moved = np.sort(sizes[sizes > 0.0])
        left_out = max(int(_OTHERS[0] * len(moved)), _OTHERS[1])
        usual = float(moved[-1 - left_out]) if len(moved) > left_out else 0.0
        limited = bool(np.isfinite(limit) and limit > 0.0)
        if not limited and usual == 0.0:
            continue
        fast = (sizes > _APART * usual) & (sizes > (_BEYOND * limit * times if limited else 0.0))
        rows = [
            row
            for row in np.flatnonzero(fast).tolist()
            if sizes[row] > _APART * np.median(sizes[max(0, row - _BESIDE) : row + _BESIDE + 1])
        ]
        if not rows:
            continue
        row = rows[0]
        unit = model.joint_units[model.joint_names.index(joint)]
        returns = any(row < other <= row + _BESIDE and steps[other] * steps[row] < 0.0 for other in rows)
        places = 1 + int(np.sum(np.diff(rows) > _BESIDE))
        more = f" (and at {places - 1} more times)" if places > 1 else ""
        ratio = f", {sizes[row] / times[row] / limit:.0f} times the speed limit of {joint}" if limited else ""
        yield (
            f"{recording.columns[signal]} jumps by {quantity(float(sizes[row]), unit)} within "
            f"{quantity(float(times[row]), 's')} at {recording.t[row + 1]:.6g} s after the first row{more}{ratio}. "
            f"{'Correct or cut that row.' if returns else 'Cut the log there, or correct the column.'}"
        )


def _unusable(torques: FloatArray, speed: FloatArray, fastest: float) -> str:
    """Return the reason why a joint's torque does not determine its friction; empty if it does."""
    if not np.isfinite(torques).all():
        return "no torque is recorded"
    rows = torques[speed > STANDSTILL * fastest]
    low, high = rows.min(initial=np.inf), rows.max(initial=-np.inf)
    if low == high:
        return f"its torque is constant: {low:.4g} in all rows in which it moves"
    for end in (low, high) if len(rows) else ():
        away, same = np.abs(rows - end), _SAME * (high - low)
        at, beside = np.sum(away <= same), np.sum(away <= away[away > same].min() + same)
        if at > max(_CLIPPED * len(rows), _PILED * (beside - at)):
            return f"its torque is clipped, at {end:.4g} in {at / len(rows):.0%} of the rows in which it moves"
    return ""
