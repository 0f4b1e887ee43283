"""Messages for the comparison of a recording with a run, on a terminal and in a report."""

from collections.abc import Iterator
from math import isnan

import numpy as np

from runner.base.quantities import quantity
from runner.recordings.columns_map import Signal
from runner.recordings.compare import RecordingComparison

FIT = (
    "fit: 1 - |recorded - run| / |recorded - its mean|, from the normalised root mean square error of system "
    "identification; 1: the same, 0: the mean would be as good"
)
ONE_LOG = (
    "The intervals describe only this recording: what differs between recordings, such as temperature, load and range "
    "of motion, shows only when several are compared."
)
AMONG_MASSES = (
    "Friction is fitted to the residual torques, the recorded ones less those of the run's model, together with "
    "differences of the links' masses and inertias."
)

WITHOUT_GRAVITY = (
    "The recorded torques are without gravity. Gravity is left out of the run's torques as well; masses cannot be "
    "compared."
)
_BELOW = 1e-3  # of a joint's largest recorded torque: friction nearer to zero is the arithmetic of the fit
BEHIND_GEARS = (
    "The sensors are behind the gears. The friction of the gears and the inertia of the rotors are in neither torque."
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
        text += f"; the time is undetermined: the motion repeats itself, and fits as well with time 0 at {others}"
    if offset.open_ended:
        text += "; the time is undetermined: the differences still decrease where the search ends"
    if found.by_commands:
        text += "; both are aligned by the commanded positions, so that a lag of the arm is not in this time"
    if recording.filled:
        many = len(recording.filled) > 1
        gaps = f"{len(recording.filled)} gap{'s' * many} of up to {quantity(max(recording.filled), 's')}"
        text += f"; {gaps} {'are' if many else 'is'} filled"
    if recording.held and any(signal.kind == "torque" for signal in recording.signals):
        text += (
            f"; torques are taken as held from row to row, so that they count {quantity(recording.torque_shift, 's')} "
            "later (torque: instant in the column map leaves them where they are)"
        )
    return "; ".join([text, *recording.notes])


def lag_lines(found: RecordingComparison) -> Iterator[str]:
    """Yield how much later the joints move than their commands, in the recording and in the run."""
    if found.lags:
        each = ", ".join(
            f"{joint} {_lag(log)}" + ("" if isnan(run) else f" (run {_lag(run)})")
            for joint, (log, run) in found.lags.items()
        )
        yield f"Joints move later than their commands: {each}."


def _lag(lag: float) -> str:
    return quantity(round(lag, 5), "s")  # a hundredth of the usual time between rows


def friction_lines(found: RecordingComparison) -> Iterator[str]:
    """Yield how friction was identified, or why it was not."""
    if found.friction is None:
        yield f"Friction cannot be identified: {found.no_friction}."
        return
    if found.friction.joints:
        if found.recording.holds == "without_gravity":
            yield WITHOUT_GRAVITY
        if found.recording.side == "link":
            yield BEHIND_GEARS
        yield AMONG_MASSES
        yield ONE_LOG
    below = [
        f"{joint.joint} {kind}"
        for joint in found.friction.joints
        for kind, value, half, factor in (
            ("viscous", joint.viscous, joint.viscous_half, np.abs(joint.speed).max()),
            ("Coulomb", joint.coulomb, joint.coulomb_half, 1.0),
        )
        if factor * (value + half) < -_BELOW * np.abs(found.recording.signals[Signal("torque", joint.joint)]).max()
    ]
    if below:
        yield (
            f"Below zero, with the whole interval: {', '.join(below)}. No friction is: the torques are late, of "
            "another kind than the column map says, or hold what the equations lack."
        )
    for reason in found.friction.lacking:
        yield f"Friction cannot be identified of {reason}."
