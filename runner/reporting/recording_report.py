"""Report on a recording and a run: signals, residuals, time offset, friction and metrics."""

import hashlib
from pathlib import Path

import numpy as np

from runner.base.quantities import above_rounding, label_with_unit, quantity
from runner.plugins.metric_units import unit_of
from runner.recordings import digest_of, words
from runner.recordings.compare import RecordingComparison, Residual
from runner.recordings.motions import Accuracy, accuracies
from runner.recordings.verdict import per_cent, torque_shares, verdict_lines
from runner.reporting.charts.figure import spaced_indices
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
from runner.reporting.figures import origin
from runner.reporting.markup import literal
from runner.reporting.metric_titles import capital, title
from runner.reporting.run_report import provenance
from runner.reporting.sections import added_sections, make_sections
from runner.reporting.table import Cell, Column, Number, numbers
from runner.store.kinds import outputs_of, report_place

_MOST_POINTS = 600
_RECORDED, _SIMULATED = 0, 1  # colours
_PEAK = "A speed is a share of the largest one of its joint."
_ACCURACY: list[str | Column] = [
    "motion",
    *numbers("from (s)", "to (s)"),
    "peak speed",
    "positions, 95 % of the time",
    "tip, 95 %",
    "torques",
]


def recording_document(found: RecordingComparison) -> Document:
    """Return the report on a recording and a run."""
    robot = str(found.run.config["robot"]["name"]).replace("_", " ")
    own = make_sections(SECTIONS, found)
    return Document(
        title=f"{capital(robot)}: a recording and a run",
        subtitle=literal(f"{found.recording.path.name} against run {found.run.hash}"),
        abstract=literal(_abstract(found)),
        sections=[*own[:-1], *added_sections("recording", found), own[-1]],
        date=str(found.run.provenance["date"]),
        key_numbers=_key_numbers(found),
    )


def _differences(found: RecordingComparison) -> Section:
    return Section("Residuals", [_residual_curves(found), residuals(found), Text(f"The {words.FIT}.")])


def _accuracies(found: RecordingComparison) -> Section | None:
    tables = motions(found)
    return Section("Motions", tables) if tables else None


def _torques(found: RecordingComparison) -> Section | None:
    return Section("Torques of both", [_torque_curves(found)]) if _of_torques(found) else None


def _offset(found: RecordingComparison) -> Section:
    lines = [f"{capital(words.aligned_text(found))}.", *words.lag_lines(found)]
    return Section("Time offset", [*(Text(literal(line)) for line in lines), _lag_curves(found)])


def report_folder(found: RecordingComparison) -> Path:
    """Return the folder of the report, which follows from the run and the content of the recording."""
    recording = found.recording
    said = (found.run.hash, found.offset.start, recording.torque_shift, recording.filled, dict(recording.units))
    content = hashlib.sha256(f"recording {said!r} ".encode())
    for signal in (recording.t, *recording.signals.values()):
        content.update(signal.tobytes())
    return report_place(outputs_of(found.run.folder), content.hexdigest()[:24])


def _abstract(found: RecordingComparison) -> str:
    notes = "; ".join(found.recording.notes)
    return "\n".join([" ".join(verdict_lines(found)), *([f"{capital(notes)}."] if notes else [])])


def _key_numbers(found: RecordingComparison) -> list[tuple[str, str, str]]:
    """Return the offset, the worst fit of a position, the torques' share and the largest Coulomb friction."""
    recording = found.recording
    offset = quantity(round(found.offset.start, 7), "s", digits=4)  # what it was searched to
    rows = f"after the recording's first row; rows {quantity(recording.period, 's')} apart"
    numbers = [("the run begins at", offset, rows)]
    moved = [(one.fit, one) for one in found.residuals if one.signal.kind != "torque" and one.fit is not None]
    if moved and not found.follows_measured:
        fit, worst = min(moved, key=lambda pair: pair[0])
        told = f"of 1 at most; {worst.signal.words}, rms of the residual {quantity(worst.rms, worst.unit)}"
        numbers.append(("worst fit of a position", f"{fit:.3f}", told))
    if shares := torque_shares(found.residuals):
        whole, by_joint = shares
        each = ", ".join(f"{joint} {per_cent(share)}" for joint, share in by_joint.items())
        numbers.append(("torques differ by", per_cent(whole), f"of their rms; {each}"))
    for joint in () if found.friction is None else sorted(found.friction.joints, key=lambda one: -one.coulomb)[:1]:
        unit = "N m" if joint.unit == "rad" else "N"
        told = f"{joint.joint}; 95 % interval ± {quantity(joint.coulomb_half, unit)}"
        numbers.append(("largest Coulomb friction", quantity(joint.coulomb, unit), told))
    return numbers


def residuals(found: RecordingComparison) -> Table:
    """Return a table with a row for each signal."""
    rows: list[list[Cell]] = [
        [residual.signal.words, residual.unit, *map(Number, (residual.mean, residual.rms, residual.largest)),
         "-" if residual.fit is None else f"{residual.fit:.4f}"]
        for residual in found.residuals
    ]  # fmt: skip
    header = ["recorded - run", "unit", *numbers("mean", "rms", "largest", "fit")]
    return Table("Recorded less simulated, at the run's ticks.", header, rows)


def motions(found: RecordingComparison) -> list[Table]:
    """Return a table by group of speed and one by motion; none for a recording of one motion."""
    each, groups = accuracies(found)
    by_speed = [[name, *rest] for name, _, _, *rest in map(_accuracy, groups)]
    titles = [*_ACCURACY[:1], *_ACCURACY[3:]]
    tables = [
        Table(f"Accuracy by speed: thirds of the motions by their peak speed. {_PEAK}", titles, by_speed),
        Table(f"Accuracy in each motion, from rest to rest. {_PEAK}", _ACCURACY, [_accuracy(one) for one in each]),
    ]
    return [table for table in tables if len(each) > 1 and table.rows]


def _accuracy(one: Accuracy) -> list[Cell]:
    low, high = one.speeds
    speeds = f"{high:.0%}" if low == high else f"{low:.0%} to {high:.0%}"
    reached = "-" if np.isnan(one.position) else f"{quantity(one.position, one.unit)} ({one.joint})"
    tip = "-" if np.isnan(one.tip) else quantity(one.tip, "m")
    torque = "-" if np.isnan(one.torque) else f"{100.0 * one.torque:.3g} %"
    return [one.name, Number(one.first), Number(one.last), speeds.replace("%", " %"), reached, tip, torque]


def friction(found: RecordingComparison) -> Table:
    """Return a table with a row for viscous and one for Coulomb friction of each joint."""
    rows: list[list[Cell]] = []
    for joint in () if found.friction is None else found.friction.joints:
        turns = joint.unit == "rad"
        b, c = found.simulated_friction[joint.joint]
        for kind, unit, value, half, simulated in (
            ("viscous", "N m s/rad" if turns else "N s/m", joint.viscous, joint.viscous_half, b),
            ("Coulomb", "N m" if turns else "N", joint.coulomb, joint.coulomb_half, c),
        ):
            interval = Number(None, value - half, value + half)
            rows.append([joint.joint, kind, unit, Number(value), interval, Number(simulated)])
    header = ["joint", "friction", "unit", *numbers("identified", "95 % interval", "in the run")]
    return Table("Friction of the recorded arm and of the run.", header, rows)


def _friction(found: RecordingComparison) -> Section:
    return Section("Friction", _friction_blocks(found))


def _friction_blocks(found: RecordingComparison) -> list[ReportBlock]:
    blocks: list[ReportBlock] = [Text(literal(text)) for text in words.friction_lines(found)]
    if found.friction is None or not found.friction.joints:
        return [Notice("warning", "No friction was identified", literal(" ".join(words.friction_lines(found))))]
    method = (
        "Residual torque $tau - (M dot.double(q) + V + G)$ with the run's model, regressed on $dot(q)$, "
        '$upright("sgn") dot(q)$, a constant of each joint, and the linear model of the masses; all behind a low-pass '
        f"of {quantity(found.friction.frequency, 'Hz')} without delay, rows near standstill left out. The intervals "
        "allow for what these terms leave over to be correlated within half a second."
    )
    return [*blocks, friction(found), _friction_curves(found), Text(method)]


def _metrics(found: RecordingComparison) -> Section:
    name, none = "Metrics of both", "The recording has too few signals for any metric: neither all joints nor the tip."
    if not found.metrics:
        return Section(name, [Text(none)])
    rows = [
        [title(name), name, *(above_rounding(value, unit_of(name) or "1") for value in both)]
        for name, both in found.metrics.items()
    ]
    first, last = found.span
    text = (
        f"Both are computed by the same code, from {quantity(first, 's')} to {quantity(last, 's')}. Speeds of the "
        "recording are differences of its positions behind the low-pass. Its tip, where it is not recorded, "
        "follows from the joints by the run's model. "
    )
    if not found.by_commands:
        text += "A constant delay of the arm is part of the time offset and not of the tracking errors."
    header = ["metric", Column("name on the command line", "code"), *numbers("run", "recording")]
    return Section(name, [Text(text), Table(f"{name}.", header, rows)])


def _made(found: RecordingComparison) -> Section:
    recording = found.recording
    rows = [
        ("recording", recording.path.name),
        ("rows", str(len(recording.t))),
        ("time between rows", quantity(recording.period, "s", digits=4)),
        ("SHA-256", digest_of(recording.path)),
    ]
    columns = [
        [column, signal.words, f"{recording.units[column].factor:.6g}", recording.units[column].unit]
        for signal, column in recording.columns.items()
    ]
    caption = "Columns of the recording, and what makes their numbers SI."
    units = Table(caption, [Column("column", "code"), "signal", *numbers("factor"), "unit"], columns)
    return Section("Provenance", [Provenance(rows), units, provenance([found.run])])


def _of_torques(found: RecordingComparison) -> list[Residual]:
    return [one for one in found.residuals if one.signal.kind == "torque"]


def _torque_curves(found: RecordingComparison) -> Curves:
    """Return each torque of the recording and of the run over time; curves of positions would cover each other."""
    panels = [
        Panel(
            literal(capital(one.signal.words)),
            "time of the run (s)",
            label_with_unit(one.signal.kind, one.unit),
            [
                Series("recorded", one.t, one.recorded, color=_RECORDED),
                Series("run", one.t, one.simulated, "dashed", color=_SIMULATED),
            ],
        )
        for one in _of_torques(found)
    ]
    return Curves("Each recorded torque, and that of the run.", panels, origin=origin(found.run))


def _residual_curves(found: RecordingComparison) -> Curves:
    """Return the recorded signals minus the simulated ones: positions, torques and the tip, each together."""
    groups: dict[tuple[str, str], list[Residual]] = {}
    for one in found.residuals:
        groups.setdefault((one.signal.kind, one.unit), []).append(one)
    panels = [
        Panel(
            f"{capital(kind)}, recorded - run",
            "time of the run (s)",
            label_with_unit("residual", unit),
            [Series(literal(one.signal.of), one.t, one.values) for one in group],
        )
        for (kind, unit), group in groups.items()
    ]
    return Curves("Residuals over time.", panels, origin=origin(found.run))


def _lag_curves(found: RecordingComparison) -> Curves:
    """Return the correlation of the speeds over the time of the recording at which the run begins."""
    offset = found.offset
    best = int(np.argmax(offset.correlations))
    shown = np.unique(
        np.append(spaced_indices(len(offset.lags), _MOST_POINTS), np.arange(max(0, best - 50), best + 50))
    )
    shown = shown[shown < len(offset.lags)]
    found_at = np.full(2, offset.start)
    panel = Panel(
        "Correlation of the speeds",
        "begin of the run in the recording (s)",
        "correlation",
        [
            Series("", offset.lags[shown], offset.correlations[shown], color=_RECORDED),
            Series("", found_at, np.array([min(0.0, float(offset.correlations.min())), 1.0]), "dotted", color=1),
        ],
    )
    caption = "Where the speeds of the recording and of the run correlate best; the dotted line is the time found."
    return Curves(caption, [panel], columns=1, origin=origin(found.run))


def _friction_curves(found: RecordingComparison) -> Curves:
    """Return the residual torque of each joint against its speed, and the friction identified."""
    panels = []
    for joint in () if found.friction is None else found.friction.joints:
        turns = joint.unit == "rad"
        order = np.argsort(joint.speed)
        speed = joint.speed[order]
        line = joint.viscous * speed + joint.coulomb * np.sign(speed)
        gap = int(np.searchsorted(speed, 0.0))  # the line jumps at rest
        x, y = np.insert(speed, gap, np.nan), np.insert(line, gap, np.nan)
        series = [
            Series("residual torque", joint.speed, joint.torque, "points", color=_RECORDED),
            Series("friction", x, y, color=_SIMULATED),
        ]
        label = label_with_unit("torque" if turns else "force", "N m" if turns else "N")
        panels.append(Panel(literal(joint.joint), label_with_unit("speed", f"{joint.unit}/s"), label, series))
    caption = "Torque that the run's model and other masses leave over, against the speed, and the friction identified."
    return Curves(caption, panels, origin=origin(found.run))


SECTIONS = (_differences, _accuracies, _torques, _offset, _friction, _metrics, _made)
"""Sections: functions of the comparison that return a section or None; plug-ins add theirs before the last."""
