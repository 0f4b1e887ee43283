"""Motions of the Meca500 under the printed and the correct formulas. Lengths in mm, forces in N."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pinocchio as pin

from runner.base.arrays import FloatArray
from runner.papers.audit.consequence import Consequence
from runner.papers.audit.derivations import coordinates, derivative, product
from runner.papers.audit.entry import values_at
from runner.papers.studies.meca500.equations.derivations import meca500
from runner.papers.studies.meca500.equations.derivations.meca500_admittance import summed
from runner.papers.studies.meca500.equations.derivations.meca500_gravity import weight

_DURATION = 3.0  # s
_STEP = 0.01  # s
_TIMES = np.arange(0, _DURATION + _STEP / 2, _STEP)
_START = np.array([0.3, 0.2, -0.3, 0.4, 0.9, -0.6])  # rad
_TURN = np.array([0.3, 0.0, 0.0])  # rad/s about the base's x axis


def table() -> Consequence:
    """Return the error of the flange's position by the printed table, on a joint motion from home."""
    angle = np.linspace(0, 0.5, 101)
    q = angle[:, None] * np.ones(meca500.JOINTS)
    rows = [replace(row, theta=0.0) for row in meca500.TABLE]
    said = product([meca500.row_transform(row, q[:, i]) for i, row in enumerate(rows)])[:, :3, 3]
    error = np.linalg.norm(said - meca500.BY_MODEL.pose(q)[:, :3, 3], axis=1)
    emended = np.linalg.norm(meca500.pose(q)[:, :3, 3] - meca500.BY_MODEL.pose(q)[:, :3, 3], axis=1)
    return Consequence(angle, {"as printed": error, "corrected": emended})


def resolved_rate() -> Consequence:
    """Return a turn about the base's x axis by joint rates, with the printed angular rows and the right ones."""
    printed, right = _turn(_printed_jacobian), _turn(lambda q: meca500.BY_MODEL.jacobian(q[None])[0])
    curves = {"as printed": np.degrees(printed), "corrected": np.degrees(right)}
    return Consequence(_TIMES, curves, {"turn": _TURN[0] * _DURATION, "duration": _DURATION})


def _printed_jacobian(q: FloatArray) -> FloatArray:
    """Return the Jacobian whose angular rows are the derivatives of the sum of theta_i z_i, shape (6, 6)."""
    J: FloatArray = meca500.BY_MODEL.jacobian(q[None])[0]
    J[3:] = np.column_stack([derivative(summed, q[None], joint)[0] for joint in range(meca500.JOINTS)])
    return J


def _turn(jacobian: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Return the angle between the attitude and the one asked for at each instant, in rad."""
    q = _START.copy()
    start = meca500.pose(q[None])[0, :3, :3]
    angles = np.empty(len(_TIMES))
    for i, time in enumerate(_TIMES):
        wanted = pin.exp3(time * _TURN) @ start
        angles[i] = np.linalg.norm(pin.log3(wanted @ meca500.pose(q[None])[0, :3, :3].T))
        q = q + _STEP * np.linalg.solve(jacobian(q), np.concatenate([np.zeros(3), _TURN]))
    return angles


def summed_angles() -> Consequence:
    """Return the attitude by the sum of joint angles along their axes, on a joint motion from home."""
    angle = np.linspace(0, 1, 101)
    q = angle[:, None] * np.array([0.5, -0.5, 0.5, 1.0, 0.5, 1.0])
    home = meca500.pose(np.zeros((1, meca500.JOINTS)))[0, :3, :3]
    real = meca500.pose(q)[:, :3, :3] @ home.T
    told = [pin.exp3(vector) for vector in summed(q)]
    off = np.degrees([np.linalg.norm(pin.log3(a @ b.T)) for a, b in zip(real, told, strict=True)])
    return Consequence(angle, {"as printed": off, "corrected": np.zeros(len(angle))}, {"half": off[50]})


def swapped_axes() -> Consequence:
    """Return the force that a free tool seems to feel when G_y and G_z of the calibration are swapped."""
    share = (_TIMES / _DURATION)[:, None]
    R = meca500.BY_MODEL.pose(_START + share * np.array([0.5, 0.6, 0.3, -0.8, 0.4, 1.0]))[:, :3, :3]
    real = weight(R, np.full(len(_TIMES), 0.3), np.full(len(_TIMES), 3.0))
    felt = np.linalg.norm(real - real[:, [0, 2, 1]], axis=1)
    return Consequence(_TIMES, {"as printed": felt, "corrected": np.zeros(len(_TIMES))})


def sensor_turn() -> Consequence:
    """Return the force that a free tool seems to feel when the sensor's turn is taken from only one function."""
    degrees = np.linspace(-180, 180, 181)
    theta = np.radians(degrees)
    R = np.repeat(meca500.BY_MODEL.pose(_START[None])[:, :3, :3], len(theta), axis=0)
    G = np.full(len(theta), 3.0)
    believed = {"acos, as printed": np.arccos(np.cos(theta)), "asin, as printed": np.arcsin(np.sin(theta))}
    felt = {
        name: np.linalg.norm(weight(R, theta, G) - weight(R, angle, G), axis=1)
        for name, angle in (believed | {"corrected": np.arctan2(np.sin(theta), np.cos(theta))}).items()
    }
    return Consequence(degrees, felt, {"worst": max(values.max() for values in felt.values())})


def alignment() -> Consequence:
    """Return the error of a tool pushed along the aligned z axis if the rotation is taken as labelled."""
    tilt = np.linspace(0, 60, 61)
    side = np.radians(tilt)
    t = np.column_stack([np.sin(side) / np.sqrt(2), np.sin(side) / np.sqrt(2), np.cos(side)])
    forms = {"as printed": False, "corrected": True}
    axes = {
        name: values_at("meca500", "meca500-alignment", coordinates("t", t), corrected=right)["T6_R"]
        for name, right in forms.items()
    }
    off = {
        name: np.degrees(np.arccos(np.clip(np.einsum("ti,ti->t", t, R[:, 2, :]), -1, 1))) for name, R in axes.items()
    }
    return Consequence(tilt, off, {"at_20": off["as printed"][20]})


def wrench() -> Consequence:
    """Return the moment of a push at the tool's tip, by the printed equation for M_p."""
    lever = np.linspace(0, 150, 61)
    push = np.tile([5.0, 0.0, 0.0], (len(lever), 1))
    shift = np.column_stack([0 * lever, 0 * lever, lever])
    values = {"r_p": np.tile([0.0, 0.0, 20.0], (len(lever), 1)), "qp": shift, "F": push, "F_p": push}
    true = np.cross(values["r_p"], push)
    told = values_at("meca500", "meca500-moment-p-1", values)["M_p"]
    curves = {"as printed": np.linalg.norm(told - true, axis=1), "corrected": np.zeros(len(lever))}
    return Consequence(lever, curves, {"told": float(np.linalg.norm(told[-1]))})
