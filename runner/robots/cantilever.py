"""Clamped beam with a tip mass: Euler-Bernoulli theory and a chain of rigid segments."""

from collections.abc import Iterator
from itertools import islice

import numpy as np
from scipy.optimize import brentq

from runner.base.arrays import FloatArray
from runner.robots.chain import Beam, Chain, cut
from runner.robots.model import RobotModel
from runner.robots.modes import find_modes

_NONE = '<inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/>'


def cantilever_roots(tip_ratio: float) -> Iterator[float]:
    r"""Yield b of the modes of a clamped beam with a mass at its tip, by frequency (Euler and Bernoulli).

    .. math:: 1 + \cos b \cosh b + b r (\cos b \sinh b - \sin b \cosh b) = 0, \qquad
        \omega = b^2 \sqrt{\frac{EI}{m L^3}}

    Args:
        tip_ratio: r, mass at the tip over m, the mass of the beam.
    """

    def equation(b: float) -> float:  # over cosh b, which grows without end
        fall = 1.0 / np.cosh(b)
        return float(fall + np.cos(b) + b * tip_ratio * (np.cos(b) * np.tanh(b) - np.sin(b)))

    step, b = 0.05, 0.05
    while True:
        if equation(b) * equation(b + step) < 0.0:
            yield float(brentq(equation, b, b + step, xtol=1e-14))
        b += step


def clamped_arm(length: float, tip_mass: float) -> RobotModel:
    """Return a rigid arm of one joint about z, whose link `beam` lies along y, with a mass at its end, `tip`.

    Args:
        length: L, in m.
        tip_mass: In kg.
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
    """Return a clamped beam as a chain; see clamped_arm and cut."""
    return cut(clamped_arm(length, tip_mass), "tip", {"beam": beam}, parts)


def frequency_errors(tip_ratio: float, parts: int, modes: int) -> FloatArray:
    """Return by how much a chain rings faster than its beam, as a share, of its slowest modes, shape (modes,).

    Args:
        tip_ratio: Mass at the tip over that of the beam.
        parts: Springs along the beam; a chain has as many modes in a plane.
        modes: How many modes.
    """
    chain = cantilever(Beam(1.0, 1.0), 1.0, tip_ratio, parts)
    M = chain.mass_matrix(np.zeros(1))[np.ix_(chain.springs, chain.springs)]
    found = find_modes(M, np.zeros_like(M), np.diag(chain.stiffness))[::2]  # each stands there for both planes
    omega = 2.0 * np.pi * np.array([mode.frequency for mode in found[:modes]])
    exact = np.array(list(islice(cantilever_roots(tip_ratio), modes))) ** 2
    errors: FloatArray = omega / exact - 1.0
    return errors
