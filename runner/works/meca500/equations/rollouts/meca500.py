"""The Meca500 by the printed formulas and by the right ones. Lengths in mm, forces in N."""

from collections.abc import Callable

import numpy as np
import pinocchio as pin

from runner.audit.chains import derivative, product
from runner.audit.rollout import Rollout
from runner.audit.truth import FloatArray
from runner.works.meca500.equations.truths import meca500
from runner.works.meca500.equations.truths.meca500_gravity import weight
from runner.works.meca500.equations.truths.meca500_tool import turned, turned_back
from runner.works.meca500.equations.truths.meca500_wrench import by_shorter_lever

_DURATION = 3.0  # s
_STEP = 0.01  # s
_START = np.array([0.3, 0.2, -0.3, 0.4, 0.9, -0.6])  # rad
_TURN = np.array([0.3, 0.0, 0.0])  # rad/s about the base's x axis


def _times() -> FloatArray:
    return np.arange(0, _DURATION + _STEP / 2, _STEP)


def table() -> Rollout:
    """Return where the printed table says that the flange is, on a joint motion from home."""
    angle = np.linspace(0, 0.5, 101)
    q = angle[:, None] * np.ones(meca500.JOINTS)
    rows = [(alpha, a, 0.0, d) for alpha, a, _, d in meca500.TABLE]
    said = product([meca500.row_transform(row, q[:, i]) for i, row in enumerate(rows)])[:, :3, 3]
    error = np.linalg.norm(said - meca500.model_poses(q)[:, :3, 3], axis=1)
    mended = np.linalg.norm(meca500.pose(q)[:, :3, 3] - meca500.model_poses(q)[:, :3, 3], axis=1)
    return Rollout(
        "The printed table on a joint motion",
        f"All joints turn together from home. The table as printed places the flange {error.min():.0f} to "
        f"{error.max():.0f} mm from where it is, on an arm that reaches 330 mm.",
        "angle of every joint (rad)",
        "flange, computed to real (mm)",
        angle,
        {"as printed": error, "corrected": mended},
    )


def resolved_rate() -> Rollout:
    """Return a turn about the base's x axis by joint rates, with the printed angular rows and the right ones."""
    printed, right = _turn(_printed_jacobian), _turn(lambda q: meca500.model_jacobians(q[None])[0])
    return Rollout(
        "A turn by joint rates, with the printed Jacobian",
        f"The flange is to turn about the base's x axis by {_TURN[0] * _DURATION:.1f} rad in {_DURATION:.0f} s and to "
        f"stay where it is. With the printed angular rows it ends {np.degrees(printed[-1]):.0f} degrees from the "
        f"attitude asked for; with the joint axes {np.degrees(right[-1]):.2f} degrees, the error of the time step.",
        "time (s)",
        "attitude error (degrees)",
        _times(),
        {"as printed": np.degrees(printed), "corrected": np.degrees(right)},
    )


def _printed_jacobian(q: FloatArray) -> FloatArray:
    """Return the Jacobian whose angular rows are the derivatives of the sum of theta_i z_i, shape (6, 6)."""
    J: FloatArray = meca500.model_jacobians(q[None])[0]
    J[3:] = np.column_stack([derivative(_summed, q[None], joint)[0] for joint in range(meca500.JOINTS)])
    return J


def _summed(q: FloatArray) -> FloatArray:
    axes = np.stack([frame[:, :3, 2] for frame in meca500.frames(q)], axis=2)
    return np.asarray(np.einsum("tij,tj->ti", axes, q))


def _turn(jacobian: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Return the angle between the attitude and the one asked for at each instant, in rad."""
    times, q = _times(), _START.copy()
    start = meca500.pose(q[None])[0, :3, :3]
    angles = np.empty(len(times))
    for i, time in enumerate(times):
        wanted = pin.exp3(time * _TURN) @ start
        angles[i] = np.linalg.norm(pin.log3(wanted @ meca500.pose(q[None])[0, :3, :3].T))
        q = q + _STEP * np.linalg.solve(jacobian(q), np.concatenate([np.zeros(3), _TURN]))
    return angles


def summed_angles() -> Rollout:
    """Return the attitude that the sum of joint angles along their axes tells, on a joint motion from home."""
    angle = np.linspace(0, 1, 101)
    q = angle[:, None] * np.array([0.5, -0.5, 0.5, 1.0, 0.5, 1.0])
    home = meca500.pose(np.zeros((1, meca500.JOINTS)))[0, :3, :3]
    real = meca500.pose(q)[:, :3, :3] @ home.T
    told = [pin.exp3(vector) for vector in _summed(q)]
    off = np.degrees([np.linalg.norm(pin.log3(a @ b.T)) for a, b in zip(real, told, strict=True)])
    return Rollout(
        "The attitude as a sum of joint angles",
        f"On a motion of all joints from home by half a radian to one radian each the summed angles tell an attitude "
        f"that is off by {off[50]:.0f} degrees half-way and by {off[-1]:.0f} degrees at the end.",
        "share of the motion",
        "attitude error (degrees)",
        angle,
        {"as printed": off, "corrected": np.zeros(len(angle))},
    )


def swapped_axes() -> Rollout:
    """Return the force that a free tool seems to feel when G_y and G_z of the calibration are swapped."""
    times = _times()
    share = (times / _DURATION)[:, None]
    R = meca500.model_poses(_START + share * np.array([0.5, 0.6, 0.3, -0.8, 0.4, 1.0]))[:, :3, :3]
    real = weight(R, np.full(len(times), 0.3), np.full(len(times), 3.0))
    felt = np.linalg.norm(real - real[:, [0, 2, 1]], axis=1)
    return Rollout(
        "A free tool, its weight by the swapped axes",
        f"The same tool on the same motion, its weight taken from the readings with $G_y$ and $G_z$ exchanged: up to "
        f"{felt.max():.1f} N remain of a tool of 3 N that touches nothing.",
        "time (s)",
        "force that is not there (N)",
        times,
        {"as printed": felt, "corrected": np.zeros(len(times))},
    )


def sensor_turn() -> Rollout:
    """Return the force that a free tool seems to feel when the sensor's turn is taken from one function alone."""
    degrees = np.linspace(-180, 180, 181)
    theta = np.radians(degrees)
    R = np.repeat(meca500.model_poses(_START[None])[:, :3, :3], len(theta), axis=0)
    G = np.full(len(theta), 3.0)
    believed = {"acos, as printed": np.arccos(np.cos(theta)), "asin, as printed": np.arcsin(np.sin(theta))}
    felt = {
        name: np.linalg.norm(weight(R, theta, G) - weight(R, angle, G), axis=1)
        for name, angle in (believed | {"corrected": np.arctan2(np.sin(theta), np.cos(theta))}).items()
    }
    worst = max(values.max() for values in felt.values())
    return Rollout(
        "A sensor mounted at any angle, its turn by acos or asin",
        f"Each function is right on half of the circle; on the other half up to {worst:.1f} N remain of a free tool of "
        "3 N. A sensor mounted at an angle between 0 and 90 degrees hides it.",
        "turn of the sensor (degrees)",
        "force that is not there (N)",
        degrees,
        felt,
    )


def alignment() -> Rollout:
    """Return how far a tool pushed along the aligned z axis strays when the rotation is taken as it is labelled."""
    tilt = np.linspace(0, 60, 61)
    side = np.radians(tilt)
    t = np.column_stack([np.sin(side) / np.sqrt(2), np.sin(side) / np.sqrt(2), np.cos(side)])
    values = {"t": t}
    off = {
        name: np.degrees(np.arccos(np.clip(np.einsum("ti,ti->t", t, axes[:, 2, :]), -1, 1)))
        for name, axes in (("as printed", turned(values)["T6_R"]), ("corrected", turned_back(values)["T6_R"]))
    }
    return Rollout(
        "An insertion along the aligned axis",
        f"A tool leans to x and y alike. The rotation of equation 7, used as its indices say, pushes along an axis "
        f"that is off the tool's by about twice its lean: {off['as printed'][20]:.0f} degrees for a tool that leans by "
        "20.",
        "lean of the tool (degrees)",
        "axis off the tool (degrees)",
        tilt,
        off,
    )


def wrench() -> Rollout:
    """Return the moment told at the tool's tip of a push, by the printed equation for M_p."""
    lever = np.linspace(0, 150, 61)
    push = np.tile([5.0, 0.0, 0.0], (len(lever), 1))
    shift = np.column_stack([0 * lever, 0 * lever, lever])
    values = {"r_p": np.tile([0.0, 0.0, 20.0], (len(lever), 1)), "qp": shift, "F": push}
    true = np.cross(values["r_p"], push)
    told = by_shorter_lever(values)["M_p"]
    return Rollout(
        "A push of 5 N, its moment by the printed equation",
        "The push attacks 20 mm from the point p, whose moment is 100 N mm whatever point q it is carried to. The "
        f"printed equation calls the moment about q that about p: {np.linalg.norm(told[-1]):.0f} N mm for a q 150 mm "
        "away, and the shift that follows adds the same once more.",
        "distance of q from p (mm)",
        "moment off (N mm)",
        lever,
        {"as printed": np.linalg.norm(told - true, axis=1), "corrected": np.zeros(len(lever))},
    )
