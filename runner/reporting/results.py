"""Stored results as rows with their answers, and as one offline page to search, open and compare them."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path

from runner.base import progress
from runner.base.atomic import write_atomically
from runner.base.errors import RunnerError, StoreError
from runner.base.quantities import with_powers
from runner.base.sanitize import one_line
from runner.reporting.challenge.words import challenge_answer
from runner.reporting.figures import still_motion
from runner.reporting.metric_titles import key_metrics
from runner.reporting.render import asset, data_uri, script_policy
from runner.reporting.stored import report_name
from runner.reporting.sweep.question import in_short
from runner.reporting.sweep.subject import choose, shorten
from runner.reporting.sweep.tuning import summary_of_tuning
from runner.reporting.templating import html_environment
from runner.store import Calibration, Run, Sweep, open_stored
from runner.store.kinds import KINDS
from runner.store.listing import ListedResult, list_entries, runs_of_sweeps
from runner.store.run import open_run
from runner.store.seal import SchemaError
from runner.sweeps.challenge.stored import open_challenge
from runner.sweeps.measurements import measure_sweep
from runner.sweeps.status import find_status
from runner.sweeps.tuning.study import open_tuning

_MOST_CELLS = 1000  # of a sweep whose answer is computed
_MOST_THUMBNAILS = 24  # of the newest results
_LONGEST = 100
# Errors of a file whose digest is right and whose content is not, as an edited or forged one has.
_MISFITS = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)
_UNITS = ("B", "kB", "MB", "GB", "TB")


@dataclass(frozen=True)
class Row:
    """Summary of a stored result.

    Attributes:
        entry: The result.
        what: Its overrides.
        answer: Its answer in a sentence; empty if it has none.
        runs: Number of runs, or trials, times repetitions, such as "6 x 8".
        caveats: Number of runs with caveats.
        failed: Number of failed runs, or trials.
        state: "good", "unfinished", "other version" or "damaged".
    """

    entry: ListedResult
    what: str
    answer: str = ""
    runs: str = ""
    caveats: int = 0
    failed: int = 0
    state: str = "good"

    @property
    def when(self) -> str:
        """Date and time at which it was written."""
        return datetime.fromtimestamp(self.entry.written).astimezone().strftime("%Y-%m-%d %H:%M")

    @property
    def size(self) -> str:
        """Size in a fitting unit."""
        size, unit = float(self.entry.size), 0
        while size >= 1000.0 and unit < len(_UNITS) - 1:
            size, unit = size / 1000.0, unit + 1
        return f"{size:.3g} {_UNITS[unit]}"

    @property
    def cells(self) -> list[str]:
        """The cells of HEADER."""
        numbers = [self.runs, str(self.caveats), str(self.failed), self.size, self.state]
        return [self.when, self.entry.kind, shorten(self.what, _LONGEST), shorten(self.answer, _LONGEST), *numbers]

    @property
    def standing(self) -> str:
        """State, failed runs, caveats and size in a few words."""
        parts = [self.state, f"{self.failed} failed" if self.failed else ""]
        parts += [f"{self.caveats} with caveats" if self.caveats else "", self.size]
        return ", ".join(filter(None, parts))


HEADER = ("when", "kind", "what", "answer", "runs", "caveats", "failed", "size", "state")
"""Heads of the columns of `Row.cells`."""


def rows_of(outputs: Path) -> list[Row]:
    """Return the results of an outputs folder, the newest first, without reports and runs of sweeps.

    Raises:
        StoreError: if there is no such folder.
    """
    entries = [entry for entry in list_entries(outputs) if entry.kind != "report"]
    owned = _owned(entries)
    shown = [entry for entry in entries if not (entry.kind == "run" and entry.folder.name in owned)]
    sizes = {entry.folder.name: entry.size for entry in entries if entry.kind == "run"}
    progress.begin("reading results", len(shown), "results")
    rows = []
    for entry in shown:
        rows.append(_row(entry, sizes))
        progress.step()
    return rows


def _owned(entries: Sequence[ListedResult]) -> set[str]:
    """Return the runs of all sweeps that can be read."""
    owned: set[str] = set()
    for entry in entries:
        try:
            owned |= runs_of_sweeps([entry])
        except RunnerError:
            continue
    return owned


def _row(entry: ListedResult, sizes: Mapping[str, int]) -> Row:
    if not entry.finished:
        return Row(entry, "", state="unfinished")
    try:
        if entry.kind == "identification":
            return _identification_row(entry)
        found = open_run(entry.folder) if entry.kind == "run" else open_stored(entry.folder)
        if isinstance(found, Sweep):
            with_runs = entry.size + sum(sizes.get(name, 0) for name in set(found.hashes))
            return _sweep_row(replace(entry, size=with_runs), found)
        if isinstance(found, Calibration):
            return Row(entry, str(found.provenance["command"]), ", ".join(found.record["estimates"]), "1")
        return _run_row(entry, found)
    except SchemaError as error:
        return Row(entry, "", one_line(str(error)), state="other version")
    except StoreError as error:
        return Row(entry, "", one_line(str(error)), state="damaged")
    except _MISFITS as error:
        text = f"its content does not fit together: {type(error).__name__}: {error}"
        return Row(entry, "", one_line(text), state="damaged")


def _identification_row(entry: ListedResult) -> Row:
    from runner.identification.result import open_identification
    from runner.identification.words import answer_lines

    known = open_identification(entry.folder)
    return Row(entry, known.command, next(answer_lines(known)), str(len(known.logs)))


def _run_row(entry: ListedResult, run: Run) -> Row:
    found = key_metrics(run, 1)
    answer = with_powers(run.failure or "") or "; ".join(f"{name} {value}" for name, value, _ in found)
    failed = int(run.status == "failed")
    return Row(entry, " ".join(run.overrides), answer, f"1 x {run.repetitions}", len(run.caveats), failed)


def _sweep_row(entry: ListedResult, sweep: Sweep) -> Row:
    status = find_status(sweep)
    words = sweep.command.partition(" -m ")[2] or sweep.command
    state = "unfinished" if status.left else "good"
    with_caveats = sum(count > 0 for count in status.caveats)
    many = len(sweep.hashes) > _MOST_CELLS or status.left or entry.kind == "challenge"
    measured = None if many else measure_sweep(sweep)
    times = f" x {measured.repetitions}" if measured else ""
    count, failed = len(sweep.hashes), status.failed
    if entry.kind == "tuning":
        tuning = open_tuning(entry.folder)
        answer = summary_of_tuning(tuning)
        count, failed = len(tuning.trials), sum(bool(trial.failure) for trial in tuning.trials)
    elif entry.kind == "challenge":
        answer = challenge_answer(open_challenge(entry.folder))
    else:
        answer = in_short(choose(measured)) if measured else ""
    return Row(entry, words, answer, f"{count}{times}", with_caveats, failed, state)


def write_page(rows: Sequence[Row], outputs: Path, path: Path) -> None:
    """Write the page; its links to results and their reports are relative to it.

    Raises:
        StoreError: if it cannot be written.
    """
    progress.begin("writing the page")
    here, there = Path.cwd(), path.resolve().parent
    listed = [
        {
            "when": row.when,
            "kind": row.entry.kind,
            "runs": row.runs,
            "standing": row.standing,
            "what": row.what,
            "answer": row.answer,
            "folder": os.path.relpath(row.entry.folder, here),
            "link": _link(row.entry, outputs, there),
            "thumbnail": data_uri(_thumbnail(row)) if place < _MOST_THUMBNAILS and row.state == "good" else "",
        }
        for place, row in enumerate(rows)
    ]
    script = asset("results.js")
    page = (
        html_environment()
        .get_template("results.html.j2")
        .render(
            rows=listed,
            outputs=outputs.resolve().name,
            script=script,
            policy=script_policy([script]),
            style=asset("style.css"),
        )
    )
    write_atomically(path, page.encode("utf-8", "replace"))


def _link(entry: ListedResult, outputs: Path, place: Path) -> str:
    """Return the address of the report on a result, of its folder without one, from the folder of the page."""
    report = outputs / KINDS["report"].folder / report_name([entry.folder]) / "report.html"
    return os.path.relpath(report if report.is_file() else entry.folder, place)


def _thumbnail(row: Row) -> str:
    """Return a still picture of the motion of a run, or of the first run of a sweep; an empty drawing without one."""
    empty = '<svg xmlns="http://www.w3.org/2000/svg" width="1" height="1"/>'
    try:
        found = open_stored(row.entry.folder)
        if isinstance(found, Calibration):
            return empty
        run = next(iter(found.runs())) if isinstance(found, Sweep) else found
        return still_motion(run, has_words=False)
    except (RunnerError, StopIteration, IndexError):
        return empty
