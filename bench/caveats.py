"""CPU time of the rules behind a run's caveats, against that of its metrics: at most a quarter.

Both look at the same trace in turns, a block of calls each; the quickest block of each is judged, as work next to it
only ever slows one.
"""

import time
from collections.abc import Callable

from runner.assembly.assemble import assemble
from runner.assembly.validation import validate
from runner.caveats.monitor import Watch
from runner.caveats.setting import setting_of, signals_of
from runner.config.compose.compose import compose
from runner.metrics.summary import evaluate
from runner.simulation.loop import simulate
from runner.simulation.results import metric_context
from runner.simulation.sensors import make_encoders, make_wrist_sensor

_BLOCKS, _CALLS = 30, 20
_TARGET = 0.25
_CASES = (
    ("robot=macro",),
    ("robot=macro", "trajectory=quintic", "noise=thesis", "torque_limits=thesis"),
    ("robot=xarm7",),
    ("robot=xarm7", "controller=computed_torque", "trajectory=quintic", "torque_limits.max=5"),
    ("robot=combined", "torque_limits=thesis"),
    ("robot=meca500",),
)


def main(rounds: int | None = None) -> bool:
    """Measure and print; return whether the target is met in every case.

    Args:
        rounds: Number of blocks of calls; None for _BLOCKS.
    """
    print("CPU time of metrics and of caveats, quickest block")
    met = [_judge(rounds or _BLOCKS, *overrides) for overrides in _CASES]
    return all(met)


def _judge(rounds: int, *overrides: str) -> bool:
    config = validate(compose(overrides))
    loop, context = assemble(config), metric_context(config)
    sensor = make_wrist_sensor(loop, config.wrist_sensor, 0, 0)
    trace = simulate(loop, make_encoders(loop, config.noise, 0, 0), sensor)
    loop.close()
    measured = evaluate(trace, context)
    watch = Watch(setting_of(config), config.caveats)
    of_metrics, of_caveats = _quickest(
        rounds, lambda: evaluate(trace, context), lambda: watch.look(signals_of(trace, measured))
    )
    share = of_caveats / of_metrics
    print(
        f"  {' '.join(overrides):90} {of_metrics * 1e6:6.0f} us, {of_caveats * 1e6:4.0f} us: {share:.2f}  target "
        f"{_TARGET:g}: {'met' if share <= _TARGET else 'MISSED'}"
    )
    return share <= _TARGET


def _quickest(rounds: int, *parts: Callable[[], object]) -> list[float]:
    """Return the CPU time of a call of each part, in s."""
    return [min(times) for times in zip(*([_block(part) for part in parts] for _ in range(rounds)), strict=True)]


def _block(part: Callable[[], object]) -> float:
    start = time.process_time()
    for _ in range(_CALLS):
        part()
    return (time.process_time() - start) / _CALLS
