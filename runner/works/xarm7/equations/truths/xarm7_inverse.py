"""The xArm7's inverse kinematics with three joints: q3 = q5 = q7 = 0, q6 = 0.75 rad. Lengths in cm.

With q2 = 0 the tip lies p4 in front of the shoulder and p3 above it; q2 turns that vector. Half the squared distance of
the tip from the shoulder is a constant plus p1 cos q4 + p2 sin q4. All of them can therefore be read from the tip's
position alone, and are: from Pinocchio's, and from the chain of transforms.
"""

from collections.abc import Callable

import numpy as np

from runner.audit.truth import Elements, FloatArray, Symbols, Truth
from runner.works.xarm7.equations.truths.xarm7 import JOINTS, L1, constants, model_poses, pose

Q6 = 0.75  # rad
_Q2 = (-2.0594, 2.0943)
_Q4 = (-0.1919, 3.9269)
_REACH = 5.0  # cm from the base axis, at least

_Pose = Callable[[FloatArray], FloatArray]


def symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return configurations inside the limits of joints 2 and 4, the tip in front of the base axis, the elbow bent.

    `q1`, `q2`, `q4` are the joint positions, `P_ex`, `P_ey`, `P_ez` the tip there; `p1` to `p4` and `M` what they must
    be. The elbow is bent as the report's root with its positive sign has it; the other sign is the other elbow.

    Args:
        count: How many configurations.
        generator: Source of the draw.
    """
    drawn = np.column_stack(
        [generator.uniform(low, high, 40 * count) for low, high in ((-np.pi, np.pi), _Q2, _Q4)],
    )
    values = _shape(model_poses, drawn)
    q2, q4 = drawn[:, 1], drawn[:, 2]
    ahead = values["p4"] * np.cos(q2) + values["p3"] * np.sin(q2)
    bent = np.cos(q4 + np.arctan2(values["p1"], values["p2"]))
    kept = np.flatnonzero((ahead > _REACH) & (bent > 0.02))[:count]
    q = drawn[kept]
    tip = model_poses(full(q))[:, :3, 3]
    named = {"q1": q[:, 0], "q2": q[:, 1], "q4": q[:, 2], "q6": np.full(count, Q6)}
    named |= {f"P_e{axis}": tip[:, i] for i, axis in enumerate("xyz")}
    return named | {name: value[kept] for name, value in values.items()} | constants(count)


def full(q: FloatArray) -> FloatArray:
    """Return all seven joint positions for rows of q1, q2, q4, shapes (T, 3) to (T, 7), in rad."""
    result = np.zeros((len(q), JOINTS))
    result[:, [0, 1, 3]] = q
    result[:, 5] = Q6
    return result


def _shape(pose_of: _Pose, q: FloatArray) -> dict[str, FloatArray]:
    """Return p1 to p4 and M at rows of q1, q2, q4, read from the tip's position."""

    def half_square(q4: FloatArray | float) -> FloatArray:
        from_shoulder = pose_of(full(_rows(len(q), q4)))[:, :3, 3] - [0, 0, L1]
        return np.asarray((from_shoulder**2).sum(axis=1) / 2)

    straight = pose_of(full(_rows(len(q), q[:, 2])))[:, :3, 3]
    folded, stretched = half_square(np.pi), half_square(0.0)
    return {
        "p1": (stretched - folded) / 2,
        "p2": (half_square(np.pi / 2) - half_square(-np.pi / 2)) / 2,
        "p3": straight[:, 2] - L1,
        "p4": straight[:, 0],
        "M": half_square(q[:, 2]) - (stretched + folded) / 2,
    }


def _rows(count: int, q4: FloatArray | float) -> FloatArray:
    rows = np.zeros((count, 3))
    rows[:, 2] = q4
    return rows


def _sampled(values: Symbols) -> FloatArray:
    return np.column_stack([values["q1"], values["q2"], values["q4"]])


def _solved(values: Symbols) -> Elements:
    """Return the joint positions that bring the tip there, by Newton's iteration on the chain from a start nearby."""
    target = np.column_stack([values[f"P_e{axis}"] for axis in "xyz"])
    q = _sampled(values) + np.array([0.01, -0.01, 0.01])
    for _ in range(30):
        here = pose(full(q))[:, :3, 3]
        step = 1e-6
        J = np.stack(
            [(pose(full(q + step * unit))[:, :3, 3] - here) / step for unit in np.eye(3)],
            axis=2,
        )
        q = q + np.linalg.solve(J, (target - here)[:, :, None])[:, :, 0]
    return {"q1": q[:, 0], "q2": q[:, 1], "q4": q[:, 2]}


shape = Truth(
    lambda values: _shape(model_poses, _sampled(values)),
    lambda values: _shape(pose, _sampled(values)),
    ("tip by Pinocchio", "tip by the chain of transforms"),
)
joints = Truth(
    lambda values: {name: values[name] for name in ("q1", "q2", "q4")},
    _solved,
    ("the positions that Pinocchio's tip was computed from", "Newton's iteration on the chain"),
)
