"""Quantities of one run or of several, for chapters: signals over time, numbers of them, and arithmetic on both."""

import operator
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.dotted_keys import get
from runner.base.lazy_modules import pin
from runner.papers.study.run_values import Signal, config_value, number_of, trace_of
from runner.reporting.table import Number
from runner.store import Run


def _operation(work: Callable[[Any, Any], Any], swapped: bool = False) -> Callable[["Quantity", Any], "Quantity"]:
    """Return an operator of Quantity; a side without a value gives none."""

    def operate(first: "Quantity", second: Any) -> "Quantity":
        def value(*runs: Run) -> Any:
            sides = first(*runs), second(*runs) if callable(second) else second
            left, right = sides[::-1] if swapped else sides
            if left is None or right is None:
                return None
            with np.errstate(divide="ignore", invalid="ignore"):  # of rows where a signal is zero
                return work(left, right)

        return Quantity(value)

    return operate


class Quantity:
    """A number or signal of one run or of several. It is computed when it is called, and it has arithmetic.

    Args:
        of: Gives the value.
    """

    def __init__(self, of: Callable[..., Any]) -> None:
        self._of = of

    def __call__(self, *runs: Run) -> Any:
        """Return the value of some runs, numbers as Python's own."""
        value = self._of(*runs)
        return value.item() if isinstance(value, np.generic) else value

    __add__, __radd__ = _operation(operator.add), _operation(operator.add, swapped=True)
    __sub__, __rsub__ = _operation(operator.sub), _operation(operator.sub, swapped=True)
    __mul__, __rmul__ = _operation(operator.mul), _operation(operator.mul, swapped=True)
    __truediv__, __rtruediv__ = _operation(operator.truediv), _operation(operator.truediv, swapped=True)
    __pow__ = _operation(operator.pow)

    def __str__(self) -> str:
        """Refuse: it has a value for a run only."""
        raise TypeError("a quantity has a value for a run; write of_run(WORDS, QUANTITY, UNIT, RUN)")

    def __neg__(self) -> "Quantity":
        """Return it with the other sign."""
        return -1.0 * self


def signal(name: Signal) -> Quantity:
    """Return a column of the trace, or what a function gives, for arithmetic."""
    return Quantity(lambda *runs: trace_of(name, *runs))


def vector(name: str) -> Quantity:
    """Return a vector with columns name_x, name_y and name_z at each row, shape (T, 3)."""
    return Quantity(lambda run, *_: run.vector(name))


def of_joints(name: str = "q", first: int = 0, last: int | None = None) -> Quantity:
    """Return a signal of each joint at each row: of all, or from one to before another, counted from 0."""
    return Quantity(lambda run, *_: run.joints(name)[:, first:last])


def norm(what: Signal) -> Quantity:
    """Return the length at each row of a vector with columns name_x, name_y and name_z, or of any by a function."""
    rows = _vector(what)
    return Quantity(lambda *runs: np.linalg.norm(values := rows(*runs), axis=None if np.ndim(values) == 1 else 1))


def of_next(what: Signal) -> Quantity:
    """Return a quantity of the second of two runs."""
    return Quantity(lambda _, *runs: what(*runs) if callable(what) else trace_of(what, *runs))


def difference(what: Signal, times: float = 1.0) -> Quantity:
    """Return a signal less a multiple of that of another run, at their common rows."""

    def value(*runs: Run) -> FloatArray:
        first, second = (what(run) if callable(what) else trace_of(what, run) for run in runs)
        rows = min(len(first), len(second))
        return np.asarray(first[:rows] - times * second[:rows])

    return Quantity(value)


def distance(name: str = "tip") -> Quantity:
    """Return the distance between such a vector of two runs at their common times."""
    return norm(difference(vector(name)))


def along(what: Signal, direction: str) -> Quantity:
    """Return the part of a vector at each row along the vector under a dotted key of the config, as `norm` takes it."""
    rows = _vector(what)
    return Quantity(lambda *runs: rows(*runs) @ _unit(runs[0], direction))


def across(what: Signal, direction: str) -> Quantity:
    """Return the length at each row of the rest of a vector, at a right angle to the vector under such a key."""
    rows = _vector(what)

    def rest(*runs: Run) -> FloatArray:
        values, unit = rows(*runs), _unit(runs[0], direction)
        return np.asarray(values - np.outer(values @ unit, unit))

    return norm(rest)


def between(what: Signal, start: float, end: float = np.inf) -> Quantity:
    """Return the rows of a signal from one time to another, in s; a negative start counts from the end of the run."""

    def rows(run: Run, *others: Run) -> FloatArray:
        values = trace_of(what, run, *others)
        t, first = run.t[: len(values)], start if start >= 0.0 else run.t[-1] + start
        return values[(t >= first - 1e-9) & (t <= end + 1e-9)]

    return Quantity(rows)


def moved(what: Signal) -> Quantity:
    """Return a signal less its first value."""
    return signal(what) - at_the_start(what)


def at_the_start(what: Signal) -> Quantity:
    """Return the first value of a signal; None where it has none."""
    return Quantity(lambda *runs: next(iter(trace_of(what, *runs)), None))


def at_the_end(what: Signal) -> Quantity:
    """Return the last value of a signal; None where it has none."""
    return Quantity(lambda *runs: next(reversed(trace_of(what, *runs)), None))


def worst_axis(what: Signal) -> Quantity:
    """Return the largest size of a vector's components at each row: of one by its name, or of any by a function."""
    rows = _vector(what)
    return Quantity(lambda *runs: np.abs(rows(*runs)).max(axis=1))


def largest_of(what: Signal) -> Quantity:
    """Return the largest finite value of a signal, without sign; None where there is none."""

    def value(*runs: Run) -> float | None:
        given = np.abs(trace_of(what, *runs))
        finite = given[np.isfinite(given)]
        return float(finite.max()) if finite.size else None

    return Quantity(value)


def highest_of(what: Signal) -> Quantity:
    """Return the largest value of a signal, with its sign."""
    return Quantity(lambda *runs: trace_of(what, *runs).max())


def lowest_of(what: Signal) -> Quantity:
    """Return the smallest value of a signal, with its sign."""
    return Quantity(lambda *runs: trace_of(what, *runs).min())


def range_of(what: Signal) -> Quantity:
    """Return the largest value of a signal less the smallest."""
    return highest_of(what) - lowest_of(what)


def ends_of(what: Signal) -> Quantity:
    """Return the smallest and the largest value of a signal, for a cell such as "0.2 to 0.5"; one number if equal."""

    def ends(*runs: Run) -> Number:
        low, high = (float(end(what)(*runs)) for end in (lowest_of, highest_of))
        return Number(low) if low == high else Number(None, low, high)

    return Quantity(ends)


def total_of(what: Signal) -> Quantity:
    """Return the sum of the values of a signal."""
    return Quantity(lambda *runs: trace_of(what, *runs).sum())


def mean_of(what: Signal) -> Quantity:
    """Return the mean of the values of a signal; None where it has none."""
    return Quantity(lambda *runs: values.mean() if (values := trace_of(what, *runs)).size else None)


def time_of_largest(what: Signal) -> Quantity:
    """Return when a signal is largest, without sign, in s."""
    return Quantity(lambda *runs: trace_of("t", runs[0])[int(np.argmax(np.abs(trace_of(what, *runs))))])


def size_of(what: Callable[..., float]) -> Quantity:
    """Return a number without its sign; None if it has no value."""
    return Quantity(lambda *runs: None if (value := what(*runs)) is None else abs(value))


def scaled(factor: float, what: Callable[..., float]) -> Quantity:
    """Return a multiple of a number, such as 1000 for mm."""
    return factor * Quantity(what)


def part(what: Callable[..., Mapping[str, Any]], key: str, factor: float = 1.0) -> Quantity:
    """Return one of the numbers or strings that a function gives, by its key; a number is multiplied by `factor`."""
    value = Quantity(lambda *runs: what(*runs)[key])
    return value if factor == 1.0 else factor * value


def setting(key: str, factor: float = 1.0) -> Quantity:
    """Return the number or vector under a dotted key of a run's config, such as "goal.0", multiplied by `factor`."""
    return factor * Quantity(lambda run, *_: np.array(config_value(run, key), dtype=float)[()])


def metric_of(name: str, factor: float = 1.0) -> Quantity:
    """Return a multiple of the median of a metric."""
    return factor * Quantity(lambda run, *_: run.median(name))


def recorded(key: str, factor: float = 1.0) -> Quantity:
    """Return the number under a dotted key of a run's record, multiplied by `factor`; None if it is missing."""
    return factor * Quantity(lambda run, *_: get(run.record, key))


def failed(run: Run) -> bool:
    """Return True if a run failed."""
    return run.status == "failed"


def power_law(value: Any, at: float, power: float = 1.0) -> Callable[[float], float | None]:
    """Return the law that is proportional to a power of its argument and has a value, measured or not, at one place."""
    known = getattr(value, "value", value)
    return lambda x: None if known is None else known * x / at if power == 1.0 else known * (x / at) ** power


def exponent(x: Signal, y: Signal, shared: int = 0) -> Quantity:
    """Return the exponent with which one number grows with another over some runs, by least squares of the logarithms.

    Args:
        x: Name of a metric, or a function of a run, that gives the first number.
        y: The other; a function also gets the last `shared` runs, with which it compares each of those before.
        shared: Number of these runs.
    """

    def value(*runs: Run) -> float | None:
        own, common = runs[: len(runs) - shared], runs[len(runs) - shared :]
        pairs = np.array([(number_of(x, run), number_of(y, run, *common)) for run in own], dtype=float)
        return float(np.polyfit(np.log(pairs[:, 0]), np.log(pairs[:, 1]), 1)[0]) if (pairs > 0.0).all() else None

    return Quantity(value)


def turns(run: Run) -> FloatArray:
    """Return the rotation vector of the tip since the first row, along the base's axes, shape (T, 3), in rad."""
    model, rows = run.model, run.joints("q")
    first = model.tip_pose(rows[0])[:3, :3]
    return np.array([pin.log3(model.tip_pose(q)[:3, :3] @ first.T) for q in rows])


def manipulability(run: Run) -> FloatArray:
    """Return sqrt(det(J J^T)) at each row, of the tip's position, in m³, or of its pose where the law leads that."""
    return np.array([float(np.prod(values)) for values in _singular(run)])


def smallest_singular_value(run: Run) -> FloatArray:
    """Return the smallest singular value of the same Jacobian at each row, in m/rad for a position."""
    return np.array([float(values[-1]) for values in _singular(run)])


def limit_margin(run: Run) -> FloatArray:
    """Return the smallest distance of a joint position from one of its limits at each row, in rad or m."""
    return np.asarray(run.model.limit_margins(run.joints("q")).min(axis=1))


def _vector(what: Signal) -> Callable[..., Any]:
    """Return the vector with a name, or what a function gives."""
    return vector(what) if isinstance(what, str) else what


def _unit(run: Run, key: str) -> FloatArray:
    direction = np.array(config_value(run, key), dtype=float)
    return np.asarray(direction / np.linalg.norm(direction))


def _singular(run: Run) -> Sequence[FloatArray]:
    model, rows = run.model, 6 if run.config["controller"].get("task") == "pose" else 3
    q = run.joints("q")
    return [np.asarray(np.linalg.svd(model.tip_jacobian(row)[:rows], compute_uv=False), dtype=float) for row in q]
