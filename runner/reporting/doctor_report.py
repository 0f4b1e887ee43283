"""Report on the inspection of a robot file, with a drawing of the robot."""

from collections.abc import Mapping

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import number
from runner.doctor.examination import Examination
from runner.doctor.finding import GRADES
from runner.reporting.charts.arm import arm_motion
from runner.reporting.document import Document, Notice, Playback, Provenance, Section, Table
from runner.reporting.playback import joint_places, playback_bodies
from runner.reporting.table import Column, numbers
from runner.robots.model import RobotModel

_SWING = 0.3  # rad, or share of the travel, by which each joint is shown
_FRAMES = 24  # for each joint
_SECONDS = 1.5  # for each joint


def doctor_document(found: Examination, versions: Mapping[str, str]) -> Document:
    """Return the report on an examination.

    Args:
        found: The examination.
        versions: Versions of the libraries that made it, by name.
    """
    counts = {grade: sum(f.grade == grade for f in found.findings) for grade in GRADES}
    if found.arm is not None:
        verdict = "fits" if found.arm.has_mass else "fits, with ideal joint position commands"
        drawn = _swings(found, found.arm.model, found.arm.start.home)
        sections = [Section("The robot", (drawn,)), Section("Findings", (_findings(found),))]
        sections.append(Section("Its joints", (_joints(found.arm.model),)))
    else:
        verdict = "is refused"
        notice = Notice("failure", "No model", "The robot cannot be taken until what is refused below is corrected.")
        sections = [Section("The robot", (notice,)), Section("Findings", (_findings(found),))]
    rows = [("file", found.source.name), *versions.items()]
    return Document(
        title=f"Robot {found.name}",
        subtitle=f"{found.source.name}, tip frame: {found.tip}",
        abstract=f"The robot {verdict}.",
        key_numbers=[
            ("that bar the robot", str(counts["refused"]), "refused"),
            ("changed in the copy", str(counts["fixed"]), "fixed"),
            ("good to know", str(counts["note"]), "notes"),
        ],
        sections=[*sections, Section("Made with", (Provenance(rows),))],
        date="",
    )


def _findings(found: Examination) -> Table:
    rows = [[each.grade, each.place, each.text, each.remedy] for each in found.findings]
    return Table(
        "What was found, and what was done or can be.", [Column("grade", "badge"), "where", "what", "done"], rows
    )


def _swings(found: Examination, model: RobotModel, home: FloatArray) -> Playback:
    """Return each joint in turn, swung about home."""
    swing = np.where(model.prismatic, _SWING * np.ptp(model.usual_range, axis=0), _SWING)
    wave = np.sin(np.linspace(0.0, 2.0 * np.pi, _FRAMES, endpoint=False))
    q = np.concatenate([home + np.outer(wave, row) for row in np.diag(swing)])
    q = np.clip(q, *model.position_limits)
    times = np.arange(len(q)) * _SECONDS / _FRAMES
    bodies = playback_bodies(found.urdf, model, q)
    still = arm_motion(model, home[None], [0.0])
    caption = (
        "At the home proposed, and each joint in turn, swung about it; links without simple shapes are drawn as bones."
    )
    return Playback(caption, times, bodies, model.tip_positions(q), None, still, joints=joint_places(model, q))


def _joints(model: RobotModel) -> Table:
    lower, upper = model.position_limits
    limits = zip(lower, upper, model.velocity_limits, model.effort_limits, strict=True)
    rows = []
    for name, unit, values in zip(model.joint_names, model.joint_units, limits, strict=True):
        cells = [number(value) if np.isfinite(value) else "none" for value in values]
        rows.append([name, "slides" if unit == "m" else "turns", *cells])
    header = numbers("lower (rad, m)", "upper (rad, m)", "speed (rad/s, m/s)", "effort (N m, N)")
    return Table("Joints and their limits.", ["joint", "motion", *header], rows)
