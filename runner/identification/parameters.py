"""Parameters of an arm's torques by name, and the sums of them that torques can determine.

Torques determine only some linear combinations of masses, first moments and inertias, the base parameters (Gautier,
Journal of Robotic Systems 8(4), 1991). They are named as sums, such as "c3x m3 + 0.0825 (m4 + m5)": c3x is the x of
the centre of mass of link 3 in its frame, I3xx an inertia about the origin of that frame, Ia3 a rotor's inertia.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.recordings.equations import EvenRows
from runner.robots.model import RobotModel

_ORDER = (1, 2, 3, 4, 5, 6, 7, 8, 9, 0)  # of a link's parameters: masses last, so that sums are named by moments
_UNITS = ("kg", *3 * ("kg m",), *6 * ("kg m^2",))
_STATES = 12  # times the number of joints: more equations than parameters
_STRUCTURE = 1e-9  # of a column, that no other motion could tell from the others
_ZERO = 1e-7  # a smaller factor is rounding


@dataclass(frozen=True)
class ParameterSum:
    """A linear combination of parameters that the torques can determine.

    Attributes:
        name: Words such as "c3x m3 + 0.0825 (m4 + m5)".
        unit: Its unit.
        column: The parameter whose column of the linear model it takes.
        factors: The factor of each parameter, shape (n,).
    """

    name: str
    unit: str
    column: int
    factors: FloatArray


def parameter_names(nq: int) -> list[str]:
    """Return names of all parameters: ten for each link, in the order of Pinocchio, then the inertia of each rotor."""
    links = [
        name
        for link in range(1, nq + 1)
        for name in (
            f"m{link}", *(f"c{link}{axis} m{link}" for axis in "xyz"),
            *(f"I{link}{pair}" for pair in ("xx", "xy", "yy", "xz", "yz", "zz")),
        )
    ]  # fmt: skip
    return [*links, *(f"Ia{joint}" for joint in range(1, nq + 1))]


def parameter_units(model: RobotModel) -> list[str]:
    """Return the unit of each parameter; the inertia of the rotor of a prismatic joint is a mass."""
    return [*(model.nq * _UNITS), *("kg" if prismatic else "kg m^2" for prismatic in model.prismatic)]


def base_sums(model: RobotModel, rotors: bool) -> list[ParameterSum]:
    """Return the sums of inertial parameters that torques can determine, if the motion is rich enough.

    Args:
        model: The arm.
        rotors: Whether rotors have inertias of their own.
    """
    states = _states(model)
    Y = states.regressor()
    if rotors:
        Y = np.concatenate([Y, states.ddq[:, :, None] * np.eye(model.nq)], axis=2)
    X = Y.reshape(-1, Y.shape[2])
    order = [10 * link + place for link in range(model.nq) for place in _ORDER] + list(range(10 * model.nq, X.shape[1]))
    names, units = parameter_names(model.nq), parameter_units(model)
    taken, factors = group_columns(X, order, _STRUCTURE)
    found = []
    for column, row in zip(taken, factors, strict=True):
        whole = np.zeros(len(names))
        whole[: len(row)] = np.where(np.abs(row) > _ZERO, row, 0.0)
        found.append(ParameterSum(sum_name(whole, names, column), units[column], column, whole))
    return found


def _states(model: RobotModel) -> EvenRows:
    """Return spread motions of an arm: fractions of multiples of square roots, which are no multiples of each other."""
    roots = np.sqrt(np.array([n for n in range(2, 2000) if all(n % k for k in range(2, int(n**0.5) + 1))]))
    count, nq = _STATES * model.nq, model.nq
    spread = np.outer(np.arange(1, count + 1), roots[: 3 * nq]) % 1.0
    q, dq, ddq = (2.0 * part - 1.0 for part in np.split(spread, 3, axis=1))
    q = q * np.where(model.prismatic, 1.0, np.pi)
    return EvenRows(model, 1.0, 1.0, q, 3.0 * dq, 9.0 * ddq, np.sign(dq), np.zeros_like(q), np.zeros(nq), nq * ("",))


def group_columns(X: FloatArray, order: Sequence[int], tolerance: float) -> tuple[list[int], FloatArray]:
    """Return the columns that tell something new, in an order of preference, and the sums that they stand for.

    Args:
        X: Columns, shape (N, n).
        order: The columns, the preferred ones first.
        tolerance: Share of a column that the preferred ones must leave.

    Returns:
        The chosen columns, and for each the factors of all n parameters in its sum, shape (number chosen, n).
    """
    R: FloatArray = np.linalg.qr(X)[1]
    sizes = np.linalg.norm(R, axis=0)
    largest = sizes.max(initial=0.0)
    basis = np.zeros((len(R), 0))
    taken: list[int] = []
    for column in order:
        if sizes[column] <= tolerance * largest * 1e-3:
            continue
        left = R[:, column] / sizes[column]
        for _ in range(2):  # the second pass removes what rounding leaves
            left = left - basis @ (basis.T @ left)
        size = float(np.linalg.norm(left))
        if size > tolerance:
            taken.append(column)
            basis = np.column_stack([basis, left / size])
    scale = sizes[taken]
    factors = np.zeros((len(taken), R.shape[1]))
    if taken:
        factors[:] = np.linalg.lstsq(R[:, taken] / scale, R, rcond=None)[0] / scale[:, None]
        factors[:, taken] = np.eye(len(taken))
    return taken, factors


def sum_name(factors: FloatArray, names: Sequence[str], first: int) -> str:
    """Return the name of a sum: its own parameter first, parameters with the same factor together."""
    text = names[first]
    by_factor: dict[float, list[int]] = {}
    for place in np.flatnonzero(factors).tolist():
        if place != first:
            by_factor.setdefault(float(f"{factors[place]:.4g}"), []).append(place)
    merged: dict[float, list[str]] = {}
    for factor, places in by_factor.items():
        if -factor in merged:
            merged[-factor] += [f"- {names[place]}" for place in places]
        else:
            merged[factor] = [f"+ {names[place]}" for place in places]
    for factor, parts in merged.items():
        size = f"{abs(factor):.4g} " if abs(factor) != 1.0 else ""
        if size and len(parts) > 1:
            text += f" {'+' if factor > 0.0 else '-'} {size}({' '.join(parts).removeprefix('+ ')})"
        else:
            turned = parts if factor > 0.0 else [f"{'-+'[part[0] == '-']}{part[1:]}" for part in parts]
            text += "".join(f" {part[0]} {size}{part[2:]}" for part in turned)
    return text
