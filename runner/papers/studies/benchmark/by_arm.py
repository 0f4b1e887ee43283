"""Benchmark chapter by arm: groups of controllers under each condition, and all errors."""

from collections.abc import Sequence

from runner.papers.studies.benchmark.cells import UNTUNED
from runner.papers.studies.benchmark.figures import any_origin, error_words
from runner.papers.studies.benchmark.made import ARMS, CONDITIONS, QUESTIONS, all_cells, arms_of, laws_of, turned
from runner.papers.study.results import Runs
from runner.reporting.document import Section, Table
from runner.reporting.table import numbers
from runner.reporting.words import in_words

_WIDE = 6  # conditions in one table


def arms(runs: Runs) -> list[Section]:
    """Return a section for each arm."""
    return [_arm(runs, arm) for arm in arms_of(runs)]


def _arm(runs: Runs, arm: str) -> Section:
    title = ARMS[arm].replace("planar", "Planar")
    blocks = [_groups(runs, arm, question) for question in QUESTIONS]
    for question in QUESTIONS:
        blocks += _errors(runs, arm, question, (), f"{QUESTIONS[question]}, tuned")
    blocks += _errors(runs, arm, "first", UNTUNED, "from the first second, not tuned")
    return Section(title, blocks)


def _groups(runs: Runs, arm: str, question: str) -> Table:
    rows = []
    for condition, cell in all_cells(runs, arm, question).items():
        groups = [", ".join(map(in_words, own)) for own in cell.groups]
        listed = "; ".join(f"{place}. {own}" for place, own in enumerate(groups, start=1))
        later = [turned(runs, arm, condition) or "none"] if question == "learned" else []
        rows.append([CONDITIONS[condition], error_words(cell.best), listed, *later])
    later = ["change in a later round"] if question == "learned" else []
    header = ["condition", *numbers("smallest error"), "groups, the first one ahead", *later]
    return Table(f"{ARMS[arm]}, {QUESTIONS[question]}: groups of laws.", header, rows, any_origin(runs))


def _errors(runs: Runs, arm: str, question: str, gains: Sequence[str], words: str) -> list[Table]:
    made = all_cells(runs, arm, question, gains)
    names = list(made)
    tables = []
    for start in range(0, len(names), _WIDE):
        chosen = names[start : start + _WIDE]
        rows = [[in_words(law), *(error_words(made[name].entry(law)) for name in chosen)] for law in laws_of(runs, arm)]
        header = ["law", *numbers(*(CONDITIONS[name] for name in chosen))]
        caption = f"{ARMS[arm]}: errors, {words}."
        tables.append(Table(caption, header, rows, any_origin(runs)))
    return tables
