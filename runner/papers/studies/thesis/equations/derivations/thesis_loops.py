"""Reference derivations of the second-order loop and the quintic trajectory, sections 3.3.1 and 3.3.2 of the thesis."""

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval
from scipy.interpolate import BPoly, PPoly

from runner.base.arrays import FloatArray
from runner.papers.audit.derivations import Derivation, Derivations, Elements, Symbols
from runner.trajectories.motion import quintic_motion

# The loop eps'' + k_v eps' + k_p eps = 0 with natural frequency omega_n and damping ratio xi.


def _by_poles(s: Symbols) -> Elements:
    """Return the loop's gains from its two poles, at the distance omega_n from 0 when they are complex."""
    root = np.emath.sqrt(s["xi"] ** 2 - 1.0)
    first, second = (s["omega_n"] * (-s["xi"] + sign * root) for sign in (1.0, -1.0))
    return {"k_p": (first * second).real, "k_v": -(first + second).real}


def _by_companion(s: Symbols) -> Elements:
    """Return them from an oscillator that loses the share xi of its critical damping: its companion matrix."""
    damper = 2.0 * np.sqrt(s["omega_n"] ** 2) * s["xi"]  # critical damping of a unit mass on a spring omega_n^2
    matrices = np.zeros((len(damper), 2, 2))
    matrices[:, 0, 1], matrices[:, 1, 0], matrices[:, 1, 1] = 1.0, -(s["omega_n"] ** 2), -damper
    return {"k_p": np.linalg.det(matrices), "k_v": -np.trace(matrices, axis1=1, axis2=2)}


gains = Derivations(_by_poles, _by_companion, ("poles of the loop", "a unit mass with spring and damper"))


# The quintic, rest to rest.


def _by_bernstein(s: Symbols) -> Elements:
    """Return them from the Bernstein form of the curve that is at rest at both ends."""
    found = []
    for start, goal, t_f in zip(s["x_0"], s["x_t"], s["t_f"], strict=True):
        curve = BPoly.from_derivatives([0.0, t_f], [[start, 0.0, 0.0], [goal, 0.0, 0.0]])
        found.append(PPoly.from_bernstein_basis(curve).c[::-1, 0])
    return {f"c_{k}": values for k, values in enumerate(np.array(found).T)}


def _by_runner(s: Symbols) -> Elements:
    """Return them from the curve that the runner's arms follow, through six of its points."""
    points = np.linspace(0.0, 1.0, 6)
    fit = np.linalg.inv(np.vander(points, 6, increasing=True))
    found = []
    for start, goal, t_f in zip(s["x_0"], s["x_t"], s["t_f"], strict=True):
        curve = quintic_motion(np.array([start]), np.array([goal]), float(t_f))
        found.append(fit @ curve.sample(points * t_f)[:, 0, 0] / t_f ** np.arange(6))
    return {f"c_{k}": values for k, values in enumerate(np.array(found).T)}


def _ends(coefficients: Derivation) -> Derivation:
    """Return positions, velocities and accelerations of a curve at 0 and at t_f."""

    def found(s: Symbols) -> Elements:
        c, times = np.array([*coefficients(s).values()]), {"0": 0.0 * s["t_f"], "f": s["t_f"]}
        ends: dict[str, FloatArray] = {}
        for order, name in enumerate(("X", "dX", "ddX")):
            ends |= {f"{name}_{end}": polyval(t, polyder(c, order), tensor=False) for end, t in times.items()}
        return ends

    return found


_CURVES = ("Bernstein form of the curve at rest at both ends", "the runner's quintic")
quintic = Derivations(_by_bernstein, _by_runner, _CURVES)
ends = Derivations(_ends(_by_bernstein), _ends(_by_runner), _CURVES)
