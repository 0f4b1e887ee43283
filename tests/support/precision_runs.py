"""Runs of the report on what precision costs: a moment's motion of each arm and case, put off by a known error."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow

from runner.base.atomic import write_atomically
from runner.papers.studies.precision import measure
from runner.store import Run
from runner.store.seal import sealed_json

FIRST, FOURTH, OFF = 0.1, 50.0, 1e-15  # errors by the step: rad/s, rad/s^4; how far both ways of one scheme are apart


def error(plant: str, step: float) -> float:
    """Return the error of a plant with a step in s, in rad and m."""
    return FOURTH * step**4 if plant == measure.PLANT else FIRST * step


def precision_runs(names: Iterable[str], kinds: Mapping[str, Run], outputs: Path) -> dict[str, Run]:
    """Return runs of the plan by name, and write the solutions from which they are off into an outputs folder.

    Args:
        names: Names of the runs.
        kinds: A run of each case and arm, by these.
        outputs: The folder in which the runs seem to lie.
    """
    made, cases = {}, {}
    for name in names:
        case, arm, plant, step = name.split("/")
        kind = kinds[f"{case}/{arm}"]
        trace = kind.trace().copy()
        for column in ("q1", "tip_x"):
            trace[column] += np.linspace(0.0, error(plant, float(step)), len(trace))
        made[name] = replace(kind)
        made[name].__dict__["_table"] = pyarrow.Table.from_pandas(trace, preserve_index=False)
    for base, exact in kinds.items():
        steps = [name.rpartition("/")[2] for name in made if name.startswith(f"{base}/{measure.PLANT}/")]
        errors = {step: error(measure.PLANT, float(step)) for step in steps}
        cases[base] = {
            "q": exact.trace().filter(regex=r"^q\d+$").to_numpy().tolist(),
            "tip": exact.trace()[["tip_x", "tip_y", "tip_z"]].to_numpy().tolist(),
            "apart": {"tolerance": 2e-15, "collocation": 1e-15},
            "energy": 1e-15 if base.startswith("free") else None,
            "compiled_seconds": {step: 1e-6 / float(step) for step in steps},
            "interpreted": {
                step: {"joints": off + OFF, "tip": off + OFF, "seconds": 1e-4 / float(step)}
                for step, off in errors.items()
            },
        }
    of = {name: run.hash for name, run in made.items() if f"/{measure.PLANT}/" in name}
    write_atomically(outputs / measure.FILE, sealed_json({"runs": of, "cases": cases}))
    return made
