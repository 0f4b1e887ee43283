"""Comparison of the cells that plain Hydra and the runner make of one line.

Plain Hydra is its own sweeper, which splits the line into jobs, and its own composition of each job. Both sides then
resolve the config in the same way, with the units and stages of the runner.
"""

from collections import Counter
from collections.abc import Sequence
from typing import Any

from hydra import compose as hydra_compose
from hydra import initialize_config_dir
from hydra._internal.core_plugins.basic_sweeper import BasicSweeper
from hydra.core.global_hydra import GlobalHydra
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.types import RunMode

from runner.base.errors import ConfigError
from runner.base.paths import conf_dir
from runner.config.compose.compose import from_hydra
from runner.config.compose.composer import Composer
from runner.config.compose.sources import VERSION_BASE, checked_sources
from runner.sweeps.typed import plan_typed
from tools.plain_hydra.lines import drawn, written
from tools.plain_hydra.meant import reason_for

OUTCOMES = ("same", "both refuse", "different", "runner refuses", "Hydra refuses")
_RANDOM = 1000
_COMPOSED = 3


def main() -> bool:
    """Compare all lines and print those that differ; return whether each difference is meant."""
    passed = True
    for name, lines in (("written", written()), ("random", drawn(_RANDOM, 1))):
        outcomes: Counter[str] = Counter()
        reasons: Counter[str] = Counter()
        for line in lines:
            outcome, difference = compare(line)
            reason = reason_for(line, outcome)
            outcomes[outcome] += 1
            if outcome not in OUTCOMES[:2]:
                reasons[reason or "NOT MEANT"] += 1
                if not reason:
                    passed = False
                    print(f"  NOT MEANT, {outcome}: {' '.join(line)}\n    {difference}")
        print(f"{name}: {len(lines)} lines: " + ", ".join(f"{outcomes[each]} {each}" for each in OUTCOMES))
        for reason, count in reasons.most_common():
            print(f"  {count:4}  {reason}")
    return passed


def compare(line: Sequence[str], composed: int = _COMPOSED) -> tuple[str, str]:
    """Return the outcome of a line, one of OUTCOMES, and the first difference or refusal.

    Args:
        line: The overrides.
        composed: Number of cells to compose, of the last, the middle and the first one; all cells are counted.
    """
    ours, theirs = _of_runner(line, composed), _of_hydra(line, composed)
    if isinstance(ours, str) or isinstance(theirs, str):
        refused = isinstance(ours, str), isinstance(theirs, str)
        outcome = {(True, True): "both refuse", (True, False): "runner refuses"}.get(refused, "Hydra refuses")
        return outcome, ours if isinstance(ours, str) else str(theirs)
    if ours[0] != theirs[0]:
        return "different", f"{ours[0]} cells, not {theirs[0]}"
    for number, (one, other) in enumerate(zip(ours[1], theirs[1], strict=True)):
        if repr(one) != repr(other):
            keys = [key for key in {**one, **other} if repr(one.get(key)) != repr(other.get(key))]
            return "different", f"composed cell {number}: {[(key, one.get(key), other.get(key)) for key in keys]}"[:500]
    return "same", ""


Cells = tuple[int, list[dict[str, Any]]]
"""Number of cells, and the configs of a few of them."""


def _few(count: int, composed: int) -> list[int]:
    return sorted({0, count // 2, count - 1} & {*range(count)})[-composed:]


def _of_runner(line: Sequence[str], composed: int) -> Cells | str:
    ours = [text.removeprefix("++") for text in line if not text.startswith("hydra.")]
    try:
        plan, _ = plan_typed(ours, Composer(), [text for text in line if text.startswith("hydra.")])
        return len(plan), [dict(plan.composed(cell).resolved) for cell in _few(len(plan), composed)]
    except ConfigError as error:
        return f"runner: {error}"


def _of_hydra(line: Sequence[str], composed: int) -> Cells | str:
    with checked_sources([]), initialize_config_dir(str(conf_dir()), job_name="runner", **VERSION_BASE):
        loader = GlobalHydra.instance().config_loader()
        try:
            params: list[str] = []
            if any(text.startswith(("experiment=", "hydra.")) for text in line):  # only these bring axes
                config = loader.load_configuration("config", list(line), RunMode.MULTIRUN, from_shell=False)
                params = [f"{key}={value}" for key, value in (config.hydra.sweeper.params or {}).items()]
            typed = [*params, *(text for text in line if not text.startswith("hydra."))]
            overrides = OverridesParser.create(config_loader=loader).parse_overrides(typed)
            (jobs,) = BasicSweeper.split_arguments(overrides, None)
            return len(jobs), [_composed(jobs[cell]) for cell in _few(len(jobs), composed)]
        except Exception as error:  # of Hydra, OmegaConf, the parser, or a crash of the sweeper
            return f"Hydra: {type(error).__name__}: {error}"


def _composed(job: list[str]) -> dict[str, Any]:
    config = hydra_compose("config", job, return_hydra_config=True)
    return dict(from_hydra(config, config.hydra.runtime.choices, job, ()).resolved)
