"""Reference derivations of the Meca500's admittance: time response, finite rotations, Euler rates. Angles in rad."""

from collections.abc import Callable

import numpy as np
import pinocchio as pin
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from runner.base.arrays import FloatArray
from runner.papers.audit.derivations import (
    Derivations,
    Elements,
    Symbols,
    along,
    columns,
    derivative,
    jacobian_by_differences,
    rotation,
    whole_and_elements,
)
from runner.papers.studies.meca500.equations.derivations import meca500

_STEPS = 400
_EULER = ("alpha", "beta", "gamma")


def symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return random joint motions, Euler angles and spring-mass-dampers.

    `theta1` to `theta6` are joint positions and `rate1` to `rate6` their rates; `alpha`, `beta`, `gamma` angles of
    Rx(alpha) Ry(beta) Rz(gamma), beta 0.2 rad or more from its singularity, with rates `dalpha`, `dbeta`, `dgamma`;
    `S_alpha` and so on their sines and cosines; `M`, `B`, `K` a mass [kg], damper [N s/m] and spring [N/m] under a
    force `f` [N] for a time `t` [s].

    `R_1` to `R_6` are the rotations of the frames, `R_6h` that of frame 6 at q = 0, `J_g` its Jacobian, `J_a` that of
    its position and Euler angles, `J_we6` the matrix of their rates, `dx`. `dtheta`, `angles` and `deuler` are vectors.
    """
    values = dict(meca500.symbols(count, generator))
    values |= {f"rate{i + 1}": generator.uniform(-1, 1, count) for i in range(meca500.JOINTS)}
    values |= {name: generator.uniform(-np.pi, np.pi, count) for name in ("alpha", "gamma")}
    values["beta"] = generator.uniform(-np.pi / 2 + 0.2, np.pi / 2 - 0.2, count)
    values |= {f"d{name}": generator.uniform(-1, 1, count) for name in _EULER}
    values |= {f"S_{name}": np.sin(values[name]) for name in ("alpha", "beta")}
    values |= {f"C_{name}": np.cos(values[name]) for name in ("alpha", "beta")}
    ranges = {"M": (0.5, 4), "B": (5, 60), "K": (50, 500), "f": (-10, 10), "t": (0.05, 1)}
    values |= {name: generator.uniform(low, high, count) for name, (low, high) in ranges.items()}
    q, rates = meca500.positions(values), _rates(values)
    frames = meca500.frames(q)
    J_a, J_we = _analytic(q)
    values |= {f"theta_{i + 1}": q[:, i] for i in range(meca500.JOINTS)}
    values |= {f"R_{i}": frame[:, :3, :3] for i, frame in enumerate(frames, start=1)}
    values |= {
        "R_6h": np.tile(meca500.pose(0.0 * q[:1])[:, :3, :3], (count, 1, 1)),
        "J_g": meca500.BY_MODEL.jacobian(q),
    }
    values |= {"J_a": J_a, "J_we6": J_we, "dx": along(J_a, rates), "I": np.tile(np.eye(3), (count, 1, 1))}
    return values | {"dtheta": rates, "angles": _angles(values), "deuler": _euler_speed(values)}


# The filter in time.


def step_response(values: Symbols) -> Elements:
    """Return the response of 1 / (M s^2 + B s + K) to a constant force, by partial fractions."""
    M, B, K, f, t = (values[name].astype(complex) for name in "MBKft")
    root = np.sqrt(B**2 - 4 * M * K)
    slow, fast = (-B + root) / (2 * M), (-B - root) / (2 * M)
    response = f / K * (1 + (fast * np.exp(slow * t) - slow * np.exp(fast * t)) / (slow - fast))
    return {"x": response.real}


def _by_exponential(values: Symbols) -> Elements:
    M, B, K, f, t = (values[name] for name in "MBKft")
    rates = np.zeros((len(t), 3, 3))
    rates[:, 0, 1], rates[:, 1, 0], rates[:, 1, 1], rates[:, 1, 2] = t, -t * K / M, -t * B / M, t * f / M
    return {"x": expm(rates)[:, 0, 2]}


def _by_steps(values: Symbols) -> Elements:
    M, B, K, f, t = (values[name] for name in "MBKft")

    def rate(state: FloatArray) -> FloatArray:
        return np.array([state[1], (f - B * state[1] - K * state[0]) / M])

    state, h = np.zeros((2, len(t))), t / _STEPS
    for _ in range(_STEPS):
        first = rate(state)
        second = rate(state + h / 2 * first)
        third = rate(state + h / 2 * second)
        state = state + h / 6 * (first + 2 * second + 2 * third + rate(state + h * third))
    return {"x": state[0]}


response = Derivations(_by_exponential, _by_steps, ("matrix exponential", "Runge-Kutta steps"))


# The flange's turn from home, and its twist.


def summed(q: FloatArray) -> FloatArray:
    """Return the sum of the joint angles along their axes, shapes (T, 6) to (T, 3)."""
    return along(np.stack([frame[:, :3, 2] for frame in meca500.frames(q)], axis=2), q)


def _home_turn(pose: Callable[[FloatArray], FloatArray], values: Symbols) -> FloatArray:
    """Return the flange's rotations from its attitude at q = 0, in the base frame, shape (T, 3, 3)."""
    home = pose(np.zeros((1, meca500.JOINTS)))[:, :3, :3]
    return np.asarray(pose(meca500.positions(values))[:, :3, :3] @ home.transpose(0, 2, 1))


def _logarithm(rotations: FloatArray) -> Elements:
    return {"Theta": np.array([pin.log3(R) for R in rotations])}


turn = Derivations(
    lambda values: _logarithm(_home_turn(meca500.pose, values)),
    lambda values: {"Theta": Rotation.from_matrix(_home_turn(meca500.BY_MODEL.pose, values)).as_rotvec()},
    ("logarithm, by the emended table", "quaternion, by Pinocchio's chain"),
)


def _rates(values: Symbols) -> FloatArray:
    return columns(values, [f"rate{i + 1}" for i in range(meca500.JOINTS)])


def _in_time(pose: Callable[[FloatArray], FloatArray], start: FloatArray, rates: FloatArray) -> FloatArray:
    """Return the twist of a pose whose coordinates move from a start at constant rates, by differences in time."""
    return jacobian_by_differences(lambda time: pose(start + time * rates), np.zeros((len(start), 1)))[:, :, 0]


twist = Derivations(
    lambda values: {"twist": along(meca500.jacobian_by_table(meca500.positions(values)), _rates(values))},
    lambda values: {"twist": _in_time(meca500.pose, meca500.positions(values), _rates(values))},
    ("differences of the pose by each joint", "differences of the pose in time"),
)


# Euler angles.


def euler(angles: FloatArray) -> FloatArray:
    """Return Rx(alpha) Ry(beta) Rz(gamma) as homogeneous transforms, shapes (T, 3) to (T, 4, 4)."""
    return np.asarray(rotation("x", angles[:, 0]) @ rotation("y", angles[:, 1]) @ rotation("z", angles[:, 2]))


def _angles(values: Symbols) -> FloatArray:
    return columns(values, _EULER)


def _euler_speed(values: Symbols) -> FloatArray:
    return columns(values, [f"d{name}" for name in _EULER])


def _rate_matrix(values: Symbols) -> FloatArray:
    """Return the axes about which alpha, beta and gamma turn, as columns, shape (T, 3, 3)."""
    x, y = rotation("x", values["alpha"])[:, :3, :3], rotation("y", values["beta"])[:, :3, :3]
    return np.stack([np.broadcast_to(np.eye(3)[0], (len(x), 3)), x[:, :, 1], (x @ y)[:, :, 2]], axis=2)


def _rates_by_differences(values: Symbols) -> FloatArray:
    return jacobian_by_differences(euler, _angles(values))[:, 3:]


euler_rates = Derivations(
    lambda values: whole_and_elements("J_we", _rates_by_differences(values)),
    lambda values: whole_and_elements("J_we", _rate_matrix(values)),
    ("differences of Rx Ry Rz", "the axes themselves"),
)


velocity = Derivations(
    lambda values: {"omega": _in_time(euler, _angles(values), _euler_speed(values))[:, 3:]},
    lambda values: {"omega": along(_rates_by_differences(values), _euler_speed(values))},
    ("differences of the rotation in time", "differences by each angle"),
)


euler_turn = Derivations(
    lambda values: _logarithm(euler(_angles(values))[:, :3, :3]),
    lambda values: {"Theta": Rotation.from_euler("XYZ", _angles(values)).as_rotvec()},
    ("logarithm", "quaternion"),
)


def _analytic(q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the Jacobian of position and Euler angles of frame 6 by differences, and the matrix of their rates."""
    pose = meca500.pose(q)
    up, low = pose[:, 2, 2], -pose[:, 1, 2]  # cos beta cos alpha, cos beta sin alpha
    ahead, left = pose[:, 0, 0], -pose[:, 0, 1]  # cos beta cos gamma, cos beta sin gamma
    cosine_square = up**2 + low**2
    found = []
    for joint in range(meca500.JOINTS):
        change = derivative(meca500.pose, q, joint)
        alpha = (up * -change[:, 1, 2] - low * change[:, 2, 2]) / cosine_square
        beta = change[:, 0, 2] / np.sqrt(cosine_square)
        gamma = (ahead * -change[:, 0, 1] - left * change[:, 0, 0]) / cosine_square
        found.append(np.column_stack([change[:, :3, 3], alpha, beta, gamma]))
    angles = {"alpha": np.arctan2(low, up), "beta": np.arcsin(pose[:, 0, 2])}
    return np.stack(found, axis=2), _rate_matrix(angles)


geometric = Derivations(
    lambda values: {"J_ge": meca500.BY_MODEL.jacobian(meca500.positions(values))},
    lambda values: {"J_ge": meca500.jacobian_by_table(meca500.positions(values))},
    ("Pinocchio, the maker's joints", "differences of the emended table's product"),
)
