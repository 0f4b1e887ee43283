"""Count of the repetitions that a sweep needs, printed by `--detect`: a pilot is simulated, not the sweep."""

import argparse
import shlex
import sys
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from runner.base.errors import ConfigError, RunnerError
from runner.base.sanitize import one_line
from runner.cli.arguments import read_per_cent

if TYPE_CHECKING:
    from runner.config.compose.composer import Composer
    from runner.reporting.sweep.detect import Needed
    from runner.sweeps.plan import Grid

_REPETITIONS = "repetitions"
_SET = (_REPETITIONS, "sweep.part")  # keys that the count sets, or that leave cells out


def difference_share(text: str) -> float:
    """Return the share of a text such as "10%"."""
    from runner.statistics.conclusion import SHARE  # NumPy, without which words are completed

    share = read_per_cent(text)
    if share is None or not SHARE < share <= 1.0:
        raise argparse.ArgumentTypeError(
            f"not a difference that can be shown ('{text}'). Allowed: above {100 * SHARE:g}% up to 100%, such as 10%."
        )
    return share


def print_needed(overrides: Sequence[str], of_sweeper: Sequence[str], source: "Composer", share: float) -> int:
    """Simulate the pilot of a sweep, and print the repetitions that show a difference, with their expected time.

    Args:
        overrides: Overrides of the config as typed.
        of_sweeper: Overrides of hydra.sweeper.
        source: Composer of the configs.
        share: The difference, as a share of the larger median.
    """
    from runner import store
    from runner.reporting.sweep.detect import PILOT, count_differences, count_failures, needed_table
    from runner.reporting.sweep.subject import choose
    from runner.reporting.table import terminal
    from runner.sweeps.finer_step import work_out_sweep
    from runner.sweeps.measurements import measure_sweep
    from runner.sweeps.run import Engine, run_sweep
    from runner.sweeps.typed import plan_typed

    for key in (text.lstrip("+").partition("=")[0] for text in overrides):
        if key in _SET:
            raise RunnerError(f"{key}: not with --detect, which counts repetitions of the whole sweep. Leave it out.")
    own = [*overrides, f"{_REPETITIONS}={PILOT}"]
    plan, sweeper = plan_typed(own, source, of_sweeper)
    _check_question(plan)
    print(f"runner: pilot of {PILOT} repetitions", file=sys.stderr)
    command = shlex.join(["runner", "-m", *own])
    ended = run_sweep(plan, Engine(sweeper.workers, sweeper.address), command)
    sweep = store.open_sweep(ended.folder)
    work_out_sweep(sweep)
    subject = choose(measure_sweep(sweep))
    found = [*count_differences(subject, share), *count_failures(subject, sweep.spec, share)]
    if not found:
        raise RunnerError(f"--detect: no two cells of the pilot are compared ({ended.folder}). See `runner table`.")
    failing = f", or a probability of failing other than {100 * share:g} %" if sweep.spec else ""
    print(f"To show {100 * share:g} % of the larger median with a probability of 80 %{failing}:")
    print(terminal(needed_table(found)))
    for text in _costs(found, overrides, of_sweeper, source):
        print(one_line(text))
    if ended.failures:
        print(f"runner: {len(ended.failures)} runs of the pilot failed", file=sys.stderr)
    print(ended.folder)
    return 1 if ended.failures else 0


def _check_question(plan: "Grid") -> None:
    """Check that the cells of a plan are compared, or have a bound.

    Raises:
        RunnerError: if they neither differ in a choice nor have a spec.
    """
    from runner.base.dotted_keys import get
    from runner.store.axes import SweepAxis
    from runner.sweeps.question import is_condition

    keys = [entry.key for entry in plan.axes().entries if isinstance(entry, SweepAxis)]
    if all(map(is_condition, keys)) and not get(plan.composed(0).resolved, "spec.metrics"):
        raise RunnerError(
            f"--detect: no question, because only conditions are swept ({', '.join(keys) or 'none'}). Allowed: several "
            "values of another key, as controller=A,B, or a bound, as spec.metrics.peak_torque.max=80."
        )


def _costs(
    found: Sequence["Needed"], overrides: Sequence[str], of_sweeper: Sequence[str], source: "Composer"
) -> Iterator[str]:
    """Yield the repetitions that the first row needs, and that all rows need, with the expected time."""
    first = next((one.repetitions for one in found), None)
    most = max((one.repetitions for one in found if one.repetitions), default=None)
    if first is not None:
        yield f"{found[0].name}: repetitions={first}, {_duration(first, overrides, of_sweeper, source)}"
    if most is not None and most != first:
        yield f"all rows with a number: repetitions={most}, {_duration(most, overrides, of_sweeper, source)}"


def _duration(count: int, overrides: Sequence[str], of_sweeper: Sequence[str], source: "Composer") -> str:
    """Return the expected duration of the sweep with a number of repetitions, in words."""
    from runner.sweeps.preview import preview
    from runner.sweeps.run import Engine
    from runner.sweeps.typed import plan_typed

    plan, sweeper = plan_typed([*overrides, f"{_REPETITIONS}={count}"], source, of_sweeper)
    try:
        return preview(plan, Engine(sweeper.workers, sweeper.address)).duration or "stored already"
    except ConfigError as error:
        return f"too many for this machine: {error.problems[0]}"
