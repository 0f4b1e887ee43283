"""Reference derivations of the Meca500's tool: centre point from four poses, and direction. Lengths in mm."""

import numpy as np
import pinocchio as pin

from runner.base.arrays import FloatArray
from runner.papers.audit.derivations import Derivations, Elements, Symbols, along, coordinates
from runner.papers.studies.meca500.equations.derivations.meca500 import BY_MODEL, JOINTS

POSES = 4


def symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return tools that touch a fixed point in four random orientations.

    `R_1` to `R_4` are the flange's rotations and `P_1` to `P_4` its positions, shapes (T, 3, 3) and (T, 3); `p` is the
    tool tip in the flange and `X` the point in the base frame; `short` is a shorter tool in the same direction `t`.
    `T_F` is the flange's first transform, `T_FH` that of the tool, whose axes are the flange's.
    """
    tool = generator.uniform([-40, -40, 60], [40, 40, 140], (count, 3))
    point = generator.uniform(-200, 200, (count, 3))
    values = {"p": tool, "X": point}
    for k in range(1, POSES + 1):
        R = BY_MODEL.pose(generator.uniform(-np.pi, np.pi, (count, JOINTS)))[:, :3, :3]
        values |= {f"R_{k}": R, f"P_{k}": point - along(R, tool)}
    direction = generator.normal(size=(count, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    values |= coordinates("t", direction) | {"t": direction, "short": tool - 25 * direction}
    return values | {"T_F": _rigid(values["R_1"], values["P_1"]), "T_FH": _rigid(np.eye(3), tool)}


def _rigid(R: FloatArray, P: FloatArray) -> FloatArray:
    T = np.tile(np.eye(4), (len(P), 1, 1))
    T[:, :3, :3], T[:, :3, 3] = R, P
    return T


def _stacked(values: Symbols) -> FloatArray:
    return np.concatenate([values["R_1"] - values[f"R_{k}"] for k in range(2, POSES + 1)], axis=1)


def _shifts(values: Symbols) -> FloatArray:
    return np.concatenate([values[f"P_{k}"] - values["P_1"] for k in range(2, POSES + 1)], axis=1)


def _angles(values: Symbols) -> tuple[FloatArray, FloatArray]:
    x, y, z = values["t"].T
    return np.arctan2(-y, z), np.arctan2(x, np.hypot(y, z))


def _frame_seen_from_tool(values: Symbols) -> Elements:
    """Return the axes of frame 6 in the tool's frame, which has z along t and x in the x-z plane of frame 6 turned."""
    z = values["t"]
    alpha, _ = _angles(values)
    y = np.column_stack([np.zeros_like(alpha), np.cos(alpha), np.sin(alpha)])
    return {"T6_R": np.stack([np.cross(y, z), y, z], axis=1)}  # rows: the tool's axes in frame 6


def _by_pinocchio(values: Symbols) -> Elements:
    turns = [
        pin.rpy.rpyToMatrix(a, 0.0, 0.0) @ pin.rpy.rpyToMatrix(0.0, b, 0.0)
        for a, b in zip(*_angles(values), strict=True)
    ]
    return {"T6_R": np.array([pin.SE3(R, np.zeros(3)).inverse().rotation for R in turns])}


def _points(values: Symbols) -> Elements:
    rows = zip(values["R_1"], values["P_1"], values["p"], strict=True)
    T = np.array([(pin.SE3(R, P) * pin.SE3(np.eye(3), p)).homogeneous for R, P, p in rows])
    return {"P_H": T[:, :3, 3], "T_H": T}


def _fitted(values: Symbols) -> Elements:
    R, P = _stacked(values), _shifts(values)
    return {"p": np.array([np.linalg.lstsq(rows, right, rcond=None)[0] for rows, right in zip(R, P, strict=True)])}


def _between_tips(values: Symbols) -> Elements:
    tips = [along(values["R_1"], values[name]) + values["P_1"] for name in ("p", "short")]
    return {"t": along(values["R_1"].transpose(0, 2, 1), tips[0] - tips[1])}


point = Derivations(
    lambda values: {"P_H": values["X"], "T_H": _rigid(values["R_1"], values["X"])},
    _points,
    ("the fixed point itself", "rigid transforms by Pinocchio"),
)
tool = Derivations(lambda values: {"p": values["p"]}, _fitted, ("the tool that was drawn", "least squares by LAPACK"))
axis = Derivations(
    lambda values: {"t": 25 * values["t"]},
    _between_tips,
    ("the direction that was drawn", "the two tips in the base frame, turned back"),
)
alignment = Derivations(
    _frame_seen_from_tool, _by_pinocchio, ("the tool's axes, one by one", "Pinocchio's rotations, inverted")
)
