"""Symbols of the thesis formulas at random states."""

import numpy as np

from runner.base.arrays import FloatArray

JOINTS = 6
_SUMS = ("1", "2", "3", "4", "5", "6", "12", "23", "123", "45", "56", "456", "1_2", "1_2_3", "4_5", "4_5_6")
_REGULAR = 0.05  # share of the largest determinant below which a posture counts as singular


def symbols(count: int, generator: np.random.Generator) -> dict[str, FloatArray]:
    """Return random states of the six joints, with the abbreviations of sections 3.1 and 4.1.

    c12 is cos(q1 + q2); c1_2_3 is what the thesis prints as c(1-2-3), cos(q1 - q2 - q3). theta, alpha, a and d are
    the parameters of any one link, xi and omega_n those of any second-order loop, n any number of joints, c_0 to c_5
    the coefficients of the quintic from x_0 to x_t in t_f, s any number. `x` and `z` are the axes of the base.
    """
    q = generator.uniform(-np.pi, np.pi, (count, JOINTS))
    return _named(q, generator)


def regular_symbols(count: int, generator: np.random.Generator) -> dict[str, FloatArray]:
    """Return random states as `symbols` does, without those near a singular configuration of either arm.

    The determinant of the linear Jacobian is -c3 (c2 - s23) for the Macro, and alike for the Mini.
    """
    q = generator.uniform(-np.pi, np.pi, (8 * count, JOINTS))
    _, q2, q3, _, q5, q6 = q.T
    macro = np.abs(np.cos(q3) * (np.cos(q2) - np.sin(q2 + q3)))
    mini = np.abs(np.cos(q6) * (np.cos(q5) - np.sin(q5 + q6)))
    return _named(q[(macro > _REGULAR) & (mini > _REGULAR)][:count], generator)


def abbreviations(q: FloatArray) -> dict[str, FloatArray]:
    """Return the names of sections 3.1 and 4.1 at joint positions, shape (T, 6), in rad."""
    values = {f"q{i + 1}": q[:, i] for i in range(JOINTS)}
    for digits in _SUMS:
        angle = _angle(digits, q)
        values |= {f"c{digits}": np.cos(angle), f"s{digits}": np.sin(angle)}
    return values


def _named(q: FloatArray, generator: np.random.Generator) -> dict[str, FloatArray]:
    count = len(q)
    values = abbreviations(q)
    values |= {f"dq{i + 1}": generator.uniform(-1.0, 1.0, count) for i in range(JOINTS)}
    values |= {f"ddq{i + 1}": generator.uniform(-1.0, 1.0, count) for i in range(JOINTS)}
    values |= {"theta": generator.uniform(-np.pi, np.pi, count), "alpha": generator.uniform(-np.pi, np.pi, count)}
    values |= {name: generator.uniform(-1.0, 1.0, count) for name in ("a", "d", "x_0", "x_t")}
    values |= {"xi": generator.uniform(0.2, 2.0, count), "omega_n": generator.uniform(1.0, 300.0, count)}
    values |= {"t_f": generator.uniform(0.5, 5.0, count), "pi": np.full(count, np.pi)}
    values |= {"s": values["d"]} | {axis: np.tile(row, (count, 1)) for axis, row in zip("xyz", np.eye(3), strict=True)}
    values |= {"n": generator.integers(2, 9, count).astype(float)}
    D, t_f = values["x_t"] - values["x_0"], values["t_f"]
    values |= {"c_0": values["x_0"], "c_1": 0.0 * D, "c_2": 0.0 * D}
    return values | {"c_3": 10.0 * D / t_f**3, "c_4": -15.0 * D / t_f**4, "c_5": 6.0 * D / t_f**5}


def _angle(digits: str, q: FloatArray) -> FloatArray:
    first, *rest = (int(digit) - 1 for digit in digits.replace("_", ""))
    return np.asarray(q[:, first] + (-1.0 if "_" in digits else 1.0) * q[:, rest].sum(axis=1))


def symbols_at(q: FloatArray) -> dict[str, FloatArray]:
    """Return the names of sections 3.1 and 4.1 at joint positions (T, 6), or the Macro's (T, 3), the Mini home."""
    return abbreviations(np.column_stack([q, np.zeros((len(q), JOINTS - q.shape[1]))]))
