"""Reference derivations of the xArm7's three-joint inverse kinematics: q3 = q5 = q7 = 0, q6 = 0.75 rad. Lengths in cm.

With q2 = 0 the tip is p4 in front of the shoulder and p3 above it; q2 rotates that vector. Half the squared distance
of the tip from the shoulder is a constant plus p1 cos q4 + p2 sin q4. All of them therefore follow from the position
of the tip, by Pinocchio and by the chain of transforms.
"""

from collections.abc import Callable, Collection, Mapping
from functools import cache

import numpy as np

from runner.base.arrays import FloatArray
from runner.papers.audit.derivations import Derivations, Elements, Symbols, columns, coordinates, derivative
from runner.papers.audit.entry import Entry, entries
from runner.papers.audit.evaluation import evaluate
from runner.papers.expressions.parser import parse
from runner.papers.studies.xarm7.equations.derivations.xarm7 import BY_MODEL, JOINTS, L1, constants, pose

Q6 = 0.75  # rad
_Q2 = (-2.0594, 2.0943)
_Q4 = (-0.1919, 3.9269)
_REACH = 5.0  # cm from the base axis, at least

_Pose = Callable[[FloatArray], FloatArray]


def symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return configurations inside the limits of joints 2 and 4, the tip in front of the base axis, the elbow bent.

    `q1`, `q2`, `q4` are the joint positions, `P_ex`, `P_ey`, `P_ez` the tip there; `p1` to `p4` and `M` what they must
    be. The elbow is bent as the report's root with its positive sign has it; the other sign is the other elbow.
    """
    drawn = np.column_stack(
        [generator.uniform(low, high, 40 * count) for low, high in ((-np.pi, np.pi), _Q2, _Q4)],
    )
    values = _shape(BY_MODEL.pose, drawn)
    q2, q4 = drawn[:, 1], drawn[:, 2]
    ahead = values["p4"] * np.cos(q2) + values["p3"] * np.sin(q2)
    bent = np.cos(q4 + np.arctan2(values["p1"], values["p2"]))
    kept = np.flatnonzero((ahead > _REACH) & (bent > 0.02))[:count]
    q = drawn[kept]
    tip = BY_MODEL.pose(full(q))[:, :3, 3]
    named = {"q1": q[:, 0], "q2": q[:, 1], "q4": q[:, 2], "q6": np.full(count, Q6)}
    named |= {name: value[kept] for name, value in values.items()}
    return named | coordinates("P_e", tip, "") | constants(count)


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


def _tip(q: FloatArray) -> FloatArray:
    return pose(full(q))[:, :3, 3]


def _sampled(values: Symbols) -> FloatArray:
    return columns(values, ("q1", "q2", "q4"))


def _solved(values: Symbols) -> Elements:
    """Return the joint positions that bring the tip there, by Newton's iteration on the chain from a start nearby."""
    target, q = columns(values, ("P_ex", "P_ey", "P_ez")), _sampled(values) + np.array([0.01, -0.01, 0.01])
    for _ in range(10):
        J = np.stack([derivative(_tip, q, joint) for joint in range(3)], axis=2)
        q = q + np.linalg.solve(J, (target - _tip(q))[:, :, None])[:, :, 0]
    return {"q1": q[:, 0], "q2": q[:, 1], "q4": q[:, 2]}


shape = Derivations(
    lambda values: _shape(BY_MODEL.pose, _sampled(values)),
    lambda values: _shape(pose, _sampled(values)),
    ("tip by Pinocchio", "tip by the chain of transforms"),
)
joints = Derivations(
    lambda values: {name: values[name] for name in ("q1", "q2", "q4")},
    _solved,
    ("the positions that Pinocchio's tip was computed from", "Newton's iteration on the chain"),
)


# The printed formulas.

CENTIMETRES = 100.0
"""One metre in the report's unit of length."""
_TIP = ("P_ex", "P_ey", "P_ez")
_INVERSE = ("q1", "p1", "p2", "M", "q4", "p3", "p4", "q2")  # in the order in which each takes those before it
_LENGTHS = ("l1", "l2", "l3", "l4", "l5")


@cache
def _entries() -> Mapping[str, Entry]:
    return {entry.number: entry for _, entry in entries("xarm7")}


def _value(name: str, right: bool, values: Mapping[str, FloatArray]) -> FloatArray:
    """Return a formula's value as printed, or put right where it is wrong."""
    entry = _entries()[name]
    form = entry.true_form if right else entry.emendation or entry.printed
    return evaluate(parse(form.elements[name]), values)


def printed_tip(q: FloatArray, right: bool) -> FloatArray:
    """Return P_e at rows of joint positions, shapes (N, 7) in rad to (N, 3) in m.

    As printed it holds q1, q5 and q2; corrected, theta1 and theta2 replace them, as in A14, A24 and A34.
    """
    values = constants(len(q)) | {f"q{joint + 1}": q[:, joint] for joint in range(JOINTS)}
    return np.stack([_value(name, right, values) for name in _TIP], axis=1) / CENTIMETRES


def printed_inverse(
    tips: FloatArray, wrist: float, right: Collection[str] = (), unit: float = CENTIMETRES
) -> FloatArray:
    """Return q1, q2 and q4 for tips in m by the printed formulas, shape (N, 3), in rad ("inverse kinematic control").

    q2 and q4 may be put `right`: the sign in q2's denominator, M^2 inside the root of q4. M^2 outside the root makes
    the unit of length count: `unit` is what one metre is in it.
    """
    values = constants(len(tips)) | {"q6": np.full(len(tips), wrist)}
    values |= {name: values[name] * unit / CENTIMETRES for name in _LENGTHS}
    values |= dict(zip(_TIP, unit * tips.T, strict=True))
    for name in _INVERSE:
        values[name] = _value(name, name in right, values)
    return np.stack([values[name] for name in ("q1", "q2", "q4")], axis=1)


# The first task as text: a line along y, 40 cm long.

X, Z = 64.3, 15.08  # cm
ENDS = (-20.0, 20.0)  # cm
_LIMITS = np.array([[-2 * np.pi, -2.059488, -0.191986], [2 * np.pi, 2.094395, 3.926991]])  # joints 1, 2, 4, rad


def line_symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return points `y` of the line, shape (T,), in cm."""
    return {"y": generator.uniform(*ENDS, count)}


def points(y: FloatArray) -> FloatArray:
    """Return the points of the report's line, shapes (T,) to (T, 3), in cm."""
    return np.column_stack([np.full(len(y), X), y, np.full(len(y), Z)])


def solve(target: FloatArray, *, sign: bool = True, root: bool = True) -> FloatArray:
    """Return q1, q2, q4 by the report's inverse kinematics for tip positions in cm, shapes (T, 3) to (T, 3), in rad.

    Without `sign` the denominator of q2 is as printed; without `root` M^2 is outside the root of q4, as printed.
    """
    right = [name for name, emended in (("q2", sign), ("q4", root)) if emended]
    return printed_inverse(target / CENTIMETRES, Q6, right)


def _reached(pose_of: Callable[[FloatArray], FloatArray], values: Symbols) -> Elements:
    q = solve(points(values["y"]))
    inside = ((q >= _LIMITS[0]) & (q <= _LIMITS[1])).all(axis=1)
    tips = pose_of(full(q))[:, :3, 3]
    return {"tip": np.where(inside[:, None], tips, np.nan)}


def _direction(tips: FloatArray) -> FloatArray:
    order = tips[np.argsort(tips[:, 1])]
    whole = order[-1] - order[0]
    return np.tile(whole / np.linalg.norm(whole), (len(tips), 1))


reach = Derivations(
    lambda values: _reached(BY_MODEL.pose, values),
    lambda values: _reached(pose, values),
    ("inverse kinematics, then Pinocchio, inside the joint limits", "the same by the chain of transforms"),
)
direction = Derivations(
    lambda values: {"direction": _direction(points(values["y"]))},
    lambda values: {"direction": _direction(BY_MODEL.pose(full(solve(points(values["y"]))))[:, :3, 3])},
    ("between the ends of the line", "between the tips that the joints reach"),
)
