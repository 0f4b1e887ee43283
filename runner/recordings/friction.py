r"""Friction of an arm's joints, identified from recorded positions and torques.

.. math::

    \tau - (M \ddot q + V + G) = Y(q, \dot q, \ddot q)\, \Delta\theta + \Delta I\, \ddot q + b\, \dot q +
    c\, \mathrm{sgn}\, \dot q + o

M, V and G are from the run's model, b is viscous friction, c Coulomb friction and o a constant of each joint.

Delta theta are the differences in masses and inertias between the recorded arm and the model, and Delta I those in
reflected inertias of the rotors, which few makers publish. With these terms they do not affect the friction. Y is the
linear model of rigid bodies (Atkeson, An and Hollerbach, International Journal of Robotics Research 5(3), 1986).
Sensors behind the gears feel no rotors; Delta I is 0 then.

Positions are differentiated after a low-pass filter that leaves the motion unchanged. Both sides of the equation then
pass a lower low-pass filter, all without delay. They are decimated to independent samples (Gautier, Dynamic
identification of robots with power model, IEEE ICRA 1997). Rows near standstill are left out, because sgn is not
informative there.

Each joint has a weight from its residuals. The columns of Y are projected out first. Friction that cannot be
distinguished from other masses is not reported.

The intervals allow for residuals that are correlated within half a second and between joints (Liang and Zeger,
Biometrika 73(1), 1986). They also allow for the part of the residuals that the fit absorbs (Bell and McCaffrey, Survey
Methodology 28(2), 2002).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.special import stdtrit

from runner.base.arrays import FloatArray
from runner.recordings.smoothing import cutoff, derivative, low_pass
from runner.robots.model import RobotModel

if TYPE_CHECKING:
    import pandas as pd

_FIRST = 5.0  # times the cut-off: that of the low-pass before the equations, which leaves the motion unchanged
_SAMPLES = 4.0  # times that, the fewest samples in a second at which the equations are evaluated
_STANDSTILL = 0.05  # of a joint's largest speed
_SLOW = 0.01  # of the largest speed of all joints of its kind: a joint that is slower creeps
_SPOILT = 3.0  # periods of the cut-off at both ends, where the low-pass knows only one side
_CLIPPED = 0.01  # of the rows at an end of the range of torques
_SAME = 1e-6  # of the range of torques: what differs less is one value, but for rounding
_PILED = 10  # times the rows next to it: rounding itself puts 1.4 times as many at the peak of a sine
_ONE_WAY = 0.98  # of sgn behind the low-pass: below it the joint has just turned round
_FEWEST = 10  # rows of a joint in each direction
_ROUNDING = 1e-5  # of the largest singular value of Y: what is below tells of no mass
_TOLD_APART = 0.05  # share of a column of friction that other columns must leave
_WEIGHINGS = 3
_BLOCK = 0.5  # s, within which what is left over may be correlated


@dataclass(frozen=True)
class JointFriction:
    """Friction of a joint, each with the half-width of its 95 % interval.

    Attributes:
        joint: Its name.
        unit: Unit of its position.
        viscous: b, in N m s/rad; N s/m for a prismatic joint.
        viscous_half: Half-width.
        coulomb: c, in N m; N for a prismatic joint.
        coulomb_half: Half-width.
        constant: o, in N m; N for a prismatic joint.
        speed: Speeds of the rows, shape (N,), in rad/s.
        torque: Residual torques less what other masses and o explain, shape (N,), in N m.
    """

    joint: str
    unit: str
    viscous: float
    viscous_half: float
    coulomb: float
    coulomb_half: float
    constant: float
    speed: FloatArray
    torque: FloatArray


@dataclass(frozen=True)
class Friction:
    """Identified friction.

    Attributes:
        joints: The joints whose friction was found.
        lacking: Why there is none of another joint, a text for each.
        frequency: Cut-off of the low-pass, in Hz.
    """

    joints: Sequence[JointFriction]
    lacking: Sequence[str]
    frequency: float

    def frame(self) -> "pd.DataFrame":
        """Return a row for each joint: unit of its position, viscous, coulomb, the half-width of each, constant."""
        import pandas as pd

        columns = ("joint", "unit", "viscous", "viscous_half", "coulomb", "coulomb_half", "constant")
        rows = [[getattr(joint, name) for name in columns] for joint in self.joints]
        return pd.DataFrame(rows, columns=list(columns)).set_index("joint")


def identify_friction(
    model: RobotModel, q: FloatArray, torques: FloatArray, period: float, rotors: bool = True
) -> Friction:
    """Return the friction of the joints of an arm.

    Args:
        model: The run's model of the arm.
        q: Recorded joint positions, even samples, shape (N, nq), in rad.
        torques: Recorded joint torques, shape (N, nq), in N m; NaN throughout for a joint without.
        period: Time between two samples, in s.
        rotors: Whether the torques turn the rotors, whose inertias may differ from the model's.
    """
    frequency = cutoff(period)
    first = min(_FIRST * frequency, 0.25 / period)
    every = max(1, int(1.0 / (_SAMPLES * first * period)))
    smooth, measured = low_pass(q, period, first), torques
    speed = derivative(smooth, period)
    # The mean of sgn over a sample, as torques are means: a joint that turns round does so within one.
    signs = np.clip(speed / np.maximum(0.5 * period * np.abs(derivative(speed, period)), 1e-12), -1.0, 1.0)
    q, torques, signs = smooth[::every], *(low_pass(signals, period, first)[::every] for signals in (torques, signs))
    period *= every
    dq = derivative(q, period)
    rows = list(zip(q, dq, derivative(dq, period), strict=True))
    pin_model, data = pin.Model(model.pin_model), model.pin_model.createData()
    rigid = np.array([pin.rnea(pin_model, data, *row) for row in rows])
    Y = np.array([pin.computeJointTorqueRegressor(pin_model, data, *row).copy() for row in rows])
    if rotors:
        ddq = np.array([row[2] for row in rows])
        Y = np.concatenate([Y, ddq[:, :, None] * np.eye(model.nq)], axis=2)
    edge, apart = round(_SPOILT / (frequency * period)), max(1, int(0.5 / (frequency * period)))
    thinned = np.arange(edge, len(q) - edge, apart)
    fastest = np.abs(dq).max(axis=0)
    unusable = [_unusable(*pair) for pair in zip(measured.T, np.abs(speed).T, strict=True)]
    lacking: list[str] = []
    parts: list[_Part] = []
    for joint, name in enumerate(model.joint_names):
        signals = (torques[:, joint] - rigid[:, joint], dq[:, joint], signs[:, joint], Y[:, joint])
        residual, speed, sign, masses = (low_pass(signal, period, frequency)[thinned] for signal in signals)
        moving = (np.abs(speed) > _STANDSTILL * fastest[joint]) & (np.abs(sign) > _ONE_WAY)
        moving &= fastest[joint] > _SLOW * fastest[model.prismatic == model.prismatic[joint]].max()
        if unusable[joint]:
            lacking.append(f"{name}: {unusable[joint]}")
        elif min(np.sum(moving & (speed > 0.0)), np.sum(moving & (speed < 0.0))) < _FEWEST:
            lacking.append(f"{name}: it moves too little, or in only one direction")
        else:
            blocks = (thinned[moving] * period / _BLOCK).astype(np.intp)
            parts.append(_Part(joint, blocks, *(signal[moving] for signal in (residual, speed, sign, masses))))
    found: list[JointFriction] = []
    for part, fitted in zip(parts, _fit(parts), strict=True):
        name = model.joint_names[part.joint]
        if fitted is None:
            lacking.append(f"{name}: its motion does not tell friction from other masses and inertias")
        else:
            found.append(JointFriction(name, model.joint_units[part.joint], *fitted))
    return Friction(found, lacking, frequency)


def _unusable(torques: FloatArray, speed: FloatArray) -> str:
    """Return the reason why a joint's torque does not determine its friction; empty if it does."""
    if not np.isfinite(torques).all():
        return "no torque is recorded"
    rows = torques[speed > _STANDSTILL * speed.max()]
    low, high = rows.min(initial=np.inf), rows.max(initial=-np.inf)
    if low == high:
        return f"its torque is constant: {low:.4g} in all rows in which it moves"
    for end in (low, high) if len(rows) else ():
        away, same = np.abs(rows - end), _SAME * (high - low)
        at, beside = np.sum(away <= same), np.sum(away <= away[away > same].min() + same)
        if at > max(_CLIPPED * len(rows), _PILED * (beside - at)):
            return f"its torque is clipped, at {end:.4g} in {at / len(rows):.0%} of the rows in which it moves"
    return ""


@dataclass(frozen=True)
class _Part:
    """The rows of a joint behind the low-pass: residual torque, speed, its sign, Y with the rotors' columns."""

    joint: int
    blocks: NDArray[np.intp]
    residual: FloatArray
    speed: FloatArray
    sign: FloatArray
    Y: FloatArray


_Fitted = tuple[float, float, float, float, float, FloatArray, FloatArray]


def _fit(parts: Sequence[_Part]) -> list[_Fitted | None]:
    """Return the values of JointFriction of each joint, from its viscous friction on; None without a value."""
    if not parts:
        return []
    ends = np.cumsum([len(part.residual) for part in parts]).tolist()
    places = [slice(end - len(part.residual), end) for end, part in zip(ends, parts, strict=True)]
    y, Y = np.concatenate([part.residual for part in parts]), np.vstack([part.Y for part in parts])
    X = np.zeros((len(y), 3 * len(parts)))
    for number, (place, part) in enumerate(zip(places, parts, strict=True)):
        X[place, 3 * number : 3 * number + 3] = np.column_stack([part.speed, part.sign, np.ones(len(part.speed))])
    blocks = np.concatenate([part.blocks for part in parts])
    weights = np.ones(len(y))
    for _ in range(_WEIGHINGS):
        rest = _solve(X, Y, y, weights, None).rest
        for place in places:
            weights[place] = 1.0 / max(float(np.std(rest[place])), 1e-12)
    solved = _solve(X, Y, y, weights, blocks)
    found: list[_Fitted | None] = []
    for number, (place, part) in enumerate(zip(places, parts, strict=True)):
        viscous, coulomb, constant = range(3 * number, 3 * number + 3)
        if min(solved.left[viscous], solved.left[coulomb]) < _TOLD_APART or solved.half is None:
            found.append(None)
            continue
        theta, half = solved.theta, solved.half
        torque = solved.rest[place] + theta[viscous] * part.speed + theta[coulomb] * part.sign
        values = (theta[viscous], half[viscous], theta[coulomb], half[coulomb], theta[constant])
        found.append((*map(float, values), part.speed, torque))
    return found


@dataclass(frozen=True)
class _Solved:
    """Friction of all joints by weighted least squares.

    Attributes:
        theta: Viscous and Coulomb friction and constant of one joint after another, shape (n,).
        half: Half-widths of their 95 % intervals, shape (n,); None where there are not enough rows, or no blocks.
        left: Share of each column that no mass explains, shape (n,).
        rest: What nothing explains, shape (N,), in N m.
    """

    theta: FloatArray
    half: FloatArray | None
    left: FloatArray
    rest: FloatArray


def _solve(
    X: FloatArray, Y: FloatArray, y: FloatArray, weights: FloatArray, blocks: NDArray[np.intp] | None
) -> _Solved:
    """Return the friction that explains y with the columns X, whatever the masses in Y are.

    Args:
        X: Columns of friction, shape (N, n).
        Y: Columns of the masses, shape (N, m).
        y: Residual torques, shape (N,).
        weights: What each row counts.
        blocks: Number of the block in time that each row is of: rows of one may be correlated. None: no intervals.
    """
    scaled = Y * weights[:, None]
    sizes = np.linalg.norm(scaled, axis=0)
    u, s, _ = np.linalg.svd(scaled / np.where(sizes > 0.0, sizes, 1.0), full_matrices=False)
    basis = u[:, s > _ROUNDING * s[0]]

    def without_masses(columns: FloatArray) -> FloatArray:
        rest: FloatArray = columns - basis @ (basis.T @ columns)
        return rest

    columns = X * weights[:, None]
    own = without_masses(columns)
    theta = np.asarray(np.linalg.lstsq(own, without_masses(y * weights), rcond=None)[0], dtype=np.float64)
    rest = without_masses(y * weights - columns @ theta)
    left: FloatArray = np.sqrt(np.sum(own**2, axis=0) / np.sum(columns**2, axis=0))
    half = None
    if blocks is not None and len(y) > basis.shape[1] + X.shape[1]:
        half = _half_widths(own, np.hstack([basis, np.linalg.qr(own)[0]]), rest, blocks)
    return _Solved(theta, half, left, rest / weights)


def _half_widths(own: FloatArray, taken: FloatArray, rest: FloatArray, blocks: NDArray[np.intp]) -> FloatArray | None:
    """Return the half-widths of the intervals, from the residual of each block; None for only one block."""
    numbers = np.unique(blocks)
    if len(numbers) < 2:
        return None
    scores = np.array([own[rows].T @ _unshrunk(taken[rows], rest[rows]) for rows in map(blocks.__eq__, numbers)])
    bread = np.linalg.pinv(own.T @ own)
    half: FloatArray = stdtrit(len(numbers) - 1, 0.975) * np.sqrt(np.diagonal(bread @ scores.T @ scores @ bread))
    return half


def _unshrunk(taken: FloatArray, rest: FloatArray) -> FloatArray:
    """Return the residuals of a block as large as they were before the fit took up its share."""
    values, vectors = np.linalg.eigh(np.eye(len(rest)) - taken @ taken.T)
    found: FloatArray = vectors @ (vectors.T @ rest / np.sqrt(np.maximum(values, 1e-6)))
    return found
