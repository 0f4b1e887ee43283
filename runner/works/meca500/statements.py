"""What the report claims in words, judged by the findings of its chapters."""

from collections.abc import Mapping
from typing import Any

from runner.audit.audit import audit
from runner.claims import load_statements
from runner.reporting.claim import EquationVerdict, StatementVerdict
from runner.reporting.claims import judged_statements
from runner.reporting.document import Verdicts
from runner.works.chapters import Concluded

_SAMPLES = 200


def said(concluded: Concluded, chapter: str) -> Mapping[str, Any]:
    """Return the values that a chapter gives a name, and as `holds` whether all of its findings do."""
    findings, values = concluded(chapter)
    return {**values, "holds": all(each.holds for each in findings)}


def verdict(*holds: bool) -> StatementVerdict:
    """Return the verdict on what holds where all of some findings do."""
    return "holds" if all(holds) else "no longer holds"


def audited(equation: str) -> EquationVerdict:
    """Return the audit's verdict on an equation."""
    return next(each.verdict for each in audit("meca500", _SAMPLES) if each.entry.id == equation)


def statements(caption: str, judged: Mapping[str, tuple[StatementVerdict | EquationVerdict, str]]) -> Verdicts:
    """Return each statement with its verdict and what was measured, by its name."""
    return Verdicts(caption, judged_statements(load_statements("meca500"), judged))
