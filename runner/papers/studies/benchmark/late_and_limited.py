"""Effects of delay and torque limits in the benchmark."""

import numpy as np

from runner.controllers.stability import delay_limit
from runner.papers.studies.benchmark.cells import UNTUNED, tuned
from runner.papers.studies.benchmark.figures import maps_of_laws, typical
from runner.papers.studies.benchmark.made import ARMS, CONDITIONS, arms_of
from runner.papers.study.measured import Measured
from runner.papers.study.results import Runs, matching_runs
from runner.papers.study.run_values import values
from runner.reporting.document import Maps

_LIMITED = {"limits_150": 1.5, "limits_110": 1.1, "limits_80": 0.8}


def bearable(ticks: int) -> Measured:
    """Return the natural frequency times the period at which feedback late by some ticks becomes unstable."""
    return Measured(f"stable with {ticks} ticks of delay", delay_limit(ticks))


def limits_over_need(runs: Runs) -> list[Measured]:
    """Return each joint's torque limit over the share that it is to be of what the motions need, on all arms."""
    ratios = []
    for arm in arms_of(runs):
        exact = [one.run for one in matching_runs(runs, f"first/{arm}/computed_torque/{{task}}/exact/{UNTUNED[0]}")]
        for condition, share in _LIMITED.items():
            limited = matching_runs(runs, f"first/{arm}/computed_torque/{{task}}/{condition}/{UNTUNED[0]}")[0].run
            for joint, limit in enumerate(limited.config["torque_limits"]["max"], start=1):
                words = f"limit over need, {ARMS[arm]}, {CONDITIONS[condition]}, joint {joint}"
                ratios.append(Measured(words, limit / (share * values(exact, f"peak_torque_q{joint}").max())))
    return ratios


def saturated(runs: Runs, caption: str) -> Maps:
    """Return the ticks with a joint at its torque limit, in per cent, as one map for each arm."""

    def share(arm: str, law: str, condition: str) -> tuple[float, bool]:
        own = [typical(runs, arm, law, condition, gains, "saturation_fraction") for gains in tuned(runs)]
        return 100.0 * float(np.mean(own)), False

    return maps_of_laws(runs, caption, "ticks at a limit (%)", share, _LIMITED)
