r"""Friction of an arm's joints, identified from recorded positions and torques.

.. math::

    \tau - (M \ddot q + V + G) = Y(q, \dot q, \ddot q)\, \Delta\theta + \Delta I\, \ddot q + b\, \dot q +
    c\, \mathrm{sgn}\, \dot q + o

M, V and G are from the run's model, b is viscous friction, c Coulomb friction and o a constant of each joint.

Delta theta are the differences in masses and inertias between the recorded arm and the model, and Delta I those in
reflected inertias of the rotors, which few makers publish. With these terms they do not affect the friction. Y is the
linear model of rigid bodies (Atkeson, An and Hollerbach, International Journal of Robotics Research 5(3), 1986).
Sensors behind the gears feel no rotors; Delta I is 0 then.

Both sides of the equation pass the same low-pass filter; see equations. Rows near standstill are left out, because sgn
is not informative there.

Each joint has a weight from its residuals. The columns of Y are projected out first. Friction that cannot be
distinguished from other masses is not reported.

The intervals allow for residuals that are correlated within half a second and between joints; see block_intervals.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import svd
from scipy.special import stdtrit

from runner.base.arrays import FloatArray
from runner.recordings.block_intervals import block_scores
from runner.recordings.equations import FEWEST, motion_of
from runner.recordings.smoothing import cutoff
from runner.robots.model import RobotModel

if TYPE_CHECKING:
    import pandas as pd

_ROUNDING = 1e-5  # of the largest singular value of Y: what is below tells of no mass
_ROUNDED = 1e-10  # of the largest column of Y: a smaller one is zero but for rounding
_TOLD_APART = 0.05  # share of a column of friction that other columns must leave
_WEIGHINGS = 3
_BLOCK = 0.5  # s, within which what is left over may be correlated


@dataclass(frozen=True)
class FrictionEstimate:
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

    joints: Sequence[FrictionEstimate]
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
    motion = motion_of(model, q, torques, period, frequency)
    rigid, Y = motion.rigid_torques(), motion.regressor()
    if rotors:
        Y = np.concatenate([Y, motion.ddq[:, :, None] * np.eye(model.nq)], axis=2)
    lacking: list[str] = []
    parts: list[_Part] = []
    for joint, name in enumerate(model.joint_names):
        signals = (motion.torques[:, joint] - rigid[:, joint], motion.dq[:, joint], motion.signs[:, joint])
        residual, speed, sign = map(motion.behind_filter, signals)
        felt = Y[:, joint].any(axis=0)  # not the links before the joint
        masses = np.zeros((len(motion.kept), Y.shape[2]))
        masses[:, felt] = motion.behind_filter(Y[:, joint, felt])
        moving = motion.moving(joint, speed, sign)
        if motion.unusable[joint]:
            lacking.append(f"{name}: {motion.unusable[joint]}")
        elif min(np.sum(moving & (speed > 0.0)), np.sum(moving & (speed < 0.0))) < FEWEST:
            lacking.append(f"{name}: it moves too little, or in only one direction")
        else:
            blocks = (motion.times[moving] / _BLOCK).astype(np.intp)
            parts.append(_Part(joint, blocks, *(signal[moving] for signal in (residual, speed, sign, masses))))
    found: list[FrictionEstimate] = []
    for part, fitted in zip(parts, _fit(parts), strict=True):
        name = model.joint_names[part.joint]
        if fitted is None:
            lacking.append(f"{name}: its motion does not tell friction from other masses and inertias")
        else:
            found.append(FrictionEstimate(name, model.joint_units[part.joint], *fitted))
    return Friction(found, lacking, frequency)


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
    filled = sizes > _ROUNDED * sizes.max()
    # The faster `gesdd` fails on some columns that depend on each other.
    u, s, _ = svd(scaled[:, filled] / sizes[filled], full_matrices=False, lapack_driver="gesvd")
    basis = u[:, s > _ROUNDING * s.max(initial=0.0)]

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
    scores = block_scores(own, taken, rest, blocks)
    if len(scores) < 2:
        return None
    bread = np.linalg.pinv(own.T @ own)
    half: FloatArray = stdtrit(len(scores) - 1, 0.975) * np.linalg.norm(scores @ bread, axis=0)
    return half
