"""Job arrays of Slurm: each task simulates a part of a sweep; a script starts all tasks."""

import math
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from runner import store
from runner.base.errors import RunnerError
from runner.base.quantities import format_duration
from runner.base.sanitize import one_line
from runner.plugins.discovery import named_parts
from runner.store.kinds import note
from runner.sweeps.plan import Plan
from runner.sweeps.preview import Preview, preview
from runner.sweeps.run import Engine, write_sweep
from runner.sweeps.status import in_ranges, parts_of

_GUESS = 2.0  # time of another machine, relative to this one
_START = 60.0  # s, for the start of a task
_SCRIPT = """\
#!/bin/bash
# {cells} cells in {parts} parts; each task simulates one part.
# Progress: runner status {folder}
# Tasks to submit again: sbatch --array="$(runner status {folder} --parts {parts})" SCRIPT
# {about_time}
#SBATCH --array={array}
#SBATCH --cpus-per-task={cpus}
{time}#SBATCH --requeue
#SBATCH --open-mode=append
cd {here} || exit
{command} \\
    sweep.part="$SLURM_ARRAY_TASK_ID/{parts}" hydra.sweeper.workers="${{SLURM_CPUS_PER_TASK:-1}}"
"""


@dataclass(frozen=True)
class JobArray:
    """A job array that simulates what is missing of a sweep.

    Attributes:
        folder: Folder of the sweep.
        cells: Number of cells.
        tasks: Numbers of the parts that have missing cells.
        script: Script for `sbatch`.
    """

    folder: Path
    cells: int
    tasks: Sequence[int]
    script: str


def plan_job_array(plan: Plan, engine: Engine, parts: int, words: Sequence[str]) -> JobArray:
    """Check all cells of a plan, store its sweep without a run, and return its job array.

    The tasks find the names of all cells in the stored sweep.

    Args:
        plan: The plan.
        engine: Location of the execution of each task.
        parts: Number of parts.
        words: Overrides and options of the command, without sweep.part and hydra.sweeper.workers.

    Raises:
        ConfigError: if a cell cannot be run.
        RunnerError: if there are more parts than cells, or the command has a Dask scheduler.
        StoreError: if the sweep cannot be written.
    """
    if engine.address is not None:
        raise RunnerError("--slurm: tasks of an array use no Dask scheduler. Set hydra.sweeper.address=null.")
    if parts > len(plan):
        raise RunnerError(f"--slurm: more tasks than cells ({parts}). Allowed: 1 to {len(plan)}.")
    found = preview(plan, engine)
    plug_ins = [f"--plugin={plug_in}" for plug_in in named_parts()]
    command = shlex.join(["runner", *plug_ins, "-m", *words])
    outputs = found.checked.outputs
    store.prepare(outputs)
    folder = write_sweep(plan, found.checked, command)
    note(folder)
    tasks, cpus = parts_of(np.flatnonzero(~found.stored).tolist(), parts), max(1, engine.workers)
    about_time, time = _time(found, parts, cpus)
    script = _SCRIPT.format(
        cells=len(plan),
        parts=parts,
        folder=one_line(shlex.quote(str(folder.resolve()))),
        about_time=about_time,
        array=in_ranges(tasks),
        cpus=cpus,
        time=time,
        here=shlex.quote(str(Path.cwd())),
        command=command,
    )
    return JobArray(folder, len(plan), tasks, script)


def _time(found: Preview, parts: int, cpus: int) -> tuple[str, str]:
    """Return a sentence on the time limit of a task, and its line."""
    if found.expected is None:
        return "No time limit is set, because an estimate takes too long. Add --time.", ""
    costs = np.where(found.stored, 0, found.checked.costs)
    longest = max(float(costs[part::parts].sum()) / cpus for part in range(parts))
    seconds = found.expected.seconds * max(longest, float(costs.max())) / max(float(costs.sum()), 1.0)
    minutes = math.ceil((_GUESS * seconds + _START) / 60.0)
    here = f"{found.expected.known} {format_duration(seconds)}"
    sentence = f"The time limit is a guess: twice this machine's time for the longest task, {here}, and a minute."
    return sentence, f"#SBATCH --time={minutes // 60:02d}:{minutes % 60:02d}:00\n"
