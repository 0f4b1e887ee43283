"""Simulate one run, or every combination of the listed values.

An override sets a key or chooses from a group. `runner sweep` is the same as `runner -m`.

Example: runner sweep robot=macro controller=computed_torque,joint_pd seed=0,1
"""

# Lines with flags of Hydra are read by Hydra's own command. It returns the overrides of a run or a sweep, which is then
# simulated as from a line without such flags.

import shlex
import sys
from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from runner.base.errors import RunnerError, unknown
from runner.base.paths import conf_dir
from runner.base.sanitize import one_line
from runner.cli.arguments import Parser, count
from runner.cli.detect import difference_share, print_needed
from runner.config.compose.files import outputs_dir, outputs_override, user_overrides
from runner.reporting.table import Table, numbers, terminal
from runner.store.kinds import WORD

if TYPE_CHECKING:
    from omegaconf import DictConfig

    from runner.config.composed import Composed
    from runner.store import Run
    from runner.store.axes import Axis
    from runner.sweeps.plan import Grid
    from runner.sweeps.run import Ended, Engine

_METRICS = 5
_PART = "sweep.part"
_OF_SWEEPS = [*(f"sweep.{name}" for name in ("trace", "retry", "on_failure", "attempts", "time_limit")), _PART]
_NAMES = (("robot", "name"), ("controller", "kind"), ("trajectory", "kind"))
_FAILURES_SHOWN = 20
_MOST_RANKED = 200  # cells; to read these takes half a second

# The part of conf/config.yaml about Hydra itself, which does not read that file for its own help.
_WITHOUT_OURS = (
    "hydra/sweeper=runner", "hydra/job_logging=none", "hydra/hydra_logging=none", "hydra.run.dir=.",
    "hydra.output_subdir=null",
)  # fmt: skip
_MANY, _OF_SWEEPER = ("-m", "--multirun"), "hydra.sweeper."
_SHOWN = ("job", "hydra", "all")


def add_arguments(parser: Parser) -> None:
    """Add the arguments, for help and completion; `simulate` takes the words as they are typed."""
    parser.add_overrides("such as robot=macro, or seed=0,1 in a sweep")
    parser.add_argument(*_MANY, action="store_true", help="simulate a sweep over every combination")
    _add_own(parser)
    parser.add_argument("-c", "--cfg", choices=_SHOWN, metavar="PART", help="print the config: job, hydra or all")
    parser.add_argument("--hydra-help", action="store_true", help="show all flags of Hydra")
    parser.add_argument("--version", action="store_true", help="show the version")


def _add_own(parser: Parser) -> None:
    parser.add_shared(
        "config_dir",
        output="outputs folder (default: outputs)",
        jobs="number of processes of a sweep (default: 2)",
        json="with --dry-run: print all cells as JSON",
    )
    parser.add_argument("--dry-run", action="store_true", help="print cells and expected time; simulate nothing")
    parser.add_argument("--slurm", type=count, metavar="N", help="print the script of a job array of N tasks")
    parser.add_argument(
        "--detect", type=difference_share, metavar="SIZE", help="count the repetitions that show SIZE, such as 10%%"
    )


def run(arguments: Namespace) -> int:
    """Simulate the run or the sweep of a parsed line."""
    return simulate(arguments.words)


def simulate(words: Sequence[str]) -> int:
    """Simulate the run or the sweep of a line; print the folder as the last line."""
    own = Parser(prog="runner run", add_help=False)
    _add_own(own)
    given, others = own.parse_known_args(_join_flags(words))
    typed = shlex.join(["runner", *words])
    for shown in (word.partition("=")[2] for word in others if word.partition("=")[0] == "--cfg"):
        if shown not in _SHOWN:
            raise RunnerError(unknown("name", shown, _SHOWN, "--cfg"))
        if any(word in _MANY for word in others):
            raise RunnerError("--cfg: prints the config of one run. Leave out -m, and give each key one value.")
    words_of_task = [*(f"--config-dir={folder}" for folder in given.config_dir), *others]
    if given.output is not None:
        words_of_task.append(f"--output={given.output}")
        others.append(outputs_override(given.output))
    if given.jobs is not None:
        if not any(word in _MANY for word in others):
            raise RunnerError("--jobs: one run uses one process. Add -m for a sweep.")
        others.append(f"hydra.sweeper.workers={given.jobs}")
    if given.slurm and not any(word in _MANY for word in others):
        raise RunnerError("--slurm: one run needs no job array. Add -m for a sweep.")
    if given.detect and not any(word in _MANY for word in others):
        raise RunnerError("--detect: one run compares nothing. Add -m for a sweep.")
    if given.detect and (given.slurm or given.dry_run):
        raise RunnerError("--detect: simulates a pilot, the other option nothing. Leave out one of them.")
    if given.slurm and given.dry_run:
        raise RunnerError("--slurm: simulates nothing, as --dry-run. Leave out one of them.")
    if given.json and not given.dry_run:
        raise RunnerError("--json: prints the cells of a preview. Add --dry-run.")
    line, overrides = _read_line(others, given.config_dir)
    if line.overrides is None:
        return 0  # --cfg, --hydra-help and the like
    if given.dry_run:
        return _preview(line, overrides, given.config_dir, given.json)
    if given.detect:
        return _count_repetitions(line, overrides, given.config_dir, given.detect)
    if given.slurm:
        return _print_job_array(line, overrides, given.config_dir, words_of_task, given.slurm)
    return _simulate(line, overrides, given.config_dir, typed)


def _join_flags(words: Sequence[str]) -> list[str]:
    """Return a line in which Hydra's flags of the config are one word with their value, such as --cfg=job.

    argparse would complete -c to -cd, and read the value of --package as an override.
    """
    joined: list[str] = []
    for word in words:
        if joined and joined[-1] in ("--cfg", "--package") and not word.startswith("-"):
            joined[-1] += f"={word}"
        else:
            joined.append({"-c": "--cfg", "-p": "--package"}.get(word, word))
    return joined


class _Line:
    """Overrides of a line, as typed or as Hydra passes them to its task or sweeper; None if it simulates nothing."""

    def __init__(self, overrides: Sequence[str] | None = None, many: bool = False) -> None:
        self.overrides, self.many, self.root = overrides, many, "config"

    def __call__(self, _: "DictConfig") -> None:
        """Store the overrides of a run; called by Hydra."""
        from hydra.core.hydra_config import HydraConfig

        self._take(HydraConfig.get())

    def sweep(self, config: "DictConfig") -> None:
        """Store the overrides of a sweep; called by the sweeper."""
        self.many = True
        self._take(config.hydra)

    def _take(self, node: Any) -> None:
        from omegaconf import OmegaConf

        # Unresolved, because an override may contain an interpolation.
        found: Any = OmegaConf.to_container(node.overrides, resolve=False)
        of_sweeper = [each for each in found["hydra"] if each.startswith(_OF_SWEEPER)]
        self.overrides, self.root = [*found["task"], *of_sweeper], node.job.config_name


def _read_line(words: Sequence[str], config_dirs: Sequence[Path]) -> tuple[_Line, list[str]]:
    """Return a line, and its overrides without the prefix ++."""
    if any(word.startswith("-") and word not in _MANY for word in words):
        line = _read_by_hydra(words, config_dirs)
    else:
        line = _Line([word for word in words if word not in _MANY], any(word in _MANY for word in words))
    return line, [each.removeprefix("++") for each in line.overrides or ()]


def _split(overrides: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return the overrides of the config, and those of the sweeper."""
    ours = [each for each in overrides if not each.startswith(_OF_SWEEPER)]
    return ours, [each for each in overrides if each.startswith(_OF_SWEEPER)]


def _simulate(line: _Line, overrides: Sequence[str], config_dirs: Sequence[Path], command: str) -> int:
    """Simulate the run or the sweep of a line; print its folder as the last line."""
    if line.many:
        from runner.config.compose.composer import Composer
        from runner.sweeps.run import sweep_typed

        return print_sweep(sweep_typed(*_split(overrides), Composer(config_dirs, line.root), command))
    from runner.config.compose.compose import compose

    composed = compose(overrides, config_dirs, line.root)
    from runner.assembly.validation import validate  # after the composition, so that errors are reported at once

    config = validate(composed)
    from runner.sweeps.job import RunJob, perform  # after validation, for the same reason

    run, made = perform(RunJob(config))
    _warn_of_one_run(composed)
    return print_run(run, made, composed.resolved.get("caveats"))


def _warn_of_one_run(composed: "Composed") -> None:
    """Print a line for each key of sweeps that the command line or an experiment sets for a single run."""
    from runner.config.compose.given_keys import given_keys, swept_keys

    found = [f"{key}: no effect, because one run is made; add -m" for key in given_keys(composed) if key in _OF_SWEEPS]
    if swept := swept_keys(composed):
        name = next(text for text in reversed(composed.overrides) if text.startswith("experiment="))
        found.append(f"{name}: {', '.join(swept)} not swept, because one run is made; add -m")
    for text in found:
        print(one_line(f"runner: warning: {text}"), file=sys.stderr)


def _preview(line: _Line, overrides: Sequence[str], config_dirs: Sequence[Path], as_json: bool) -> int:
    """Print what the line would simulate."""
    from runner.cli.preview import print_preview
    from runner.sweeps.part import own_part
    from runner.sweeps.preview import preview

    grid, engine = _plan(line, overrides, config_dirs)
    if not line.many:
        _warn_of_one_run(grid.composed(0))
    plan = own_part(grid)
    print_preview(plan, preview(plan, engine), as_json)
    return 0


def _count_repetitions(line: _Line, overrides: Sequence[str], config_dirs: Sequence[Path], share: float) -> int:
    """Print the repetitions of the line's sweep that show a difference."""
    from runner.config.compose.composer import Composer

    return print_needed(*_split(overrides), Composer(config_dirs, line.root), share)


def _plan(line: _Line, overrides: Sequence[str], config_dirs: Sequence[Path]) -> "tuple[Grid, Engine]":
    """Return the cells of a line, and the location of their execution."""
    from runner.config.compose.composer import Composer
    from runner.sweeps.plan import Grid
    from runner.sweeps.run import Engine
    from runner.sweeps.typed import plan_typed

    composer = Composer(config_dirs, line.root)
    ours, of_sweeper = _split(overrides)
    if line.many:
        grid, sweeper = plan_typed(ours, composer, of_sweeper)
        return grid, Engine(sweeper.workers, sweeper.address)
    composer.load(overrides)  # rejects several values
    return Grid(ours, composer), Engine(0, None)


def _print_job_array(
    line: _Line, overrides: Sequence[str], config_dirs: Sequence[Path], words: Sequence[str], parts: int
) -> int:
    """Print the script of a job array for the line, given also by its words."""
    from runner.sweeps.slurm import plan_job_array

    keys = [word.lstrip("+").partition("=")[0] for word in words]
    if _PART in keys:
        raise RunnerError(f"{_PART}: --slurm sets it in each task. Leave it out.")
    kept = [word for word, key in zip(words, keys, strict=True) if key not in (*_MANY, f"{_OF_SWEEPER}workers")]
    array = plan_job_array(*_plan(line, overrides, config_dirs), parts, kept)
    if array.tasks:
        print(array.script, end="")
        text = f"{len(array.tasks)} of {parts} tasks have missing cells; submit the script with `sbatch`"
    else:
        text = f"all {array.cells} cells are stored; no task is left"
    print(one_line(f"runner: {text}; progress: `runner status {array.folder}`"), file=sys.stderr)
    return 0


def _read_by_hydra(words: Sequence[str], config_dirs: Sequence[Path]) -> _Line:
    """Return the overrides of a line with flags of Hydra, read by Hydra's command after a check of the config."""
    from hydra import version
    from hydra._internal.utils import _run_hydra
    from hydra.types import RunMode

    from runner.cli.hydra_parser import hydra_parser
    from runner.config.compose.composer import Composer
    from runner.config.compose.composition_errors import COMPOSITION_ERRORS, explain
    from runner.config.compose.overrides import force
    from runner.config.compose.sources import VERSION_BASE, checked_sources

    line = _Line()
    sys.argv = ["runner", *user_overrides(), *force(words), *(_WITHOUT_OURS if "--hydra-help" in words else ())]
    parser = hydra_parser()
    given, others = parser.parse_known_args()
    if others:
        own = Parser(prog="runner run", add_help=False)
        add_arguments(own)
        own.reject(others)
    try:
        if not given.hydra_help:
            mode = RunMode.MULTIRUN if given.multirun else RunMode.RUN
            root = given.config_name or "config"
            Composer(config_dirs, root).load(given.overrides, mode=mode)  # checks what Hydra does not
        with checked_sources([folder.resolve() for folder in config_dirs]):
            # The absolute path works from a console script and from a wheel, where a relative one does not.
            for base in VERSION_BASE.values():
                version.setbase(base)
            _run_hydra(given, parser, line, config_path=str(conf_dir()), config_name="config")
    except COMPOSITION_ERRORS as error:
        raise explain(error, config_dirs) from None
    return line


def print_run(run: "Run", made: bool, thresholds: Any) -> int:
    """Print the summary of a run; return its exit code.

    Args:
        run: The run.
        made: Whether this command simulated it.
        thresholds: Thresholds of the caveats in the command's config.
    """
    if not run.failure:
        _print_metrics(run, made)
    _print_spec(run)
    for warning in run.provenance["warnings"]:
        print(one_line(f"runner: warning: {warning}"), file=sys.stderr)
    _print_caveats(run, thresholds)
    if run.failure:
        print(one_line(f"runner: {run.failure}"), file=sys.stderr)
    print(run.folder)
    return 1 if run.failure else 0


def _print_metrics(run: "Run", made: bool) -> None:
    """Print the names of a run's parts, its folder, and its main metrics."""
    from runner.reporting.metric_titles import key_metrics

    config, count = run.config, run.record["repetitions"]
    what = ", ".join(str(config[group][key]) for group, key in _NAMES)
    where = f"{'stored' if made else 'stored before'} in {run.folder}"
    repetitions = "1 repetition" if count == 1 else f"{count} repetitions"
    print(one_line(f"runner: {what}: {repetitions}, {where}"), file=sys.stderr)
    rows = key_metrics(run, _METRICS)
    if rows:
        print(terminal(Table("", ["", *numbers(""), ""], rows)), file=sys.stderr)


def _print_spec(run: "Run") -> None:
    """Print the fraction of repetitions that pass each bound of a run's spec, if it has one."""
    if run.spec is None:
        return
    from runner.reporting.spec_blocks import COLUMNS, lacking_text, spec_rows

    print(terminal(Table("", COLUMNS, spec_rows(run.spec, run))), file=sys.stderr)
    lacking = lacking_text(run.spec, run.metrics)
    if lacking:
        print(one_line(f"runner: {lacking}"), file=sys.stderr)


def _print_caveats(run: "Run", thresholds: Any) -> None:
    """Print the caveats of a run, and the thresholds that differ from those of the command's config."""
    from runner.sweeps.changes import changed_rules

    for caveat in run.caveats:
        print(one_line(f"runner: caveat: {caveat['rule']}: {caveat['text']}"), file=sys.stderr)
    changes = changed_rules(run, thresholds)
    if changes:
        print(one_line(f"runner: stored before; its caveats were looked for by {'; '.join(changes)}"), file=sys.stderr)


def print_sweep(ended: "Ended") -> int:
    """Print the summary of a sweep; return its exit code."""
    from runner.store import open_sweep
    from runner.store.axes import axes_of
    from runner.sweeps.differing import in_words

    if ended.failures:
        rows = [[" ".join(overrides), why, str(where)] for overrides, why, where in ended.failures[:_FAILURES_SHOWN]]
        count = len(ended.failures)
        print(f"runner: {count} run{'s' if count > 1 else ''} failed", file=sys.stderr)
        print(terminal(Table("", ["run", "why", "more in"], rows)), file=sys.stderr)
        if len(ended.failures) > len(rows):
            print(f"  and {len(ended.failures) - len(rows)} more", file=sys.stderr)
    counts = ended.ends.caveats
    if counts.any():
        text = f"{(counts > 0).sum()} of {len(counts)} cells have caveats, {counts.max()} at most"
        print(f"runner: {text}; `runner table {ended.folder}` says which", file=sys.stderr)
    if ended.left:
        print(f"runner: stopped at a failure; left: {ended.left}", file=sys.stderr)
    axes, _ = axes_of(open_sweep(ended.folder).overrides)
    also = in_words(ended.resolved.differences(axes))
    if also:
        print(one_line(f"runner: {also}; the report lists their values"), file=sys.stderr)
    _print_cells(ended, axes)
    print(ended.folder)
    return 1 if ended.failures else 0


def _print_cells(ended: "Ended", axes: "Sequence[Axis]") -> None:
    """Print the numbers of runs, the answer of the sweep, and the next commands."""
    from runner import store
    from runner.base.machine import describe_mixture
    from runner.reporting.challenge.beside import scope_line
    from runner.reporting.sweep.question import find_answers, in_short
    from runner.reporting.sweep.subject import choose
    from runner.sweeps.finer_step import work_out_sweep
    from runner.sweeps.measurements import measure_sweep
    from runner.sweeps.question import SEED, find_question

    made, failed = len(ended.ends) - ended.stored, len(ended.failures)
    runs = "1 run" if len(ended.ends) == 1 else f"{len(ended.ends)} runs"
    if ended.part:
        runs = f"part {ended.part}: {runs}"
    text = f"{runs}: {made} made, {ended.stored} stored before, {failed or 'none'} of them failed"
    answer, scope, spec = "", "", ""
    if len(ended.names) <= _MOST_RANKED and not (ended.part or ended.left or failed == len(ended.names)):
        sweep = store.open_sweep(ended.folder)
        work_out_sweep(sweep)
        subject = choose(measure_sweep(sweep))
        answer, scope = in_short(subject), scope_line(find_answers(subject), [ended.folder], [_name(ended)])
        if sweep.spec:
            from runner.reporting.sweep.spec import summary  # imports charts, which takes long

            spec = summary(subject, sweep)
    for line in filter(None, (text, describe_mixture(ended.ends.machines), answer, scope, spec)):
        print(one_line(f"runner: {line}"), file=sys.stderr)
    name = _name(ended)
    if ended.part:
        print(one_line(f"runner: next: `runner status {name}`"), file=sys.stderr)
        return
    swept = [axis.name for axis in axes if axis.name != SEED]
    by = "" if find_question(axes) else f" --by {swept[0]}" if swept else None
    compare = "" if by is None else f", `runner compare {name}{by}`"
    print(one_line(f"runner: next: `runner report {name}`, `runner table {name}`{compare}"), file=sys.stderr)


def _name(ended: "Ended") -> str:
    """Return the name of a sweep for a next command: its folder, or `latest` in the usual outputs folder."""
    return WORD if ended.outputs.resolve() == outputs_dir().resolve() else str(ended.folder)
