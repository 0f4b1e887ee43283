"""Verdicts on the report's statements, from the findings of the chapters."""

from collections.abc import Mapping
from typing import Any

from runner.audit.audit import audit
from runner.reporting.claims import Verdict, load_statements
from runner.reporting.document import Verdicts
from runner.reporting.equation import EquationVerdict
from runner.study.chapters import Concluded
from runner.study.claims import judged_statements

_SAMPLES = 200
_LEGEND = (
    "A statement matches when every condition of the findings on it is met, and differs when one is not. It is "
    "undecided when nothing here measures it. Equations are correct or wrong as printed by the audit."
)


def said(concluded: Concluded, chapter: str) -> Mapping[str, Any]:
    """Return the values that a chapter gives a name, and as `holds` whether all of its findings do."""
    findings, values = concluded(chapter)
    return {**values, "holds": all(each.holds for each in findings)}


def verdict(*holds: bool) -> Verdict:
    """Return the verdict on a statement that is true where all of some findings hold."""
    return "matches" if all(holds) else "differs"


def audited(equation: str) -> EquationVerdict:
    """Return the audit's verdict on an equation."""
    return next(each.verdict for each in audit("meca500", _SAMPLES) if each.entry.id == equation)


def statements(caption: str, judged: Mapping[str, tuple[Verdict | EquationVerdict, str]]) -> Verdicts:
    """Return each statement with its verdict and what was measured, by its name."""
    return Verdicts(caption, judged_statements(load_statements("meca500"), judged), _LEGEND)
