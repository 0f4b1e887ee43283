"""Simulate the missing runs of a study and write its report.

`runner study new FOLDER` writes your own study. OVERRIDES configure the execution: hydra.sweeper.workers and .address,
sweep.time_limit, .attempts, .retry and .on_failure, limits.cpu_hours and .memory, caveats.RULE.KEY. The study defines
its simulations; --plugin adds levels to an axis of the study that takes them.

Example: runner reproduce xarm7 --jobs 4
"""

import json
import shlex
import sys
from argparse import Namespace
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from runner.base import progress
from runner.base.errors import RunnerError
from runner.base.paths import STUDY_FILE
from runner.cli.arguments import Parser
from runner.config.compose.files import outputs_dir
from runner.papers.study.changes import FILE
from runner.papers.study.names import find_study, study_names
from runner.plugins.discovery import in_use, named_parts
from runner.store.kinds import note, report_place

if TYPE_CHECKING:
    from runner.cli.commands import Compose
    from runner.papers.study.chapters import Chapters
    from runner.papers.study.code import UserPlugin
    from runner.papers.study.expected_caveats import ExpectedCaveat
    from runner.papers.study.study import Study
    from runner.reporting.document import Document
    from runner.store import Calibration, Run

AUDIT = "audit"
_TITLE = 60  # characters of a finding's title in a table
_FREE = ("hydra.sweeper.", "sweep.", "limits.", "caveats.")


@dataclass(frozen=True)
class _Reproduced:
    """Result of a study: report, runs by name, reasons for missing runs, expected caveats, problems of `--check`.

    The lines on the scope of its findings are empty without a challenge.
    """

    document: "Document"
    runs: "Mapping[str, Run]"
    missing: Mapping[str, str]
    expected: "Sequence[ExpectedCaveat]" = ()
    problems: Sequence[str] = ()
    scope: Sequence[str] = ()
    calibrations: "Mapping[str, Calibration]" = field(default_factory=dict)


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.usage = "runner reproduce [OPTION ...] [NAME] [OVERRIDE ...]"
    studies = ", ".join((*study_names(), AUDIT, "all"))
    study = parser.add_argument(
        "study", nargs="?", default="all", metavar="NAME", help=f"{studies} or a folder (default: all)"
    )
    study.completer = lambda **_: (*study_names(), AUDIT, "all")  # type: ignore[attr-defined]
    parser.add_overrides("such as sweep.time_limit=60")
    parser.add_shared(
        output="outputs folder (default: outputs)",
        jobs="number of processes (default: 2)",
        json="print the verdicts and numbers as JSON",
    )
    parser.set_defaults(output=outputs_dir())
    parser.add_argument("--check", action="store_true", help="exit 1 for a problem that `runner study check` finds")
    parser.add_argument(
        "--profile",
        default="",
        metavar="P",
        help="smaller or larger version, by its name in study.yaml (default: the study's)",
    )
    parser.add_argument(
        "--challenge",
        nargs="?",
        const="",
        metavar="FINDING",
        help="ask the condition of each finding, or of those of a section or title, with one choice changed at a time",
    )
    parser.add_argument("--code", action="store_true", help="run the Python of FOLDER")


def run(options: Namespace) -> int:
    """Reproduce one study or all; print the report's folder as the last line."""
    others = [text for text in options.overrides if not text.startswith(_FREE) or text.startswith("sweep.trace")]
    if others and options.json and "=" not in others[0]:
        raise RunnerError(f"reproduce: --json takes no file ({others[0]}). Write a file by `--json > {others[0]}`")
    if others:
        allowed = ", ".join(f"{key}*" for key in _FREE)
        raise RunnerError(f"reproduce: the study decides what it simulates ({others[0]}). Allowed: {allowed}.")
    if options.study == AUDIT and (options.code or options.profile):
        raise RunnerError("--code and --profile: not for the audit, which runs no study. Allowed: with a study.")
    if options.challenge is not None and options.study in (AUDIT, "all"):
        raise RunnerError(f"--challenge: not for {options.study}, which has several sources. Allowed: one study.")
    if options.study not in (AUDIT, "all"):
        find_study(options.study, (AUDIT, "all"))  # rejects an unknown name before anything is read
    plugins = [word for text in named_parts() for word in ("--plugin", text)]
    options.command = shlex.join(["runner", *plugins, "reproduce", *options.words])
    options.overrides += [] if options.jobs is None else [f"hydra.sweeper.workers={options.jobs}"]
    options.parts = _parts(options.study)
    made = {}
    for study in _chosen(options):
        name, made[name] = _reproduce(study, options)
        for line in made[name].scope:
            print(line, file=sys.stderr if options.json else None)
        print(options.output / "reports" / name, file=sys.stderr if options.json else None)
    if options.json:
        print(_conclusions(made), end="")
    for name, each in made.items():
        for line in each.problems:
            print(f"runner: {name}: {line}", file=sys.stderr)
    return 1 if any(each.missing or each.problems for each in made.values()) else 0


def _parts(study: str) -> "tuple[UserPlugin, ...]":
    """Return the parts that --plugin names, for one study that may take them."""
    from runner.papers.study.code import read_user_plugins

    if in_use() and study in (AUDIT, "all"):
        raise RunnerError(f"--plugin: not for several studies ({study}). Allowed: one study.")
    return read_user_plugins(in_use())


def _chosen(options: Namespace) -> "list[Study | None]":
    """Return the named study, or all studies, those with the fewest runs first; None stands for the audit."""
    from runner.papers.study.study import load_study

    text, code, profile = options.study, options.code, options.profile
    if text == AUDIT:
        return [None]
    if text != "all":
        return [load_study(text, code, profile, (AUDIT, "all"), options.parts)]
    studies = [study for name in study_names() if (study := load_study(name, code, profile)).manifest.in_all]
    return [None, *sorted(studies, key=lambda study: len(study.jobs()))]


def _reproduce(study: "Study | None", options: Namespace) -> "tuple[str, _Reproduced]":
    from runner import store
    from runner.base.atomic import write_atomically
    from runner.papers.study.tunings import write_gains
    from runner.reporting.render import write_report

    name = AUDIT if study is None else study.name
    progress.set_title(name)
    folder = report_place(options.output, name)
    store.prepare(options.output)
    made = _audit(folder) if study is None else _reproduce_study(study, options)
    print("writing the report ...", file=sys.stderr)
    write_report(made.document, folder)
    if study is not None and study.tuned:
        write_gains(folder, study.tuned)
    write_atomically(folder / FILE, _conclusions({name: made}).encode())
    note(folder)
    for run, why in made.missing.items():
        print(f"runner: {name}: {run} is missing in the report: {why}", file=sys.stderr)
    return name, made


def _conclusions(made: Mapping[str, _Reproduced]) -> str:
    from runner.papers.study.conclusions import conclusions

    content = {
        study: conclusions(each.document, each.runs, each.calibrations, each.expected) for study, each in made.items()
    }
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def _reproduce_study(study: "Study", options: Namespace) -> _Reproduced:
    from runner.papers.study.asked import check_chosen
    from runner.papers.study.chapters import Chapters
    from runner.papers.study.check import formulas_at, problems
    from runner.papers.study.claims import late_claims
    from runner.papers.study.execute import make_all
    from runner.papers.study.report import study_document
    from runner.reporting.markup import literal

    if options.challenge:
        check_chosen(study, options.challenge)
    study.measure(options.output)
    runs, calibrations = make_all(study, options.output, options.overrides, options.command)
    missing = runs.missing | calibrations.missing
    chapters = Chapters(study, runs, calibrations)
    document = study_document(chapters)
    late = late_claims(options.output, study, runs)
    document = replace(document, notes=[*document.notes, *map(literal, late)])
    for line in late:
        print(f"runner: {study.name}: {line}", file=sys.stderr)
    found = [*problems(chapters, document)] if options.check else []
    scope: list[str] = []
    if options.challenge is not None:
        document, scope, turned = _challenge(chapters, document, options)
        found += turned if options.check else []
    for line in [] if options.check else formulas_at(study, document):
        print(f"runner: {line}", file=sys.stderr)
    return _Reproduced(document, runs, missing, study.expected, found, scope, calibrations)


def _challenge(
    chapters: "Chapters", document: "Document", options: Namespace
) -> "tuple[Document, list[str], list[str]]":
    """Return a report with the scope of its findings, the lines to print, and those that numerical choices turn."""
    from runner.papers.study.challenge import challenge_study
    from runner.papers.study.items import Way
    from runner.papers.study.scope import scope_section, scope_table, turned_lines, unsettled
    from runner.reporting.table import terminal

    way = Way(options.output, options.overrides, options.command, chapters.study.config_dirs)
    found = challenge_study(chapters, document, way, options.challenge)
    document = replace(document, sections=[*document.sections, scope_section(found)])
    lines = [terminal(scope_table(found, _TITLE), indent=""), "", *turned_lines(found), ""]
    return document, lines, [*unsettled(found)]


def _audit(folder: Path) -> _Reproduced:
    """Check the equations of all studies; write their table, and return the report."""
    from runner.base.atomic import write_atomically
    from runner.papers.audit.audit import as_csv, audit_all
    from runner.papers.reporting.audit_report import audit_document

    print("auditing the equations ...", file=sys.stderr)
    checked = audit_all()
    table = as_csv([each for source in checked.values() for each in source])
    write_atomically(folder / "equations.csv", table.encode())
    return _Reproduced(audit_document(checked), {}, {})


def find_document(path: Path) -> "Compose | None":
    """Return the function that composes a study's report, by the study's name, its folder or its report's folder."""
    if (path / STUDY_FILE).is_file():
        return partial(_stored_document, str(path), outputs_dir())
    if path.name not in study_names():
        return None
    if not path.is_dir() and path == Path(path.name):
        return partial(_stored_document, path.name, outputs_dir())
    if path.resolve().parent.name == "reports":
        return partial(_stored_document, path.name, path.parent.parent)
    return None


def _stored_document(name: str, outputs: Path) -> "tuple[Document, Path]":
    folder, mend = outputs / "reports" / Path(name).name, f"`runner reproduce {name} --output {outputs}` makes"
    if not folder.is_dir():
        raise RunnerError(f"no report on {name} in {outputs}; {mend} it")
    from runner.papers.study.chapters import Chapters
    from runner.papers.study.execute import count_missing, make_all
    from runner.papers.study.report import study_document
    from runner.papers.study.study import load_study

    print(f"looking for the runs of {name} ...", file=sys.stderr)
    study = load_study(name)
    missing = count_missing(study, outputs)
    if missing:
        raise RunnerError(f"{missing} runs of {name} are not stored in {outputs} as they are made today; {mend} them")
    study.measure(outputs)
    return study_document(Chapters(study, *make_all(study, outputs))), folder
