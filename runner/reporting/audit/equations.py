"""Judged entries as the rows of a report's table."""

import math

from runner.audit.entry import Form
from runner.audit.expressions import ExpressionError, Node, parse
from runner.audit.verdict import Judged
from runner.reporting.document import Equation, EquationForm
from runner.reporting.quantities import quantity


def row(judged: Judged) -> Equation:
    """Return the row of one equation."""
    entry = judged.entry
    return Equation(
        entry.number, entry.title, entry.place, judged.verdict, _error(judged), _forms(judged), entry.finding
    )


def _error(judged: Judged) -> str:
    measured, entry = judged.measured, judged.entry
    if measured is None:
        return ""
    if judged.verdict != "wrong as printed":
        return f"within {quantity(entry.tolerance, entry.unit, 2)}"
    if math.isinf(measured.largest):
        return f"without bound, typically {quantity(measured.typical, entry.unit)}"
    return f"up to {quantity(measured.largest, entry.unit)}, typically {quantity(measured.typical, entry.unit)}"


def _forms(judged: Judged) -> list[EquationForm]:
    entry = judged.entry
    found = [_form("as printed", entry.printed)]
    if entry.repair is not None:
        found.append(_form("repaired", entry.repair, entry.repair.why))
    if entry.corrected is not None:
        found.append(_form("corrected", entry.corrected))
    return found


def _form(label: str, form: Form, note: str = "") -> EquationForm:
    if form.math:
        return EquationForm(label, math=form.math, note=note)
    try:
        expressions = [(_left(name), parse(text).root) for name, text in form.elements.items()]
    except ExpressionError:
        raw = "; ".join(f"{name} = {text}" for name, text in form.elements.items())
        return EquationForm(f"{label}, as the text has it", raw=raw, note=note)
    return EquationForm(label, expressions=expressions, note=note)


def _left(name: str) -> Node:
    return parse(name).root


def rolled_out(judged: list[Judged]) -> list[str]:
    """Return the names of the rollouts that a source's entries ask for, each once, in order."""
    return list(dict.fromkeys(each.entry.rollout for each in judged if each.entry.rollout))
