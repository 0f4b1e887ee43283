"""`python -m tools.processors.bits < RUNS`: make runs in this process, and print what they give, with all bits.

RUNS is a JSON object of lists of overrides by name. The output has for each run its metrics by name, over the
repetitions, the digest of its trace, and its failure.
"""

import hashlib
import json
import math
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from runner.base.engines import quiet_environment

quiet_environment()

from runner.assembly.validation import validate  # noqa: E402
from runner.config.compose.compose import compose  # noqa: E402 - after the environment
from runner.simulation.run import measure_rounding, simulate_run  # noqa: E402
from tools.processors.kernels import environment, use_llvm_cpu  # noqa: E402

Bits = Mapping[str, Mapping[str, Any]]


def make(runs: Mapping[str, Sequence[str]]) -> Bits:
    """Return the bits of runs in this process."""
    return {name: _bits(overrides) for name, overrides in runs.items()}


def make_under(kernel: str | None, runs: Mapping[str, Sequence[str]]) -> Bits:
    """Return the bits of runs in another process, under a kernel, or under the machine's own for None."""
    added = {} if kernel is None else environment(kernel)
    made = subprocess.run(
        [sys.executable, "-m", __name__],
        input=json.dumps(runs),
        stdout=subprocess.PIPE,
        text=True,
        check=True,
        env={**os.environ, **added},
        cwd=Path(__file__).parents[2],
    )
    found: Bits = json.loads(made.stdout)
    return found


def growth(overrides: Sequence[str]) -> list[float]:
    """Return the largest relative change of a metric from a moved start, for two draws of its signs."""
    config = validate(compose(list(overrides)))
    return [measure_rounding(config, draw=draw).largest for draw in range(2)]


def _bits(overrides: Sequence[str]) -> dict[str, Any]:
    result = simulate_run(validate(compose(list(overrides))))
    trace, failure = result.trace, result.failure
    signals = (trace.q, trace.dq, trace.tau, trace.end_points, trace.desired)
    return {
        "metrics": {
            name: [None if math.isnan(value) else value for value in summary.values.tolist()]
            for name, summary in result.metrics.items()
        },
        "trace": hashlib.sha256(b"".join(signal.tobytes() for signal in signals)).hexdigest(),
        "failure": None if failure is None else [failure[0], failure[1].reason, failure[1].time],
    }


if __name__ == "__main__":
    use_llvm_cpu()
    print(json.dumps(make(json.load(sys.stdin))))
