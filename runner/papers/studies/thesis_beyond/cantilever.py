"""Clamped beam with a tip mass: Euler-Bernoulli theory, and a chain of rigid segments as a model."""

from collections.abc import Iterator
from itertools import islice

import numpy as np
from scipy.optimize import brentq

from runner.base.arrays import FloatArray
from runner.robots.model import RobotModel
from runner.robots.vibration import Beam, Chain, cut, find_modes

_NONE = '<inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/>'


def cantilever_roots(tip_ratio: float) -> Iterator[float]:
    r"""Yield b of each mode of a clamped Euler-Bernoulli beam with a tip mass, in order of frequency.

    .. math:: 1 + \cos b \cosh b + b r (\cos b \sinh b - \sin b \cosh b) = 0, \qquad
        \omega = b^2 \sqrt{\frac{EI}{m L^3}}

    Args:
        tip_ratio: Ratio r of the tip mass to the beam mass m.
    """

    def equation(b: float) -> float:  # divided by cosh b, which grows without bound
        fall = 1.0 / np.cosh(b)
        return float(fall + np.cos(b) + b * tip_ratio * (np.cos(b) * np.tanh(b) - np.sin(b)))

    step, b = 0.05, 0.05
    while True:
        if equation(b) * equation(b + step) < 0.0:
            yield float(brentq(equation, b, b + step, xtol=1e-14))
        b += step


def clamped_arm(length: float, tip_mass: float) -> RobotModel:
    """Return a rigid arm with one joint about z, a link `beam` along y, and a mass at its end, the frame `tip`.

    Args:
        length: Length L of the link, in m.
        tip_mass: Mass at the tip, in kg.
    """
    return RobotModel(
        f"""<robot name="cantilever"><link name="wall"/>
        <link name="beam"><inertial><origin xyz="0 {length} 0"/><mass value="{tip_mass}"/>{_NONE}</inertial></link>
        <joint name="clamp" type="revolute"><parent link="wall"/><child link="beam"/><axis xyz="0 0 1"/>
        <limit lower="-9" upper="9" effort="1e9" velocity="1e9"/></joint>
        <joint name="end" type="fixed"><parent link="beam"/><child link="tip"/><origin xyz="0 {length} 0"/></joint>
        <link name="tip"/></robot>""",
        "tip",
    )


def cantilever(beam: Beam, length: float, tip_mass: float, parts: int) -> Chain:
    """Return the chain of a clamped beam; see clamped_arm and cut."""
    return cut(clamped_arm(length, tip_mass), "tip", {"beam": beam}, parts)


def frequency_errors(tip_ratio: float, parts: int, modes: int) -> FloatArray:
    """Return the relative frequency error of a chain in its slowest modes, compared with its beam, shape (modes,).

    Args:
        tip_ratio: Ratio of the tip mass to the beam mass.
        parts: Number of springs along the beam, which is also the number of modes in a plane.
        modes: Number of modes.
    """
    chain = cantilever(Beam(1.0, 1.0), 1.0, tip_ratio, parts)
    M = chain.mass_matrix(np.zeros(1))[np.ix_(chain.springs, chain.springs)]
    found = find_modes(M, np.zeros_like(M), np.diag(chain.stiffness))[::2]  # each mode occurs twice, once in each plane
    omega = 2.0 * np.pi * np.array([mode.frequency for mode in found[:modes]])
    exact = np.array(list(islice(cantilever_roots(tip_ratio), modes))) ** 2
    errors: FloatArray = omega / exact - 1.0
    return errors
