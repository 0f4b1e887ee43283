"""Comparison of a recording with a run: time alignment, signals, metrics and friction."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.recordings.columns_map import ColumnsMap, Signal, other_units, read_map
from runner.recordings.consistency import check_consistency, measured_arm
from runner.recordings.friction import Friction, identify_friction
from runner.recordings.offset import Offset, find_lag, find_offset
from runner.recordings.recording import FEWEST_ROWS, Recording, read_recording
from runner.recordings.setting import ComparedRun, both_metrics, setting_of
from runner.recordings.smoothing import cutoff, derivative, evenly, low_pass
from runner.robots.model import RobotModel
from runner.store import Run


@dataclass(frozen=True)
class Residual:
    """A signal of the recording and that of the run, at the run's ticks.

    Attributes:
        signal: Which one.
        unit: Its SI unit.
        t: Times of the run, shape (T,), in s.
        recorded: Shape (T,).
        simulated: Shape (T,).
    """

    signal: Signal
    unit: str
    t: FloatArray
    recorded: FloatArray
    simulated: FloatArray

    @property
    def values(self) -> FloatArray:
        """Recorded less simulated, shape (T,)."""
        return self.recorded - self.simulated

    @property
    def mean(self) -> float:
        """Its mean: what another zero of the encoder gives, or another load."""
        return float(self.values.mean())

    @property
    def rms(self) -> float:
        """Its root mean square."""
        return float(np.sqrt(np.mean(self.values**2)))

    @property
    def largest(self) -> float:
        """Its largest magnitude."""
        return float(np.abs(self.values).max())

    @property
    def fit(self) -> float | None:
        r"""One minus the normalised root mean square error; None of a constant signal.

        From system identification (Ljung, System Identification, 2nd edition, 1999), with y the recorded and \hat y the
        simulated signal:

        .. math:: 1 - \frac{|y - \hat y|}{|y - \bar y|}

        It is 1 if both are equal, and 0 if the mean of the recording would be as good an estimate.
        """
        swing = float(np.linalg.norm(self.recorded - self.recorded.mean()))
        return None if swing == 0.0 else 1.0 - float(np.linalg.norm(self.values)) / swing


_SLACK = 0.01  # of a recording's period: a tick so little beyond its ends is covered
_SHORTEST = 2.0  # s, of a recording whose friction is identified: four blocks of friction.py


@dataclass(frozen=True)
class RecordingComparison:
    """A recording and a run.

    Attributes:
        run: The run.
        model: Its model of the arm.
        recording: The recording.
        offset: When the run began on the recording's clock.
        residuals: Each recorded signal and the run's, at the run's ticks.
        metrics: Each metric of the run and of the recording over these ticks, by name; None for no value.
        friction: What was identified; None where nothing could be.
        no_friction: Why nothing could be; empty otherwise.
        simulated_friction: Viscous and Coulomb friction of each joint in the run, by joint.
        lags: How much later than its command each joint moves, by joint, in s: in the recording, and in the run, NaN if
            its desired motion is not one of joints.
        follows_measured: Whether the run follows the recorded positions, so that they say nothing of the model.
        by_commands: Whether the run was aligned by commanded positions, so that a lag of the arm is not in the offset.
    """

    run: Run
    model: RobotModel
    recording: Recording
    offset: Offset
    residuals: Sequence[Residual]
    metrics: Mapping[str, tuple[float | None, float | None]]
    friction: Friction | None
    no_friction: str
    simulated_friction: Mapping[str, tuple[float, float]]
    lags: Mapping[str, tuple[float, float]]
    follows_measured: bool
    by_commands: bool

    @property
    def span(self) -> tuple[float, float]:
        """First and last time of the run that the recording covers, in s."""
        t = self.residuals[0].t
        return float(t[0]), float(t[-1])


def compare_recording(
    run: Run,
    path: Path,
    columns: Path,
    fill_gaps: float = 0.0,
    follows_measured: bool = False,
    examined: Recording | None = None,
) -> RecordingComparison:
    """Compare a recording with a run.

    Args:
        run: The run.
        path: The recording; see read_table.
        columns: What its columns are, YAML; see ColumnsMap.
        fill_gaps: Longest gap of the recording that is filled, in s; 0 for none.
        follows_measured: Whether the run follows the recorded positions.
        examined: The recording, where it was read and checked to make the run; None reads it.

    Raises:
        RunnerError: if a file cannot be read or does not fit the run; names what is wrong, and its line or column.
    """
    setting = setting_of(run)
    trace = setting.trace
    recording = examined or _checked(setting, run, path, columns, fill_gaps)
    moving = [signal for signal in recording.signals if signal.kind in ("position", "tip")]
    if not moving:
        raise RunnerError(f"{columns}: columns: needs the position of a joint, or a coordinate of the tip")
    followed = setting.desired_joints is not None and not follows_measured
    commands = recording.of_kind("reference") if followed else []
    aligned = commands or moving
    offset = find_offset(
        recording.t,
        np.column_stack([recording.signals[signal] for signal in aligned]),
        trace.t,
        np.column_stack([setting.signal(signal) for signal in aligned]),
        [f"columns.{recording.columns[signal]}" for signal in aligned],
    )
    ticks, at = _covered(recording, trace.t, offset)
    middle = at + 0.5 * float(np.median(np.diff(trace.t)))  # the run's torques act from tick to tick
    recorded = {
        signal: recording.torque_at(signal, middle) if signal.kind == "torque" else evenly(recording.t, values, at)
        for signal, values in recording.signals.items()
        if signal.kind in ("position", "torque", "tip")
    }
    whole_torques = recording.holds != "without_gravity" and recording.side == "motor"
    torques = setting.trace.tau if whole_torques else setting.torques(recording.holds, recording.side)
    simulated = {
        signal: (torques[:, trace.joint_names.index(signal.of)] if signal.kind == "torque" else setting.signal(signal))[
            ticks
        ]
        for signal in recorded
    }
    questions = list(other_units(recorded, simulated, recording.columns, recording.units))
    if questions:
        raise RunnerError(f"{columns}: {'; '.join(questions)}")
    units = {signal: recording.units[column].unit for signal, column in recording.columns.items()}
    q = recording.positions(trace.joint_names)
    friction, reason = friction_of(setting.config.arm.model, recording)
    return RecordingComparison(
        run=run,
        model=setting.config.arm.model,
        recording=recording,
        offset=offset,
        residuals=[Residual(s, units[s], trace.t[ticks], recorded[s], simulated[s]) for s in recorded],
        metrics=both_metrics(setting, ticks, recorded, None if q is None else _speeds(recording, q, at), whole_torques),
        friction=friction,
        no_friction=reason,
        simulated_friction=_simulated_friction(run, trace.joint_names),
        lags=dict(_lags(recording, setting)),
        follows_measured=follows_measured,
        by_commands=bool(commands),
    )


def _checked(setting: ComparedRun, run: Run, path: Path, columns: Path, fill_gaps: float) -> Recording:
    """Return a recording whose signals do not contradict each other."""
    said, factors = read_map(columns, setting.trace.joint_names, setting.trace.joint_units)
    _check_payload(said, run, columns)
    recording = read_recording(path, said, factors, fill_gaps)
    verdict = check_consistency(setting.config.arm.model, recording)
    if verdict.questions:
        raise RunnerError(f"{columns}: {' '.join(verdict.questions)}")
    return replace(recording, notes=(*recording.notes, *verdict.notes))


def _check_payload(said: ColumnsMap, run: Run, columns: Path) -> None:
    carried, wanted = run.config["robot"]["payload"], said.payload
    if wanted is not None and (wanted.mass, wanted.position) != (carried["mass"], list(carried["position"])):
        raise RunnerError(
            f"{columns}: payload: the arm carried {wanted.mass:g} kg at {wanted.position}, in the run "
            f"{carried['mass']:g} kg at {list(carried['position'])}. Make the run with {' '.join(wanted.overrides)}."
        )


def _lags(recording: Recording, setting: ComparedRun) -> Iterator[tuple[str, tuple[float, float]]]:
    """Yield how much later each joint moves than its command, in the recording and in the run, in s."""
    trace = setting.trace
    for command in recording.of_kind("reference"):
        position = Signal("position", command.of)
        own = recording.signals.get(position)
        if own is None or not np.ptp(recording.signals[command]):
            continue
        wanted = setting.desired_joints
        place = trace.joint_names.index(command.of)
        run = np.nan if wanted is None else find_lag(trace.t, trace.q[:, place], wanted[:, place])
        yield command.of, (find_lag(recording.t, own, recording.signals[command]), run)


def _covered(recording: Recording, t: FloatArray, offset: Offset) -> tuple[slice, FloatArray]:
    """Return the ticks of a run that a recording covers, and their times on its clock, in s."""
    at = t + offset.start
    slack = _SLACK * recording.period
    first, end = (int(np.searchsorted(at, edge)) for edge in (recording.t[0] - slack, recording.t[-1] + slack))
    if end - first < FEWEST_ROWS:
        raise RunnerError(
            f"{recording.path}: too short: it covers {end - first} ticks of the run; needed: {FEWEST_ROWS} or more"
        )
    return slice(first, end), np.clip(at[first:end], recording.t[0], recording.t[-1])


def _even(recording: Recording, signals: FloatArray, first: float = 0.0) -> tuple[FloatArray, FloatArray]:
    """Return even times from a first one to the last row, and signals at them, shape (N, n)."""
    count = int((recording.duration - first) / recording.period + 1e-6) + 1
    times = np.minimum(first + recording.period * np.arange(count), recording.t[-1])
    return times, evenly(recording.t, signals, times)


def _speeds(recording: Recording, q: FloatArray, at: FloatArray) -> FloatArray:
    times, even = _even(recording, q)
    smooth = low_pass(even, recording.period, cutoff(recording.period))
    return evenly(times, derivative(smooth, recording.period), np.clip(at, times[0], times[-1]))


def friction_of(model: RobotModel, recording: Recording) -> tuple[Friction | None, str]:
    """Return the friction of a recorded arm, or why it cannot be identified."""
    joints = model.joint_names
    q = recording.positions(joints)
    if q is None:
        missing = [joint for joint in joints if Signal("position", joint) not in recording.signals]
        return None, f"no position of {', '.join(missing)} is recorded"
    signals = [Signal("torque", joint) for joint in joints]
    if not recording.signals.keys() & set(signals):
        return None, "no torque is recorded"
    if recording.duration < _SHORTEST:
        return None, f"the recording lasts {recording.duration:.3g} s; needed: {_SHORTEST:g} s or more"
    times, even = _even(recording, q, recording.torque_shift)
    torques = [
        recording.torque_at(signal, times) if signal in recording.signals else np.full(len(times), np.nan)
        for signal in signals
    ]
    arm, rotors = measured_arm(model, recording), recording.side == "motor"
    return identify_friction(arm, even, np.column_stack(torques), recording.period, rotors), ""


def _simulated_friction(run: Run, joints: Sequence[str]) -> dict[str, tuple[float, float]]:
    friction = run.config["plant"].get("friction", {})
    viscous, coulomb = (np.broadcast_to(friction.get(key, 0.0), len(joints)) for key in ("viscous", "coulomb"))
    return {joint: (float(b), float(c)) for joint, b, c in zip(joints, viscous, coulomb, strict=True)}
