"""Sections of a report: their subject, the sections that a report lists, and those of plug-ins."""

import copy
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

from runner.base.errors import ConfigError, describe_part_error
from runner.plugins.discovery import added_parts, load
from runner.plugins.guard import place
from runner.reporting.consistency import make_consistent
from runner.reporting.document import Document, Notice, Section
from runner.store import Run

if TYPE_CHECKING:
    from runner.sweeps.changes import Changes

S = TypeVar("S")

_REPORTS = ("run", "sweep", "comparison", "tuning", "challenge", "recording", "identification")  # that plug-ins add to


@dataclass(frozen=True)
class RunSubject:
    """A stored run as its report looks at it: the subject of the sections of the report.

    Attributes:
        run: The stored run.
    """

    run: Run

    @cached_property
    def changed(self) -> "Changes | None":
        """The keys that differ from those of the run's groups; see changed_keys."""
        from runner.sweeps.changes import changed_keys  # Hydra, which plug-ins do without

        return changed_keys(self.run)


def make_sections(functions: Iterable[Callable[[S], Section | None]], subject: S) -> list[Section]:
    """Return the sections of a subject, without those that are None."""
    made = (function(subject) for function in functions)
    return [section for section in made if section is not None]


def added_sections(kind: str, subject: Any) -> list[Section]:
    """Return the sections of plug-ins; one that fails is a section that states the fault.

    Args:
        kind: Kind of the report, such as run; the function of a plug-in is run_section.
        subject: The subject, a dataclass; each function receives a copy.
    """
    return [section for point in added_parts("section") for section in _added(point.name, point.value, kind, subject)]


def _added(plugin: str, module: str, kind: str, subject: Any) -> Iterator[Section]:
    try:
        members, name = vars(load("section", plugin, module)), f"{kind}_section"
        known = [f"{each}_section" for each in _REPORTS]
        if members.keys().isdisjoint(known):
            raise ConfigError(f"section {plugin}: module {module} needs one of {', '.join(known)}")
        made = members[name](copy.deepcopy(replace(subject))) if name in members else None
        if made is not None:
            _check(made, members[name])
            yield made
    except Exception as error:
        raised = f"section {plugin}: {describe_part_error(error)}"
        fault = error.problems[0] if isinstance(error, ConfigError) else raised
        yield Section(f"Section {plugin}", (Notice("failure", f"The section of plug-in {plugin} failed", f"{fault}."),))


def _check(made: Any, function: Callable[..., Any]) -> None:
    """Check the result of a plug-in by a report with only this section.

    Raises:
        ConfigError: if it is not a section, or cannot be shown; the message contains the file and the line.
    """
    if not isinstance(made, Section):
        raise ConfigError(f"{place(function)} gave {made!r:.200}; it must be a Section or None")
    from runner.reporting.render import render_html, render_pdf  # Typst and Jinja, which printed results do without

    try:
        report = make_consistent(Document("", "", "", [made], ""))
        render_html(report)
        render_pdf(report)
    except Exception as error:
        fault = f"{type(error).__name__}: {error}"
        raise ConfigError(f"{place(function)} gave a section that cannot be shown: {fault:.300}") from error
