"""Report on an identification: accuracy on unseen torques, parameters with intervals, residuals, alternatives."""

import numpy as np

from runner.base.quantities import label_with_unit, quantity
from runner.identification.result import Identification, IdentifiedParameter, JointAccuracy
from runner.identification.words import answer_lines, doubts, method_lines, per_cent
from runner.reporting.document import (
    Curves,
    Document,
    Notice,
    Panel,
    Provenance,
    ReportBlock,
    Section,
    Series,
    Table,
    Text,
)
from runner.reporting.markup import literal
from runner.reporting.metric_titles import capital
from runner.reporting.sections import added_sections, make_sections
from runner.reporting.table import Cell, Column, Number, Origin, numbers

_METHOD = (
    "Both sides of $tau = Y(q, dot(q), dot.double(q)) pi + I_a dot.double(q) + tau_f$ pass the same low-pass without "
    "delay. Each joint has a weight from its residuals, and rows far outside count less. Rows near standstill are left "
    "out of the fit, because friction at rest can be any torque up to its level. Errors on unseen torques are those of "
    "stretches, or of whole logs, that the fit did not see; there rows at rest count with what friction cannot hold."
)
_INTERVALS = (
    "The 95 % intervals allow for residuals that are correlated in time, for the spread between logs, and for the "
    "difference of ordinary least squares where it exceeds chance. The column of white residuals is what least squares "
    "prints: intervals for residuals that are not correlated."
)


def identification_document(found: Identification) -> Document:
    """Return the report on an identification."""
    first, *rest = answer_lines(found)
    own = make_sections(SECTIONS, found)
    return Document(
        title=f"{capital(found.robot.replace('_', ' '))}: identified from {_count(len(found.logs), 'log')}",
        subtitle=literal(", ".join(log.name for log in found.logs)),
        abstract="\n".join(literal(line) for line in [first, " ".join(rest)]),
        sections=[*own[:-1], *added_sections("identification", found), own[-1]],
        date=found.date,
        dated="Identified",
        key_numbers=_key_numbers(found),
    )


def _unseen(found: Identification) -> Section:
    return Section("Unseen torque", [accuracy(found)])


def _parameters(found: Identification) -> Section:
    return Section("Parameters", [Text(_INTERVALS), parameters(found), *_untold(found)])


def _curves(found: Identification) -> Section:
    return Section("Residuals", [_residuals(found, *view) for view in _VIEWS])


def _count(many: int, what: str) -> str:
    return f"{many} {what}{'s' * (many != 1)}"


def _key_numbers(found: Identification) -> list[tuple[str, str, str]]:
    widths = [one.half / one.white for one in found.parameters if one.white > 0.0]
    return [
        ("error on unseen torque", per_cent(found.held_out), f"the robot's file: {per_cent(found.file)}"),
        ("determined parameters", str(len(found.parameters)), f"not determined: {len(found.untold)}"),
        ("intervals", f"{np.median(widths):.2g} times", "as wide as for residuals that are not correlated (median)"),
    ] if widths else [("error on unseen torque", per_cent(found.held_out), "")]  # fmt: skip


def accuracy(found: Identification) -> Table:
    """Return the errors of unseen torques by joint, next to those of the robot's file."""
    rows: list[list[Cell]] = [
        [joint.joint, *(Number(100.0 * share, digits=2) for share in (joint.held_out, joint.file)), Number(joint.rows),
         *(Number(100.0 * share, digits=2) for share in (joint.left_out, joint.outside))]
        for joint in found.joints
    ]  # fmt: skip
    rows.append(["all", *(Number(100.0 * share, digits=2) for share in (found.held_out, found.file)), "", "", ""])
    header = [
        "joint", *numbers("unseen torque (%)", "robot's file (%)", "rows in the fit", "near standstill (%)",
                          "far outside (%)")
    ]  # fmt: skip
    caption = "Norm of the errors over the norm of the torques; the robot's file is taken without friction."
    return Table(caption, header, rows)


def parameters(found: Identification) -> Table:
    """Return the determined parameters with their intervals."""
    with_prior = found.prior is not None

    def share(one: IdentifiedParameter) -> list[Cell]:
        text: Cell = "" if one.prior_share is None else Number(100.0 * one.prior_share, digits=2)
        return [text] if with_prior else []

    rows: list[list[Cell]] = [
        [_full_name(one), _unit(one), Number(one.value),
         Number(None, one.value - one.half, one.value + one.half),
         "" if one.file is None else Number(one.file), *share(one),
         ", ".join(word for word, said in (("methods differ", one.differs), ("logs differ", one.spread)) if said)]
        for one in found.parameters
    ]  # fmt: skip
    last = ["from the file (%)"] if with_prior else []
    header = ["parameter", "unit", *numbers("value", "95 % interval", "robot's file", *last), "rests on"]
    caption = "Parameters that the logs determine."
    if any(one.unit.endswith("/A") for one in found.parameters):
        caption += " The file's value of a torque constant is that in the column map."
    if with_prior:
        caption = "Parameters by the logs and the robot's file, with the share of the file in each value."
    return Table(caption, header, rows)


def _full_name(one: IdentifiedParameter) -> str:
    return f"{one.name} (with {', '.join(one.stands_for)})" if one.stands_for else one.name


def _unit(one: IdentifiedParameter) -> str:
    return one.unit.replace("^2", "²")


def _untold(found: Identification) -> list[ReportBlock]:
    if not found.untold:
        return [Text("Every parameter of the torques is determined by these logs.")]
    rows = [[one.name, one.reason, capital(one.motion)] for one in found.untold]
    return [Table("Parameters that the logs do not determine.", ["parameter", "reason", "motion that would"], rows)]


def _doubts(found: Identification) -> Section:
    notices = [Notice("warning", literal(line), "") for line in doubts(found)]
    return Section("What speaks against it", notices or [Text("Nothing was found.")])


_VIEWS = (
    ("speed", "speed", "Residuals against speed: a curve means another kind of friction."),
    ("position", "position", "Residuals against position."),
    ("load", "torque of links and rotor", "Residuals against the load: a slope means friction that depends on load."),
    ("time", "time", "Residuals against time, log after log: a drift means temperature."),
)


def _residuals(found: Identification, name: str, label: str, caption: str) -> Curves:
    panels = []
    for joint in found.joints:
        x, y = np.array(getattr(joint, name)), np.array(joint.residual)
        torque = "N m" if joint.unit == "rad" else "N"
        unit = {"speed": f"{joint.unit}/s", "position": joint.unit, "load": torque, "time": "s"}[name]
        points = Series("", x, y, "points", color=0)
        panels.append(Panel(literal(joint.joint), label_with_unit(label, unit), _residual_label(joint), [points]))
    return Curves(caption, panels, origin=Origin(command=found.command))


def _residual_label(joint: JointAccuracy) -> str:
    return label_with_unit("residual", "N m" if joint.unit == "rad" else "N")


def _alternatives(found: Identification) -> Section:
    rows: list[list[Cell]] = [
        [one.kind, Number(one.frequency), Number(100.0 * one.held_out, digits=3), Number(one.square, digits=3),
         "; ".join(one.follows) or "nothing", "chosen" if one.chosen else ""]
        for one in found.alternatives
    ]  # fmt: skip
    header = [
        Column("friction", "code"),
        *numbers("cut-off (Hz)", "unseen torque (%)", "weighted square"),
        "residuals follow",
        "",
    ]
    caption = (
        "What was tried. A further term or another cut-off is chosen if it lowers the weighted mean square of the "
        "errors on unseen torque by more than 1 % and two of its deviations over the stretches."
    )
    return Section("Alternatives", [Table(caption, header, rows)])


def _second(found: Identification) -> Section:
    rows: list[list[Cell]] = [
        [one.name, _unit(one), Number(one.value), Number(one.second), Number(one.half), Number(one.white),
         "more than chance" if one.differs else ""]
        for one in found.parameters
    ]  # fmt: skip
    header = [
        "parameter", "unit",
        *numbers("value", "ordinary least squares", "half-width", "half-width, white residuals"), "difference",
    ]  # fmt: skip
    text = (
        "Ordinary least squares weighs all joints alike, and all rows. Under the right equations both methods agree "
        "within chance. Where they do not, the equations of the joints contradict each other."
    )
    return Section("Second method", [Text(text), Table("Comparison with ordinary least squares.", header, rows)])


def _made(found: Identification) -> Section:
    rows = [(log.name, f"SHA-256 {log.digest}") for log in found.logs]
    rows += [("torques", f"{found.side} side"), ("date", found.date), ("command", found.command)]
    shapes = [
        Text(literal(f"Speed v_s of the friction: {', '.join(quantity(shape, 'rad/s') for shape in found.shapes)}."))
    ]
    lines = [Text(literal(line)) for line in method_lines(found)]
    return Section("Method and logs", [Text(_METHOD), *lines, *(shapes if found.shapes else []), Provenance(rows)])


SECTIONS = (_unseen, _parameters, _doubts, _curves, _alternatives, _second, _made)
"""Sections: functions of the identification that return a section or None; plug-ins add theirs before the last."""
