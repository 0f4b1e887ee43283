"""Sweeps that were never run, for the tests of their comparison."""

import itertools
from pathlib import Path

import numpy as np

from runner.store.axes import Axis
from runner.sweeps.measurements import Measurements

LAWS = {"robot": ["macro", "xarm7"], "gravity": [9.6, 9.81]}


def side(name, axes, value, seed=0, repetitions=8, order=None, **config):
    """Return a full grid of two metrics, whose repetitions draw the same in every sweep of one seed.

    Args:
        name: What it is called.
        axes: Values of each axis; the cells are in `order`.
        value: Error of a cell, a function of its values.
        seed: Its seed.
        repetitions: Number of repetitions.
        order: Places of the cells of the grid, as they are stored; None for that of the grid.
        config: Resolved values of all cells, by group.
    """
    cells = list(itertools.product(*axes.values()))
    cells = [cells[place] for place in (order or range(len(cells)))]
    draws = {cell: np.random.default_rng([seed, *map(hash_of, cell)]).normal(size=repetitions) for cell in cells}
    error = np.array([value(*cell) + 1e-3 * draws[cell] for cell in cells])
    configs = []
    for number, cell in enumerate(cells):
        resolved = {"seed": seed, "repetitions": repetitions, "mismatch": {"spread": 0.0}, **config}
        for key, level in zip(axes, cell, strict=True):
            resolved[key] = {"name": level} if isinstance(level, str) else level
        configs.append((resolved, np.array([number])))
    return Measurements(
        axes=[
            Axis(key, values, np.array([list(values).index(cell[place]) for cell in cells]))
            for place, (key, values) in enumerate(axes.items())
            if len(values) > 1
        ],
        fixed=[f"{key}={values[0]}" for key, values in axes.items() if len(values) == 1],
        hashes=[f"{number:024x}" for number in range(len(cells))],
        statuses=["ok"] * len(cells),
        failures=[""] * len(cells),
        units={"rms_tracking_error": "m", "peak_torque_q1": "N m"},
        values={"rms_tracking_error": error, "peak_torque_q1": np.ones_like(error)},
        provenance={"made on": ["2026-11-22"], "commit": ["abc"], "plant": ["bullet, step 0.001 s"]},
        seeds=np.full(len(cells), seed),
        configs=configs,
        name=name,
        folder=Path(f"outputs/sweeps/{name}"),
        command=f"runner -m {name}",
    )


def hash_of(value):
    """Return a number that stands for a value, the same in every process."""
    return sum(map(ord, str(value)))
