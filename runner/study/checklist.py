"""Checklist of a source's figures, tables and formulas (`checklist.yaml`), with their report sections."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, model_validator

from runner.base.data_file import read_data
from runner.base.expressions.evaluator import Budget, Scope
from runner.base.expressions.grammar import ExpressionError
from runner.base.expressions.insertions import fill
from runner.base.paths import studies_dir
from runner.reporting import outline
from runner.reporting.document import Code, Formula, Items, Notice, Provenance, Section, Table, Text
from runner.schema.model import StrictModel

_FILE = "checklist.yaml"
_MISSING, _NOWHERE = "missing", "–"
_DRAWN = "drawn anew"  # what was not to be expected, and is there


class Item(StrictModel):
    """A figure, table or formula of the source.

    Attributes:
        name: What it is called: "Figure 3.5" where the source has a number.
        about: What it shows, or where the source has it.
        state: What became of it in the report.
        section: Title of our section where it stands; where none is named it is found by its number in the source.
        absent: Why it is not to be expected in the report; empty where it is.
    """

    name: Annotated[str, Field(min_length=1)]
    about: str
    state: Annotated[str, Field(min_length=1)]
    section: str = ""
    absent: str = ""


class Checklist(StrictModel):
    """All that a source shows, and what is said of it.

    Attributes:
        title: Title of the section.
        text: What is to be said of the source. In double braces: `figures` and `tables`, how many items are called so;
            `expected`, how many items are to be in the report; `here`, how many of these are; `missing`, the sentence
            on those that are not.
        complete: What stands for `missing` where nothing is.
        incomplete: What stands for it otherwise; in double braces `names`, those of the items.
        caption: Caption of the table.
        columns: Headers of the items' names and of what they are about.
        items: The items in the order of the source.
    """

    title: str
    text: str
    complete: str
    incomplete: str
    caption: str
    columns: Annotated[list[str], Field(min_length=2, max_length=2)]
    items: Annotated[list[Item], Field(min_length=1)]

    @model_validator(mode="after")
    def _check_braces(self) -> Self:
        for key, text, names in (
            ("text", self.text, ("figures", "tables", "expected", "here", "missing")),
            ("incomplete", self.incomplete, ("names",)),
        ):
            try:
                _filled(text, **dict.fromkeys(names, ""))
            except ExpressionError as error:
                raise ValueError(f"{key}: {error.reason}") from None
        return self

    def section(self, sections: Sequence[Section]) -> Section:
        """Return the checklist, its places found in the report itself.

        Args:
            sections: All chapters of the report from its first on, those that follow the checklist may be left out.
        """
        titles, numbers = _places(sections)
        places = [titles.get(item.section) if item.section else numbers.get(item.name.lower()) for item in self.items]
        rows = [_row(item, place) for item, place in zip(self.items, places, strict=True)]
        missing = [name for name, _, state, _ in rows if state == _MISSING]
        expected = sum(not item.absent for item in self.items)
        told = _filled(self.incomplete, names=", ".join(missing)) if missing else self.complete
        text = _filled(
            self.text,
            figures=sum(item.name.startswith("Figure ") for item in self.items),
            tables=sum(item.name.startswith("Table ") for item in self.items),
            expected=expected,
            here=expected - len(missing),
            missing=told,
        )
        return Section(self.title, (Text(text), Table(self.caption, [*self.columns, "state", "where"], rows)))


def _filled(text: str, **values: str | int) -> str:
    return fill(text, Scope({}, values), Budget())


def load_checklist(study: str | Path) -> Checklist | None:
    """Return the checklist of a study; None where it has none.

    Args:
        study: One of ours by its name, such as "thesis", or the whole path of a study's folder.

    Raises:
        RunnerError: if its file cannot be read or does not fit; names the file, and the items and keys.
    """
    path = studies_dir() / study / _FILE
    return read_data(path, Checklist) if path.is_file() else None


def _row(item: Item, place: str | None) -> list[str]:
    """Return an item's name, what it is about, its state, and where it stands."""
    if place is not None:
        return [item.name, item.about, _DRAWN if item.absent else item.state, place]
    return [item.name, item.about, f"{item.state}: {item.absent}" if item.absent else _MISSING, _NOWHERE]


def _places(sections: Sequence[Section]) -> tuple[dict[str, str], dict[str, str]]:
    """Return the section of each title, and that in which each number of the source stands first, in small letters."""
    titles: dict[str, str] = {}
    numbers: dict[str, str] = {}
    for chapter in outline.number_sections(sections):
        place = f"§{chapter.number}"
        titles[chapter.section.title] = place
        for block in chapter.section.blocks:
            if not isinstance(block, Text | Items | Code | Notice | Formula | Provenance) and block.origin.number:
                numbers.setdefault(block.origin.number.lower(), place)
    return titles, numbers
