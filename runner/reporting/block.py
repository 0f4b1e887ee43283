"""The base class of the blocks of a report: what a page asks of a block of any type."""

from collections.abc import Iterable, Iterator
from typing import ClassVar

from runner.reporting.verdicts import Tally


class ReportBlock:
    """A piece of a section, as a frozen dataclass of values; the templates have a macro for each type.

    A guest of the report, such as runner/papers, adds a type of block by a subclass and a pair of templates.

    Attributes:
        block: Name of the macro.
        templates: Name of the templates that have the macro, `NAME.html.j2` and `NAME.typ.j2`.
        word: "figure" or "table", which stands before its number; empty if it has none.
        actions: What the page offers to do with it: "enlarge", "svg", "csv".
    """

    block: ClassVar[str]
    templates: ClassVar[str] = "blocks"
    word: ClassVar[str] = ""
    actions: ClassVar[tuple[str, ...]] = ()

    def texts(self) -> Iterator[str]:
        """Yield the strings that may carry inline mathematics between dollar signs."""
        yield from ()

    def inline(self) -> Iterator[str]:
        """Yield the inline formulas that are fields."""
        yield from ()

    def displayed(self) -> Iterator[str]:
        """Yield the displayed formulas."""
        yield from ()

    def places(self) -> Iterable[str]:
        """Return the names of the places in it that links lead to."""
        return ()

    def tallies(self) -> Iterable[Tally]:
        """Return its counts of verdicts for the first screen."""
        return ()
