r"""Weighted, robust least squares of the torques of logs, with intervals.

.. math:: s\,\tau(t + d) = Y(q, \dot q, \ddot q)\, \pi + I_a \ddot q + \tau_f(\dot q, \tau_l) + \tau_m(t)

Each joint has a weight from its residuals in a fit in which all joints count alike (Gautier, IEEE ICRA 1997). These
weights are not renewed: where the equations of the joints contradict each other, a joint that explains itself would
count ever more. Rows far outside, such as contacts, count less (Huber, Annals of Mathematical Statistics 35(1), 1964).
The delay d of the torques is found by Gauss-Newton steps. So are torque constants, of which s corrects those of the
column map, if logs with different known payloads tau_m are given: a payload in all logs could be part of the last link.

Residuals are correlated in time, so rows are combined to blocks whose length follows from the residuals. With several
logs, the spread of their separate fits beyond these intervals is added (DerSimonian and Laird, Controlled Clinical
Trials 7(3), 1986).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.special import chdtrc, stdtrit

from runner.base.arrays import FloatArray
from runner.identification.friction_kinds import SHAPED, SHAPES, TERMS, FrictionKind
from runner.identification.log_rows import LogRows
from runner.identification.parameters import group_columns
from runner.identification.system import Layout, State, System, linear_system
from runner.recordings.block_intervals import block_scores

_TOLD_APART = 1e-3  # share of a column that the others must leave, or the logs do not tell it
_OUTSIDE = 3.0  # times the usual residual of a joint, from which on a row counts less
_EXACT = 1e-12  # of the rms of a joint's torque: a smaller residual is rounding
_ALIKE = 4  # steps in which all joints count alike
_STEPS = 12
_STEADY = 1e-7  # s, of the delay
_SETTLED = 1e-6  # of the largest base parameter
_LONGEST_DELAY = 0.05  # s
_WRONG = 5.0  # largest factor of a torque constant; without motion it would vanish
_BLOCK = 0.5  # s
_TIMES_CORRELATION = 6.0  # a block is that many times as long as residuals are correlated
_FEWEST_BLOCKS = 20
_CHANCE = 0.001  # probability that equal logs are said to differ in a value


@dataclass(frozen=True)
class Fit:
    """A fit of one kind of friction.

    Attributes:
        state: The values, the delay and the shapes.
        taken: Columns that the logs tell apart; the others are zero.
        factors: The factor of each column in the sums that the taken ones stand for, shape (taken, n).
        halves: Half-widths of the 95 % intervals of all values, shape (n,); NaN for those that are not taken.
        within: The same without the spread between logs, shape (n,).
        white: The same for residuals that are not correlated, shape (n,).
        deviations: Standard deviations behind `halves`, shape (n,).
        effects: What each block adds to each taken value, shape (blocks, taken).
        spread: Whether logs differ in each value by more than their own intervals explain, shape (n,).
        system: Equations about the state.
        rest: Residuals of all rows, shape (R,), in N m.
        weights: Weights of all rows, shape (R,); 0 for rows that are not of the fit.
        block: Length of a block, in s.
        outside: Rows of the fit far outside, shape (R,).
    """

    state: State
    taken: list[int]
    factors: FloatArray
    halves: FloatArray
    within: FloatArray
    white: FloatArray
    deviations: FloatArray
    effects: FloatArray
    spread: NDArray[np.bool_]
    system: System
    rest: FloatArray
    weights: FloatArray
    block: float
    outside: NDArray[np.bool_]

    @property
    def condition(self) -> float:
        """Condition number of the equations, each column divided by its size."""
        X = self.system.X[:, self.taken] * self.weights[:, None]
        values = np.linalg.svd(X / np.linalg.norm(X, axis=0), compute_uv=False)
        return float(values[0] / values[-1])


def fit_logs(
    logs: Sequence[LogRows], kind: FrictionKind, start: FloatArray | None = None, currents: Sequence[int] = ()
) -> Fit:
    """Return the fit of a kind of friction to logs.

    Args:
        logs: Rows of the logs.
        kind: Kind of friction.
        start: Base parameters from which the steps begin, shape (number of sums,); None for zero.
        currents: Joints whose torque constants are fitted.
    """
    state, taken, factors, sizes = solve_logs(logs, kind, start, currents)
    system = linear_system(logs, state, True)
    rest = _rest(system, state)
    weights, outside = row_weights(system, rest, sizes)
    return _with_intervals(state, taken, factors, system, rest, weights, outside)


def solve_logs(
    logs: Sequence[LogRows], kind: FrictionKind, start: FloatArray | None = None, currents: Sequence[int] = ()
) -> tuple[State, list[int], FloatArray, FloatArray]:
    """Return the values of a fit, the columns that the logs tell apart, their sums, and the residuals' joint sizes."""
    nb, nq = logs[0].Y.shape[2], logs[0].motion.model.nq
    layout = Layout(kind, nb, nq, currents)
    constants = slice(layout.constants, layout.delay)
    values = np.zeros(layout.delay + 1)
    values[:nb] = 0.0 if start is None else start
    state = State(layout, values, 0.0, np.full(nq, SHAPES[len(SHAPES) // 2]), np.ones(nq))
    if currents:
        state = replace(state, scales=_first_scales(linear_system(logs, state, False)))
    taken: list[int] = []
    factors, sizes = np.zeros((0, 0)), np.ones(nq)
    weights: FloatArray | None = None
    for step in range(_STEPS):
        system = linear_system(logs, state, step > 1)
        if weights is None:
            weights = np.where(system.moving, 1.0, 0.0)
        if step < 3:  # the sums that are told apart do not change with small changes of load and delay
            taken, factors = _told_apart(system)
        values = _solved(system, weights, taken)
        change = float(values[layout.delay]) if step > 1 else np.inf
        delay = float(np.clip(state.delay + (change if step > 1 else 0.0), -_LONGEST_DELAY, _LONGEST_DELAY))
        still = np.abs(values[:nb] - state.values[:nb]).max(initial=0.0)
        gains, scales = values[constants].copy(), state.scales.copy()
        scales[list(currents)] *= 1.0 + np.clip(gains, 1.0 / _WRONG - 1.0, _WRONG - 1.0)
        values[constants.start :] = 0.0
        state = replace(state, values=values, delay=delay, scales=scales)
        rest = _rest(system, state) - system.X[:, constants] @ gains
        if step < _ALIKE:
            sizes = residual_sizes(system, rest)
        weights = row_weights(system, rest, sizes)[0]
        if step < _ALIKE - 1:
            weights *= sizes[system.joint]
        if kind in SHAPED and step < 3:
            state = replace(state, shapes=_best_shapes(logs, state, system, weights))
        settled = abs(change) < _STEADY and still < _SETTLED * (1.0 + np.abs(values[:nb]).max(initial=0.0))
        settled &= np.abs(gains).max(initial=0.0) < _SETTLED
        if step > _ALIKE and settled:
            break
    return state, taken, factors, sizes


def _first_scales(system: System) -> FloatArray:
    """Return factors of the torque constants from linear equations, shape (nq,), a little low due to noise; else 1."""
    layout, used = system.layout, system.moving
    recorded, carried = (system.y + system.carried)[used], system.carried[used]
    columns, weights = np.zeros((len(recorded), layout.nq)), np.ones(len(recorded))
    for joint in np.unique(system.joint).tolist():
        own = system.joint[used] == joint
        weights[own] /= max(float(np.std(recorded[own])), 1e-9)
        if joint in layout.currents:
            columns[own, joint] = -recorded[own]
    X = np.column_stack([system.X[used, : layout.constants], columns]) * weights[:, None]
    told = group_columns(X, range(X.shape[1]), _TOLD_APART)[0]
    others = [layout.constants + joint for joint in layout.currents if layout.constants + joint not in told]
    y = -carried * weights - X[:, others].sum(axis=1)
    scales = np.ones(layout.nq)
    for column, value in zip(told, np.linalg.lstsq(X[:, told], y, rcond=None)[0], strict=True):
        if column >= layout.constants and 1.0 / _WRONG < value < _WRONG:
            scales[column - layout.constants] = value
    return scales


def _told_apart(system: System) -> tuple[list[int], FloatArray]:
    """Return the columns that the rows of the fit tell apart, and their sums; each joint counts by its torque."""
    weights, used = np.ones(len(system.y)), system.moving
    for joint in np.unique(system.joint):
        own = system.joint == joint
        weights[own] /= max(float(np.std(system.y[own])), 1e-9)
    X = system.X[used] * weights[used, None]
    sizes = np.maximum(np.linalg.norm(X, axis=0), 1e-300)
    scaled = X / sizes
    values, vectors = np.linalg.eigh(scaled.T @ scaled)
    root = np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T  # it has the products of the columns of X
    return group_columns(root * sizes, range(X.shape[1]), _TOLD_APART)


def _solved(system: System, weights: FloatArray, taken: Sequence[int]) -> FloatArray:
    """Return the values by the normal equations; a second step removes their rounding."""
    used = weights > 0.0
    X, y = system.X[used][:, taken] * weights[used, None], system.y[used] * weights[used]
    sizes = np.linalg.norm(X, axis=0)
    X = X / sizes
    factor = cho_factor(X.T @ X)
    found = cho_solve(factor, X.T @ y)
    found += cho_solve(factor, X.T @ (y - X @ found))
    values = np.zeros(system.X.shape[1])
    values[list(taken)] = found / sizes
    return values


def _rest(system: System, state: State) -> FloatArray:
    rest: FloatArray = system.y - system.X @ state.values
    return rest


def residual_sizes(system: System, rest: FloatArray) -> FloatArray:
    """Return the usual size of each joint's residuals in the rows of the fit, shape (nq,), in N m; 1 without rows."""
    sizes = np.ones(system.layout.nq)
    for joint in np.unique(system.joint):
        own = (system.joint == joint) & system.moving
        if own.any():
            usual = 1.4826 * float(np.median(np.abs(rest[own])))
            sizes[joint] = max(usual, _EXACT * float(np.sqrt(np.mean(system.y[own] ** 2))), 1e-12)
    return sizes


def row_weights(system: System, rest: FloatArray, sizes: FloatArray) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return the weight of each row, 0 for rows that are not of the fit, and which rows are far outside.

    Args:
        system: The equations.
        rest: Residuals of all rows, shape (R,), in N m.
        sizes: Usual size of each joint's residuals, shape (nq,), in N m.
    """
    usual = sizes[system.joint]
    far = _OUTSIDE * usual / np.maximum(np.abs(rest), 1e-300)
    weights = np.where(system.moving, np.sqrt(np.minimum(far, 1.0)) / usual, 0.0)
    return weights, system.moving & (far < 1.0)


def _best_shapes(logs: Sequence[LogRows], state: State, system: System, weights: FloatArray) -> FloatArray:
    """Return the v_s of each joint that leaves the smallest residual, with the base parameters as they are."""
    layout, shapes = state.layout, state.shapes.copy()
    inertial = system.y - system.X[:, : layout.base] @ state.values[: layout.base]
    inertial -= system.X[:, layout.delay] * state.values[layout.delay]
    filtered = [_columns_of_shapes(rows, state) for rows in logs]
    for joint in range(layout.nq):
        own = (system.joint == joint) & (weights > 0.0)
        if not own.any():
            continue
        with_torque = [each for each, rows in zip(filtered, logs, strict=True) if not rows.motion.unusable[joint]]
        columns = np.concatenate([each[:, :, joint] for each in with_torque])[own[system.joint == joint]]
        y, w = inertial[own] * weights[own], weights[own, None]
        tried = [np.linalg.qr(columns[:, number] * w)[0] for number in range(len(SHAPES))]
        shapes[joint] = SHAPES[int(np.argmax([float(np.sum((Q.T @ y) ** 2)) for Q in tried]))]
    return shapes


def _columns_of_shapes(rows: LogRows, state: State) -> FloatArray:
    """Return the filtered columns of friction for each v_s that is tried, shape (M, shapes, nq, terms)."""
    layout = state.layout
    no_load = np.zeros(len(rows.motion.q))
    columns = [
        replace(state, shapes=np.full(layout.nq, shape)).friction_columns(rows, joint, no_load)
        for shape in SHAPES
        for joint in range(layout.nq)
    ]
    found = rows.motion.behind_filter(np.hstack(columns))
    return found.reshape(len(found), len(SHAPES), layout.nq, -1)


def _with_intervals(
    state: State, taken: list[int], factors: FloatArray, system: System, rest: FloatArray, weights: FloatArray,
    outside: NDArray[np.bool_],
) -> Fit:  # fmt: skip
    block = _block_length(system, rest, weights)
    count = system.X.shape[1]
    halves, within, white, deviations = (np.full(count, np.nan) for _ in range(4))
    spread = np.zeros(count, dtype=bool)
    place = np.array(taken)
    effects = np.zeros((0, len(taken)))
    all_logs = _covariance(system, rest, weights, taken, block, np.ones(len(rest), dtype=bool))
    if all_logs is not None:
        effects, freedom, plain = all_logs
        deviation = np.linalg.norm(effects, axis=0)
        within[place] = stdtrit(freedom, 0.975) * deviation
        white[place] = 1.96 * plain
        extra, own_freedom, differing = _between(system, rest, weights, taken, block)
        variance = deviation**2 + extra
        mixed = variance**2 / np.maximum(deviation**4 / freedom + extra**2 / own_freedom, 1e-300)
        halves[place] = stdtrit(np.maximum(mixed, 1.0), 0.975) * np.sqrt(variance)
        deviations[place] = np.sqrt(variance)
        spread[place] = differing
    return Fit(
        state, taken, factors, halves, within, white, deviations, effects, spread, system, rest, weights, block, outside
    )


def _covariance(
    system: System, rest: FloatArray, weights: FloatArray, taken: Sequence[int], block: float,
    rows: NDArray[np.bool_],
) -> tuple[FloatArray, FloatArray, FloatArray] | None:  # fmt: skip
    """Return the effects of blocks, degrees of freedom and deviation of white residuals of the taken columns.

    The effects are at least as large as those of white residuals.
    """
    used = (weights > 0.0) & rows
    if used.sum() <= len(taken) + 1:
        return None
    X = system.X[used][:, taken] * weights[used, None]
    sizes = np.linalg.norm(X, axis=0)
    if not sizes.all():
        return None
    own = X / sizes
    Q, R = np.linalg.qr(own)
    bread = np.linalg.pinv(R.T @ R)
    blocks = block_numbers(system, block)[used]
    left = rest[used] * weights[used]
    scores = block_scores(own, Q, left, blocks)
    if len(scores) < 2:
        return None
    numbers = np.unique(blocks, return_inverse=True)[1]
    shares = np.zeros((len(scores), len(taken)))
    np.add.at(shares, numbers, (own @ bread) ** 2)
    freedom = np.maximum(np.sum(shares, axis=0) ** 2 / np.sum(shares**2, axis=0) - 1.0, 1.0)
    plain = np.sqrt(float(left @ left) / (used.sum() - len(taken)) * np.diagonal(bread)) / sizes
    effects = scores @ bread / sizes
    size = np.linalg.norm(effects, axis=0)  # small if residuals of alternating sign cancel within blocks
    floor = np.divide(plain, size, out=np.ones_like(size), where=size > 0.0)
    return effects * np.maximum(floor, 1.0), freedom, plain


def block_numbers(system: System, block: float) -> NDArray[np.intp]:
    """Return the number of the block of each row, shape (R,)."""
    in_log = (system.time / block).astype(np.intp)
    numbers: NDArray[np.intp] = system.log * (int(in_log.max(initial=0)) + 1) + in_log
    return numbers


def _between(
    system: System, rest: FloatArray, weights: FloatArray, taken: Sequence[int], block: float
) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """Return the variance that differences between logs add, its degrees of freedom, and if they exceed chance."""
    logs, many = np.unique(system.log), len(taken)
    estimates, variances = (np.full((len(logs), many), np.nan) for _ in range(2))
    for number, log in enumerate(logs) if len(logs) > 1 else ():
        rows = (system.log == log) & (weights > 0.0)
        X = system.X[rows][:, taken] * weights[rows, None]
        told = group_columns(X, range(many), _TOLD_APART)[0]
        chosen = [taken[place] for place in told]
        # The residuals of the common fit give the changes of its values that fit only this log.
        values = _solved(replace(system, y=rest), np.where(rows, weights, 0.0), chosen)
        found = _covariance(system, rest - system.X @ values, weights, chosen, block, rows)
        if found is not None:
            estimates[number, told], variances[number, told] = values[chosen], np.sum(found[0] ** 2, axis=0)
    known = np.isfinite(variances) & (variances > 0.0)
    count = known.sum(axis=0)
    weight = np.where(known, 1.0 / np.where(known, variances, 1.0), 0.0)
    whole = np.maximum(weight.sum(axis=0), 1e-300)
    values = np.where(known, estimates, 0.0)
    mean = np.sum(weight * values, axis=0) / whole
    Q = np.sum(weight * (values - mean) ** 2, axis=0)
    scale = np.maximum(whole - np.sum(weight**2, axis=0) / whole, 1e-300)
    extra = np.where(count > 1, np.maximum(0.0, (Q - (count - 1)) / scale), 0.0)
    freedom = np.maximum(count - 1.0, 1.0)
    differing: NDArray[np.bool_] = (count > 1) & (chdtrc(freedom, Q) < _CHANCE)
    return extra * np.sum((weight / whole) ** 2, axis=0), freedom, differing


def _block_length(system: System, rest: FloatArray, weights: FloatArray) -> float:
    """Return the length of blocks, in s, from the time within which residuals are correlated."""
    products, counts = np.zeros(200), np.zeros(200)
    for log in np.unique(system.log):
        for joint in np.unique(system.joint):
            own = (system.log == log) & (system.joint == joint)
            series = np.where(weights[own] > 0.0, rest[own] * weights[own], np.nan)
            for lag in range(min(200, len(series) - 1)):
                pairs = series[lag:] * series[: len(series) - lag]
                products[lag] += np.nansum(pairs)
                counts[lag] += np.isfinite(pairs).sum()
    alike = products / np.maximum(counts, 1.0)
    share = alike / max(alike[0], 1e-300)
    end = int(np.argmax(share < 0.05)) or len(share)
    period = float(np.median(system.period))
    correlated = period * (1.0 + 2.0 * float(share[1:end].sum()))
    lasts = sum(float(np.ptp(system.time[system.log == log])) for log in np.unique(system.log))
    return float(max(min(_TIMES_CORRELATION * correlated, lasts / _FEWEST_BLOCKS), min(_BLOCK, lasts / _FEWEST_BLOCKS)))


def constant_name(joint: str) -> str:
    """Return the name of the torque constant of a joint."""
    return f"torque constant of {joint}"


def name_of(layout: Layout, column: int, sums: Sequence[str], joints: Sequence[str]) -> str:
    """Return the name of a column."""
    if column < layout.base:
        return sums[column]
    if column == layout.delay:
        return "delay"
    if column >= layout.constants:
        return constant_name(joints[layout.currents[column - layout.constants]])
    joint, term = divmod(column - layout.base, len(TERMS[layout.kind]))
    return f"{TERMS[layout.kind][term]} of {joints[joint]}"
