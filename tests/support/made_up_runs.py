"""Stored runs that were never simulated, from what a test names."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow

from runner.papers.study.results import Parts, Results
from runner.store import Run

FAILURE = {"reason": "diverged", "time": 0.5, "joint": None, "repetition": 0}


def made_up_metric(*values: float, unit: str = "m") -> dict[str, Any]:
    """Return a metric as stored, from its values in the repetitions."""
    return {"unit": unit, "median": float(np.median(values)), "min": min(values), "max": max(values), "values": values}


def made_up_run(
    metrics: Mapping[str, Mapping[str, Any]] | None = None,
    trace: Mapping[str, Any] | None = None,
    config: Mapping[str, Any] | None = None,
    *,
    failed: bool = False,
    caveats: Sequence[Mapping[str, Any]] = (),
    **provenance: Any,
) -> Run:
    """Return a run with these contents; a failed one diverged at 0.5 s."""
    record = {
        "status": "failed" if failed else "ok",
        "repetitions": max((len(metric["values"]) for metric in (metrics or {}).values()), default=1),
        "metrics": metrics or {},
        "failure": FAILURE if failed else None,
        "caveats": caveats,
        "provenance": {"commit": "", "command": "runner", **provenance},
    }
    run = Run(Path("run"), config or {}, record)
    run.__dict__["_table"] = pyarrow.Table.from_pandas(pd.DataFrame(trace or {}, dtype=float), preserve_index=False)
    return run


def planned(pattern: str, runs: Mapping[str, Any], missing: Mapping[str, str] | None = None) -> Results[Any]:
    """Return runs as a plan names them, whose axes are those in braces in a pattern with as many parts as a name."""
    axes = [word[1:-1] if word.startswith("{") else "" for word in pattern.split("/")]

    def parts(name: str) -> Parts:
        texts = name.split("/")
        return tuple(zip(axes if len(texts) == len(axes) else [""] * len(texts), texts, strict=True))

    return Results(runs, missing, parts={name: parts(name) for name in (*runs, *(missing or ()))})
