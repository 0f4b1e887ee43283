"""Public function for reports, and the handle on a written report."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from runner.api import page
from runner.api.boundary import public
from runner.api.run import Run
from runner.api.sweep import Sweep
from runner.api.tuning import Tuning
from runner.base.errors import RunnerError
from runner.store.kinds import Kind, find_folder

Thing = Run | Sweep | Tuning | str | Path
_KINDS: Sequence[Kind] = ("run", "sweep", "tuning")


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
    """Write the report on runs, sweeps or a tuning, as `runner report` does.

        >>> made = runner.report(runner.run(robot="macro", duration=0.1), formats="html")
        >>> made.html.name
        'report.html'

    Args:
        things: Runs, sweeps or a tuning, or their folders; several sweeps are compared with each other.
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
