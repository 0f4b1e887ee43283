"""What of a published work stands where in its report."""

from collections.abc import Sequence
from dataclasses import dataclass

from runner.reporting import outline
from runner.reporting.document import Section, Table, Text


@dataclass(frozen=True)
class Checklist:
    """A checklist whose items are found by the titles of our sections.

    Attributes:
        title: Title of the section.
        text: What is to be said of the source.
        complete: What is said where nothing is missing.
        caption: Caption of the table.
        place: Header of the items' places in the source.
        items: What it is, its place in the source, what we did with it, and the title of our section.
    """

    title: str
    text: str
    complete: str
    caption: str
    place: str
    items: Sequence[tuple[str, str, str, str]]

    def section(self, sections: Sequence[Section]) -> Section:
        """Return the checklist, its places found in the report itself.

        Args:
            sections: All chapters of the report from its first on, those that follow the checklist may be left out.
        """
        places = {chapter.section.title: f"§{chapter.number}" for chapter in outline.numbered(sections)}
        rows = [
            [what, place, state if title in places else "missing", places.get(title, "–")]
            for what, place, state, title in self.items
        ]
        missing = [what for what, _, _, title in self.items if title not in places]
        text = f"{self.text} " + (f"Missing here: {', '.join(missing)}." if missing else self.complete)
        return Section(
            self.title, (Text(text), Table(self.caption, ["what it is", self.place, "state", "where"], rows))
        )
