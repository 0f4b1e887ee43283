"""Checks of a fit: what its residuals still follow, a change of payload, and a second method."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtr, stdtrit

from runner.base.arrays import FloatArray
from runner.identification.fit import Fit, block_numbers
from runner.identification.friction_kinds import other_columns
from runner.identification.log_rows import LogRows, payload_torques
from runner.recordings.columns_map import FixedPayload

_DOUBT = 0.02  # probability that a check of a right kind of friction finds anything
_PAYLOAD_DOUBT = 1e-4  # probability for a change of payload, of which many times are tried
_TRIED = 40  # times of a change of payload
_LEAST_PAYLOAD = 0.05  # kg
_AS_WELL = 0.95  # of the squares that a change at a time explains: a whole log explains them, too
_FEWEST = 4  # blocks in which a column must act


@dataclass(frozen=True)
class Flag:
    """Something that the residuals of a joint still follow.

    Attributes:
        joint: Place of the joint.
        follows: What they follow, in words.
        t: Its coefficient over its standard deviation.
        limit: The t that chance exceeds rarely in any of the tests.
    """

    joint: int
    follows: str
    t: float
    limit: float


@dataclass(frozen=True)
class MassChange:
    """A change of the mass at the tip within a log.

    Attributes:
        log: Name of the log.
        time: When, in s after its first row.
        mass: By how much, in kg.
    """

    log: str
    time: float
    mass: float


@dataclass(frozen=True)
class OtherMass:
    """Another mass at the tip in a whole log than in the other logs.

    Attributes:
        log: Name of the log.
        mass: By how much, in kg.
    """

    log: str
    mass: float


class _Score:
    """Tests of further columns against the residuals of a fit."""

    def __init__(self, fit: Fit) -> None:
        self._used = fit.weights > 0.0
        weights = fit.weights[self._used]
        X = fit.system.X[self._used][:, fit.taken] * weights[:, None]
        self._Q = np.linalg.qr(X / np.linalg.norm(X, axis=0))[0]
        self._weights, self._rest = weights, fit.rest[self._used] * weights
        self._blocks = np.unique(block_numbers(fit.system, fit.block)[self._used], return_inverse=True)[1]

    def test(self, column: FloatArray) -> tuple[float, float, float, float]:
        """Return the coefficient of a column, its t, its degrees of freedom and the squares that it explains.

        The coefficient, t and the squares are 0 if it tells nothing new.
        """
        own = column[self._used] * self._weights
        size = float(np.linalg.norm(own))
        left = own - self._Q @ (self._Q.T @ own)
        left -= self._Q @ (self._Q.T @ left)
        if float(np.linalg.norm(left)) <= 1e-3 * size:
            return 0.0, 0.0, 1.0, 0.0
        square = float(left @ left)
        value = float(left @ self._rest) / square
        rest = self._rest - left * value
        by_block = np.bincount(self._blocks, left * rest)
        shares = np.bincount(self._blocks, left**2)
        freedom = float(shares.sum() ** 2 / np.sum(shares**2)) - 1.0
        if freedom < _FEWEST:
            return 0.0, 0.0, 1.0, 0.0
        deviation = float(np.sqrt(np.sum(by_block**2) * (1.0 + 2.0 / freedom))) / square
        return value, value / max(deviation, 1e-300), freedom, value**2 * square


def find_flags(fit: Fit, logs: Sequence[LogRows]) -> list[Flag]:
    """Return the curves that the residuals of each joint follow in spite of the friction of the fit."""
    if _is_exact(fit):
        return []
    score, tested = _Score(fit), []
    for joint in np.unique(fit.system.joint).tolist():
        columns: dict[str, list[FloatArray]] = {}
        for rows in logs:
            if rows.motion.unusable[joint]:
                continue
            at = rows.speeds(joint, fit.state.loads(rows)[:, joint])
            for name, column in other_columns(fit.state.layout.kind, at).items():
                columns.setdefault(name, []).append(rows.motion.behind_filter(column))
        for name, parts in columns.items():
            whole = np.zeros(len(fit.rest))
            whole[fit.system.joint == joint] = np.concatenate(parts)
            _, t, freedom, _ = score.test(whole)
            tested.append((joint, name, t, freedom))
    found = []
    for joint, name, t, freedom in tested:
        limit = float(stdtrit(freedom, 1.0 - 0.5 * _DOUBT / len(tested)))
        if abs(t) > limit:
            found.append(Flag(joint, name, t, limit))
    return sorted(found, key=lambda flag: -abs(flag.t) / flag.limit)


def _is_exact(fit: Fit) -> bool:
    used = fit.weights > 0.0
    return float(np.linalg.norm(fit.rest[used])) < 1e-9 * float(np.linalg.norm(fit.system.y[used]))


def payload_sentences(fit: Fit, logs: Sequence[LogRows]) -> Iterator[str]:
    """Yield a sentence for each payload that seems to change within a log, or to differ between logs."""
    for found in find_masses(fit, logs):
        if isinstance(found, OtherMass):
            more = "more" if found.mass > 0.0 else "less"
            yield f"{found.log} seems to carry {abs(found.mass):.2g} kg {more} than the other logs"
        else:
            yield f"{found.log}: the payload seems to change by {found.mass:+.2g} kg at {found.time:.3g} s"


def find_masses(fit: Fit, logs: Sequence[LogRows]) -> Iterator[MassChange | OtherMass]:
    """Yield a change of the mass at the tip within each log, or the log that differs most, if the residuals show one.

    No time is given where another mass in the whole log explains the residuals as well.
    """
    if _is_exact(fit):
        return
    score, system = _Score(fit), fit.system
    changes: list[tuple[float, MassChange]] = []
    wholes: list[tuple[float, OtherMass]] = []
    for number, rows in enumerate(logs):
        payload = rows.motion.behind_filter(payload_torques(rows.motion, FixedPayload(mass=1.0)))
        inside = np.linspace(0.1, 0.9, _TRIED) * float(rows.motion.times[-1])
        best, whole = (0.0, 0.0, 0.0, 0.0), (0.0, 0.0)
        for time in (-np.inf, *inside.tolist()):
            column = np.zeros(len(fit.rest))
            own = (system.log == number) & (system.time > time)
            column[own] = payload[system.row[own], system.joint[own]]
            mass, t, freedom, gain = score.test(column)
            doubt = 2.0 * (1.0 - float(stdtr(freedom, abs(t)))) * _TRIED
            if not t or doubt >= _PAYLOAD_DOUBT or abs(mass) <= _LEAST_PAYLOAD:
                continue
            if time == -np.inf:
                whole = gain, mass
            elif abs(t) > best[0]:
                best = abs(t), time, mass, gain
        if whole[0] and whole[0] >= _AS_WELL * best[3]:
            wholes.append((whole[0], OtherMass(rows.name, whole[1])))
        elif best[0]:
            changes.append((best[3], MassChange(rows.name, best[1], best[2])))
    largest = max((gain for gain, _ in wholes), default=0.0)
    if largest and largest > max((gain for gain, _ in changes), default=0.0):
        # Of two logs either may be said to differ: the one with more.
        yield max((each for gain, each in wholes if gain > _AS_WELL * largest), key=lambda each: each.mass)
    yield from (change for _, change in changes)


@dataclass(frozen=True)
class SecondMethod:
    """Ordinary least squares: all joints weigh alike, no row counts less, and the delay is kept.

    Attributes:
        values: Values of all columns, shape (n,); NaN for those that are not taken.
        differences: The difference of the fit from it, over the deviation of this difference, shape (n,).
        excess: Squared difference beyond 95 % of what chance explains, shape (n,).
        differs: Whether chance makes such a difference in less than 1 % of cases, shape (n,).
        halves: Half-widths of the 95 % intervals with this excess, shape (n,).
    """

    values: FloatArray
    differences: FloatArray
    excess: FloatArray
    differs: NDArray[np.bool_]
    halves: FloatArray


def second_method(fit: Fit) -> SecondMethod:
    """Return a fit by ordinary least squares, and the test of its difference (Hausman, Econometrica 46(6), 1978)."""
    used, taken = fit.weights > 0.0, fit.taken
    X, weights, rest = fit.system.X[used][:, taken], fit.weights[used], fit.rest[used]
    sizes = np.linalg.norm(X, axis=0)
    X = X / sizes
    plain, weighted = np.linalg.pinv(X), np.linalg.pinv(X * weights[:, None]) * weights
    change = (plain @ rest) / sizes  # of the fit's values
    blocks = np.unique(block_numbers(fit.system, fit.block)[used], return_inverse=True)[1]
    left = rest - X @ (plain @ rest)
    by_block = np.zeros((blocks.max(initial=0) + 1, len(taken)))
    np.add.at(by_block, blocks, (plain * left - weighted * rest).T)
    freedom = max(len(by_block) - len(taken) / max(fit.state.layout.nq, 1), 2.0)
    deviation = np.sqrt(np.sum(by_block**2, axis=0)) / sizes * np.sqrt(len(by_block) / freedom)
    count = fit.system.X.shape[1]
    values, differences, excess = (np.full(count, np.nan) for _ in range(3))
    values[taken] = fit.state.values[taken] + change
    differences[taken] = change / np.maximum(deviation, 1e-300)
    limit = float(stdtrit(freedom, 0.975))
    excess[taken] = np.maximum(change**2 - (limit * deviation) ** 2, 0.0)
    differs = np.nan_to_num(np.abs(differences)) > float(stdtrit(freedom, 0.995))
    return SecondMethod(values, differences, excess, differs, np.sqrt(fit.halves**2 + excess))
