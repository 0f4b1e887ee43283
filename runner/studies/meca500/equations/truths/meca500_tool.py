"""Truths of the Meca500's tool: centre point from four poses, and direction. Lengths in mm."""

import numpy as np
import pinocchio as pin

from runner.audit.truth import Elements, Symbols, Truth, along, rotation
from runner.base.arrays import FloatArray
from runner.studies.meca500.equations.truths.meca500 import BY_MODEL, JOINTS

POSES = 4


def symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return tools held against a fixed point in four random orientations.

    `R1` to `R4` are the flange's rotations and `P1` to `P4` its positions, shapes (T, 3, 3) and (T, 3); `p` is the tool
    tip in the flange and `X` the point in the base frame; `short` is a shorter tool in the same direction `t`.
    """
    tool = generator.uniform([-40, -40, 60], [40, 40, 140], (count, 3))
    point = generator.uniform(-200, 200, (count, 3))
    values = {"p": tool, "X": point}
    for k in range(1, POSES + 1):
        R = BY_MODEL.pose(generator.uniform(-np.pi, np.pi, (count, JOINTS)))[:, :3, :3]
        values |= {f"R{k}": R, f"P{k}": point - along(R, tool)}
    direction = generator.normal(size=(count, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    return values | {"t": direction, "short": tool - 25 * direction}


def chain(values: Symbols) -> Elements:
    """Return the tip by the product of homogeneous transforms: eq. 1."""
    flange = np.tile(np.eye(4), (len(values["p"]), 1, 1))
    flange[:, :3, :3], flange[:, :3, 3] = values["R1"], values["P1"]
    return {"P_H": along(flange, np.column_stack([values["p"], np.ones(len(flange))]))[:, :3]}


def four_tips(values: Symbols) -> Elements:
    """Return the tip from each of the four poses: eq. 4."""
    return {f"P_H{k}": along(values[f"R{k}"], values["p"]) + values[f"P{k}"] for k in range(1, POSES + 1)}


def differences(values: Symbols) -> Elements:
    """Return the left side of eq. 5, the differences of rotations times the tool vector, shape (T, 9)."""
    return {"RP": along(_stacked(values), values["p"])}


def least_squares(values: Symbols) -> Elements:
    """Return the tool vector (R' R)^-1 R' P of the equation after eq. 5."""
    R, P = _stacked(values), _shifts(values)
    transposed = R.transpose(0, 2, 1)
    return {"p": np.asarray(np.linalg.solve(transposed @ R, along(transposed, P)[:, :, None])[:, :, 0], dtype=float)}


def _stacked(values: Symbols) -> FloatArray:
    return np.concatenate([values["R1"] - values[f"R{k}"] for k in range(2, POSES + 1)], axis=1)


def _shifts(values: Symbols) -> FloatArray:
    return np.concatenate([values[f"P{k}"] - values["P1"] for k in range(2, POSES + 1)], axis=1)


def turned(values: Symbols) -> Elements:
    """Return Rx(alpha) Ry(beta), the angles as the text describes them, as the rotation it is printed to be: eq. 7."""
    return {"T6_R": _aligning(values)}


def turned_back(values: Symbols) -> Elements:
    """Return the transpose of Rx(alpha) Ry(beta)."""
    return {"T6_R": _aligning(values).transpose(0, 2, 1)}


def _aligning(values: Symbols) -> FloatArray:
    alpha, beta = _angles(values)
    return rotation("x", alpha)[:, :3, :3] @ rotation("y", beta)[:, :3, :3]


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
    acted = {}
    for k in range(1, POSES + 1):
        rows = zip(values[f"R{k}"], values[f"P{k}"], values["p"], strict=True)
        acted[f"P_H{k}"] = np.array([pin.SE3(R, P).act(p) for R, P, p in rows])
    return acted | {"P_H": acted["P_H1"]}


def _fitted(values: Symbols) -> Elements:
    R, P = _stacked(values), _shifts(values)
    return {"p": np.array([np.linalg.lstsq(rows, right, rcond=None)[0] for rows, right in zip(R, P, strict=True)])}


def _between_tips(values: Symbols) -> Elements:
    tips = [along(values["R1"], values[name]) + values["P1"] for name in ("p", "short")]
    return {"t": along(values["R1"].transpose(0, 2, 1), tips[0] - tips[1])}


point = Truth(
    lambda values: {"P_H": values["X"], **{f"P_H{k}": values["X"] for k in range(1, POSES + 1)}},
    _points,
    ("the fixed point itself", "rigid transforms by Pinocchio"),
)
stack = Truth(
    lambda values: {"RP": _shifts(values)},
    differences,
    ("differences of the flange's positions", "differences of the turned tool vector"),
)
tool = Truth(lambda values: {"p": values["p"]}, _fitted, ("the tool that was drawn", "least squares by LAPACK"))
axis = Truth(
    lambda values: {"t": 25 * values["t"]},
    _between_tips,
    ("the direction that was drawn", "the two tips in the base frame, turned back"),
)
alignment = Truth(
    _frame_seen_from_tool, _by_pinocchio, ("the tool's axes, one by one", "Pinocchio's rotations, inverted")
)
