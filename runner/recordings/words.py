"""Messages and table rows for the comparison of a recording with a run, on a terminal and in a report."""

from collections.abc import Callable, Iterator

from runner.base.quantities import quantity
from runner.plugins.metric_units import unit_of
from runner.recordings.compare import RecordingComparison

Number = Callable[[float | None], str]

RESIDUAL_HEADER = ["recorded - run", "unit", "mean", "rms", "largest", "fit"]
FRICTION_HEADER = ["joint", "friction", "unit", "identified", "95 % interval", "in the run"]
FIT = (
    "fit: 1 - |recorded - run| / |recorded - its mean|, from the normalised root mean square error of system "
    "identification; 1: the same, 0: the mean would be as good"
)
ONE_LOG = (
    "The intervals are of this recording alone: what differs between recordings, such as temperature, load and range "
    "of motion, shows only when several are compared."
)
AMONG_MASSES = (
    "Friction is fitted to the residual torques, the recorded ones less those of the run's model, together with "
    "differences of the links' masses and inertias."
)


def aligned_text(found: RecordingComparison) -> str:
    """Return when the run begins in the recording, and what both cover."""
    recording, offset = found.recording, found.offset
    first, last = found.span
    start = round(offset.start, 7)  # what it was searched to
    after = "after" if start >= 0.0 else "before"
    text = (
        f"the run's time 0 is {quantity(abs(start), 's', digits=5)} {after} the recording's first row; rows are "
        f"{quantity(recording.period, 's')} apart; compared from {quantity(first, 's')} to {quantity(last, 's')}"
    )
    if offset.rivals:
        others = ", ".join(quantity(rival, "s", digits=5) for rival in offset.rivals)
        text += f"; the motion repeats itself: it fits nearly as well with time 0 at {others}"
    if recording.filled:
        text += f"; {len(recording.filled)} gaps of up to {quantity(max(recording.filled), 's')} are filled"
    if recording.held and any(signal.kind == "torque" for signal in recording.signals):
        text += (
            f"; torques are taken as held from row to row, so that they count {quantity(recording.torque_shift, 's')} "
            "later (torque: instant in the column map leaves them where they are)"
        )
    return text


def residual_rows(found: RecordingComparison, number: Number) -> list[list[str]]:
    """Return a row of RESIDUAL_HEADER for each signal."""
    return [
        [residual.signal.words, residual.unit, *map(number, (residual.mean, residual.rms, residual.largest)),
         "-" if residual.fit is None else f"{residual.fit:.4f}"]
        for residual in found.residuals
    ]  # fmt: skip


def metric_rows(found: RecordingComparison, number: Number) -> list[list[str]]:
    """Return name, unit, value of the run and of the recording of each metric."""
    return [[name, unit_of(name) or "", number(run), number(recorded)]
            for name, (run, recorded) in found.metrics.items()]  # fmt: skip


def friction_lines(found: RecordingComparison) -> Iterator[str]:
    """Yield how friction was identified, or why it was not."""
    if found.friction is None:
        yield f"Friction cannot be identified: {found.no_friction}."
        return
    if found.friction.joints:
        yield AMONG_MASSES
        yield ONE_LOG
    for reason in found.friction.lacking:
        yield f"Friction cannot be identified of {reason}."


def friction_rows(found: RecordingComparison, number: Number) -> list[list[str]]:
    """Return a row of FRICTION_HEADER for viscous and one for Coulomb friction of each joint."""
    rows = []
    for joint in () if found.friction is None else found.friction.joints:
        turns = joint.unit == "rad"
        b, c = found.simulated_friction[joint.joint]
        for kind, unit, value, half, simulated in (
            ("viscous", "N m s/rad" if turns else "N s/m", joint.viscous, joint.viscous_half, b),
            ("Coulomb", "N m" if turns else "N", joint.coulomb, joint.coulomb_half, c),
        ):
            interval = f"{number(value - half)} to {number(value + half)}"
            rows.append([joint.joint, kind, unit, number(value), interval, number(simulated)])
    return rows
