"""Public functions on stored results: open, compare and report; and the handle on a written report."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from runner import store
from runner.api import page
from runner.api.boundary import public, public_class
from runner.api.challenge import Challenge
from runner.api.identification import Identification
from runner.api.run import Run
from runner.api.sweep import Sweep
from runner.api.tuning import Tuning
from runner.base.errors import RunnerError
from runner.store.kinds import Kind, find_folder
from runner.sweeps.tuning import study

if TYPE_CHECKING:
    from runner.api.comparison import Comparison

Comparable = Run | Sweep | str | Path
Thing = Run | Sweep | Tuning | Challenge | Identification | str | Path
_KINDS: Sequence[Kind] = ("run", "sweep", "tuning", "challenge", "identification")


@public
def open_run(folder: str | Path) -> Run:
    """Open a stored run.

        >>> made = runner.run(robot="macro", duration=0.1)
        >>> runner.open_run(made.folder).status
        'ok'

    Args:
        folder: Folder of the run, such as "outputs/runs/0871075a1b2c3d4e5f607182"; "latest" for the run that was
            simulated or reused last.

    Raises:
        RunnerError: if the folder is not a run, or the run is unfinished or damaged.
    """
    return public_class(Run, store.open_run(find_folder(folder, ("run",))))


@public
def open_sweep(folder: str | Path) -> Sweep:
    """Open a stored sweep, still running or ended.

    Args:
        folder: Folder of the sweep in `outputs/sweeps`; "latest" for the one simulated or reused last.

    Raises:
        RunnerError: if the folder is not a sweep, or is damaged.
    """
    return public_class(Sweep, store.open_sweep(find_folder(folder, ("sweep", "tuning"))))


@public
def open_tuning(folder: str | Path) -> Tuning:
    """Open a stored tuning.

        >>> made = runner.tune(robot="macro", trajectory="quintic", duration=0.1, workers=0, trials=2,
        ...                    controller__natural_frequency=(5, 50), minimize="max_tracking_error")
        >>> len(runner.open_tuning(made.folder).to_frame())
        2

    Args:
        folder: Folder of the tuning in `outputs/tunings`; "latest" for the one simulated or reused last.

    Raises:
        RunnerError: if the folder is not a tuning, or is damaged.
    """
    return public_class(Tuning, study.open_tuning(find_folder(folder, ("tuning",))))


@public
def open_challenge(folder: str | Path) -> Challenge:
    """Open a stored challenge.

    Args:
        folder: Folder of the challenge in `outputs/challenges`; "latest" for the one simulated or reused last.

    Raises:
        RunnerError: if the folder is not a challenge, or is damaged.
    """
    from runner.sweeps.challenge import stored

    return public_class(Challenge, stored.open_challenge(find_folder(folder, ("challenge",))))


@public
def open_identification(folder: str | Path) -> Identification:
    """Open a stored identification.

    Args:
        folder: Folder of the identification in `outputs/identifications`; "latest" for the one that was made last.

    Raises:
        RunnerError: if the folder is not an identification, or is damaged.
    """
    from runner.identification import result

    return public_class(Identification, result.open_identification(find_folder(folder, ("identification",))))


@public
def compare(
    first: Comparable, second: Comparable, *others: Comparable, metrics: str | Sequence[str] = ()
) -> "Comparison":
    """Compare runs or sweeps with the first of them, and return the statistics that `runner compare` prints.

    Repetitions with equal seeds are compared in pairs. Sweeps are compared in the cells that both have. The columns are
    those of `Sweep.compare`, with A for the first argument, B for the second and so on; `summary` has the answers in
    words.

        >>> common = ("robot=macro", "noise=thesis", "duration=0.1", "repetitions=6")
        >>> runs = [runner.run(*common, controller__damping_ratio=ratio) for ratio in (1.0, 0.7)]
        >>> runner.compare(*runs, metrics="peak_torque")[["first", "second", "metric", "n"]].values.tolist()
        [['A', 'B', 'peak_torque', 6]]

    Args:
        first: A run or a sweep, or its folder.
        second: Another run or sweep, of the same kind.
        others: More runs or sweeps of that kind.
        metrics: Names of metrics; empty for all shared metrics.

    Raises:
        RunnerError: if runs and sweeps are mixed, if two share no seed, cell or metric, or if one is damaged.
    """
    from runner.api.comparison import comparison
    from runner.reporting.comparison.sweeps import compare_sweeps, measure_compared

    things = [thing if isinstance(thing, Run | Sweep) else store.open_stored(find_folder(thing, ("run", "sweep")))
              for thing in (first, second, *others)]  # fmt: skip
    runs = [thing for thing in things if isinstance(thing, store.Run)]
    sweeps = [thing for thing in things if isinstance(thing, store.Sweep)]
    if runs and sweeps:
        raise RunnerError("runs and sweeps cannot be compared with each other; give only runs or only sweeps")
    one, *rest = sides = measure_compared(runs or sweeps)
    if damage := [text for side in sides for text in side.damage]:
        raise RunnerError("; ".join(damage))
    names = [metrics] if isinstance(metrics, str) else metrics
    groups = [compare_sweeps(one, side, names).answers for side in rest]
    return comparison([answer for group in groups for answer in group], [each.folder for each in things], groups)


@dataclass(frozen=True, repr=False)
class Report:
    """A written report.

    Attributes:
        folder: Folder of the report.
        html: HTML page, one file that needs no network; None if not requested.
        pdf: PDF file; None if not requested.
    """

    folder: Path
    html: Path | None
    pdf: Path | None

    def __repr__(self) -> str:
        return "\n  ".join(["Report", *self._files()])

    def _repr_html_(self) -> str:
        return page.heading("Report") + page.listed("Open in a browser or viewer:", self._files())

    def _files(self) -> list[str]:
        return [str(path) for path in (self.html, self.pdf) if path is not None]


@public
def report(
    things: Thing | Sequence[Thing], formats: str | Sequence[str] = ("html", "pdf"), metrics: str | Sequence[str] = ()
) -> Report:
    """Write the report on runs, sweeps, a tuning, a challenge or an identification, as `runner report` does.

        >>> made = runner.report(runner.run(robot="macro", duration=0.1), formats="html")
        >>> made.html.name
        'report.html'

    Args:
        things: Runs, sweeps, a tuning, a challenge or an identification, or their folders; several sweeps are compared
            with each other.
        formats: "html", "pdf" or both.
        metrics: Metrics for the comparison in a sweep; the first one ranks it. If empty, the report chooses them.

    Raises:
        RunnerError: if a folder contains none of these, or a metric or format is unknown.
    """
    from runner.reporting.stored import write

    given = [things] if isinstance(things, Thing) else list(things)
    if not given:
        raise RunnerError("nothing to report on; give a run, a sweep, a tuning or a folder of one")
    folders = [find_folder(each, _KINDS) if isinstance(each, str | Path) else each.folder for each in given]
    wanted = [formats] if isinstance(formats, str) else list(formats)
    folder = write(folders, [metrics] if isinstance(metrics, str) else metrics, wanted or ["html", "pdf"])
    html, pdf = (folder / f"report.{name}" if name in wanted else None for name in ("html", "pdf"))
    return Report(folder, html, pdf)
