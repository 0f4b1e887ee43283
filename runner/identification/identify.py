"""Identification of an arm by examined logs: choice of friction and cut-off, fit and its checks."""

from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from runner.base import progress
from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.identification.checks import SecondMethod, find_flags, second_method
from runner.identification.examination import (
    ArmLogs,
    IdentificationExamination,
    check_intervals,
    columns_in_sum,
    find_untold,
    find_weak,
    rows_of,
    usual_cutoff,
)
from runner.identification.fit import Fit, constant_name, fit_logs, name_of
from runner.identification.friction_kinds import KINDS, SHAPED, TERMS, FrictionKind, term_unit
from runner.identification.held_out import HeldOut, file_share, joint_weights, predict_held_out
from runner.identification.log_rows import LogRows
from runner.identification.parameters import ParameterSum
from runner.identification.physical import describe_bodies, nearest_bodies
from runner.identification.prior import combine_with_prior, prior_widths
from runner.identification.result import (
    Alternative,
    Identification,
    IdentifiedParameter,
    JointAccuracy,
    LogFacts,
    place_of,
)
from runner.recordings import digest_of
from runner.robots.model import RobotModel

_SHOWN = 300  # rows of a joint in the result
_BETTER = 0.01  # of the held-out error, by which a further term must lower it
_DEVIATIONS = 2.0  # of the gain over the stretches, by which a further term must lower it
_FACTORS = (0.5, 2.0)  # times the usual cut-off, which are tried
_FASTEST = 0.2  # of the rate of rows: the highest cut-off


def identify(
    examined: IdentificationExamination,
    outputs: Path,
    command: str,
    kind: FrictionKind | None = None,
    frequency: float | None = None,
    prior: float | None = None,
) -> Identification:
    """Return the identification of an arm; it is not stored yet.

    Args:
        examined: The logs.
        outputs: Outputs folder.
        command: Command that makes it.
        kind: Kind of friction; None for the one that predicts unseen torques best.
        frequency: Cut-off on both sides of the equations, in Hz; None for the one that predicts unseen torques best.
        prior: Width of the file's values, as a share of them, that are combined with the logs; None for none.

    Raises:
        RunnerError: if the cut-off does not fit the rate of the rows.
    """
    question, sums, usual = examined.question, examined.sums, usual_cutoff(examined.question)
    fastest = min(_FASTEST / recording.period for recording in question.recordings)
    if frequency is not None and not 0.5 <= frequency <= fastest:
        raise RunnerError(f"--cutoff: {frequency:g} Hz does not fit. Allowed: 0.5 to {fastest:.3g} Hz for these rows.")
    judged = examined.rows
    weights = joint_weights(examined.fit)
    progress.begin("choosing friction and cut-off")
    tried: list[tuple[Fit, HeldOut, Sequence[LogRows], float]] = []

    def attempt(own: FrictionKind, rows: Sequence[LogRows], at: float) -> int:
        fit = examined.fit if own == "coulomb" and rows is judged else fit_logs(rows, own, currents=question.currents)
        tried.append((fit, predict_held_out(fit, judged, weights), rows, at))
        return len(tried) - 1

    first = judged if frequency is None else rows_of(question, sums, frequency)
    for own in (kind,) if kind else KINDS:
        attempt(own, first, usual if frequency is None else frequency)
    best = _chosen([held for _, held, _, _ in tried])
    if frequency is None:
        places = [best]
        for factor in _FACTORS:
            if (at := factor * usual) <= fastest:
                places.append(attempt(tried[best][0].state.layout.kind, rows_of(question, sums, at), at))
        best = places[_chosen([tried[place][1] for place in places])]
    fit, held, rows, at = tried[best]
    check_intervals(question, fit)
    second = second_method(fit)
    follows = _follows(fit, rows, question.model)
    alternatives = [
        Alternative(
            each.state.layout.kind, each_at, error.share(), float(error.squares.mean()),
            follows if number == best else _follows(each, each_rows, question.model), number == best,
        )
        for number, (each, error, each_rows, each_at) in enumerate(tried)
    ]  # fmt: skip
    layout = fit.state.layout
    digests = [digest_of(recording.path) for recording in question.recordings]
    said = (digests, [one.model_dump() for one in question.said], question.urdf, kind, frequency, prior)
    base = _file_values(question, sums)
    untold = list(find_untold(question, sums, fit))
    if prior is None:
        wide = set(find_weak(fit))
        determined = [column for column in fit.taken if column != layout.delay and column not in wide]
        values = [_parameter(question, sums, fit, column, second, base) for column in determined]
    else:
        values = list(_with_prior(question, sums, fit, second, base, prior))
        untold = [one for one in untold if one.name not in {each.name for each in values}]
    return Identification(
        folder=place_of(outputs, said),
        command=command,
        robot=question.robot,
        urdf=question.urdf,
        side=question.recordings[0].side,
        currents=[joint for joint in question.constants if constant_name(joint) not in {one.name for one in values}],
        kind=layout.kind,
        forced=kind is not None,
        frequency=at,
        parameters=values,
        untold=untold,
        joints=[_accuracy(question, rows, fit, held, base, joint) for joint in np.unique(held.system.joint).tolist()],
        held_out=held.share(),
        file=file_share(held.system, base),
        alternatives=alternatives,
        logs=[
            LogFacts(recording.path.name, digest, len(recording.t), recording.duration, recording.period,
                     one.warmth, list(notes))
            for recording, digest, one, notes in
            zip(question.recordings, digests, question.said, examined.notes, strict=True)
        ],
        follows=follows,
        payloads=examined.payloads,
        delay=fit.state.delay,
        delay_half=float(half) if np.isfinite(half := fit.halves[layout.delay]) else None,
        block=fit.block,
        rank=len(fit.taken) - (layout.delay in fit.taken),
        condition=fit.condition,
        shapes=(fit.state.shapes * rows[0].motion.fastest).tolist() if layout.kind in SHAPED else [],
        bodies=_bodies(question, sums, fit, second),
        prior=prior,
        date=datetime.now(UTC).date().isoformat(),
    )  # fmt: skip


def _chosen(held: Sequence[HeldOut]) -> int:
    """Return the first error than which none is clearly lower: by two deviations over the stretches, and by 1 %."""
    best = min(held, key=lambda each: float(each.squares.mean()))
    return next(place for place, each in enumerate(held) if not _is_clear(each.squares - best.squares, each.squares))


def _is_clear(gain: FloatArray, of: FloatArray) -> bool:
    deviation = float(gain.std(ddof=1) / np.sqrt(len(gain))) if len(gain) > 1 else np.inf
    return bool(gain.mean() > max(_DEVIATIONS * deviation, _BETTER * float(of.mean())))


def _follows(fit: Fit, rows: Sequence[LogRows], model: RobotModel) -> list[str]:
    return [
        f"{flag.follows} at {model.joint_names[flag.joint]} (t {flag.t:.1f}, chance up to {flag.limit:.1f})"
        for flag in find_flags(fit, rows)
    ]


def _file(question: ArmLogs, sums: Sequence[ParameterSum]) -> FloatArray:
    """Return the parameters of the robot's file that are in the sums."""
    model = question.model
    armature = model.armature if question.rotors else np.zeros(model.nq)
    return np.concatenate([model.inertial_parameters, armature])[: len(sums[0].factors)]


def _file_values(question: ArmLogs, sums: Sequence[ParameterSum]) -> FloatArray:
    full = _file(question, sums)
    return np.array([float(each.factors @ full) for each in sums])


def _bodies(question: ArmLogs, sums: Sequence[ParameterSum], fit: Fit, second: SecondMethod) -> str:
    """Return a sentence on the bodies that have the values that the logs determine."""
    base = fit.state.layout.base
    told = [(place, column) for place, column in enumerate(fit.taken) if column < base and second.halves[column] > 0.0]
    if not told:
        return ""
    places, columns = map(list, zip(*told, strict=True))
    factors = fit.factors[places, :base] @ np.array([each.factors for each in sums])
    misses = nearest_bodies(
        factors, fit.state.values[columns], second.halves[columns], _file(question, sums), question.model.nq
    )
    return describe_bodies([sums[column].name for column in columns], misses)


def _with_prior(
    question: ArmLogs, sums: Sequence[ParameterSum], fit: Fit, second: SecondMethod, base: FloatArray, width: float
) -> Iterator[IdentifiedParameter]:
    """Yield the parameters by the logs and by the robot's file; the logs' own value stands where they tell it."""
    layout, joints = fit.state.layout, question.model.joint_names
    names, factors = [each.name for each in sums], np.array([each.factors for each in sums])
    widths = prior_widths(_file(question, sums), question.model.nq, width)
    found = combine_with_prior(fit, second.halves, base, (factors * widths**2) @ factors.T)
    for column in range(layout.delay):
        if not np.isfinite(found.halves[column]):
            continue
        told = column in fit.taken and bool(np.isfinite(second.halves[column]))
        value, share = float(found.values[column]), float(found.shares[column])
        at, size, file = _scale(question, fit, column, base)
        yield IdentifiedParameter(
            name_of(layout, column, names, joints), _unit(question, sums, fit, column), at + size * value,
            abs(size) * float(found.halves[column]),
            abs(size) * float(fit.white[column] if told else found.halves[column]),
            file, at + size * (float(second.values[column]) if told else value),
            told and bool(second.differs[column]), told and bool(fit.spread[column]), (),
            share if column < layout.base else None,
        )  # fmt: skip


def _scale(question: ArmLogs, fit: Fit, column: int, base: FloatArray) -> tuple[float, float, float | None]:
    """Return a parameter for a column's value of 0, its change for 1, and its value in the robot's file or the map."""
    layout = fit.state.layout
    if column < layout.constants:
        return 0.0, 1.0, float(base[column]) if column < layout.base else None
    joint = layout.currents[column - layout.constants]
    in_map = question.constants[question.model.joint_names[joint]]
    found = in_map * float(fit.state.scales[joint])
    return found, found, in_map


def _unit(question: ArmLogs, sums: Sequence[ParameterSum], fit: Fit, column: int) -> str:
    layout = fit.state.layout
    if column < layout.base:
        return sums[column].unit
    if column >= layout.constants:
        return "N/A" if question.model.prismatic[layout.currents[column - layout.constants]] else "N m/A"
    joint, term = divmod(column - layout.base, len(TERMS[layout.kind]))
    return term_unit(TERMS[layout.kind][term], bool(question.model.prismatic[joint]))


def _parameter(
    question: ArmLogs, sums: Sequence[ParameterSum], fit: Fit, column: int, second: SecondMethod, base: FloatArray,
) -> IdentifiedParameter:  # fmt: skip
    layout, joints = fit.state.layout, question.model.joint_names
    names = [each.name for each in sums]
    at, size, file = _scale(question, fit, column, base)
    place = fit.taken.index(column)
    others = [other for other in range(layout.delay) if other not in fit.taken and place in columns_in_sum(fit, other)]
    return IdentifiedParameter(
        name_of(layout, column, names, joints), _unit(question, sums, fit, column),
        at + size * float(fit.state.values[column]), abs(size) * float(second.halves[column]),
        abs(size) * float(fit.white[column]), file, at + size * float(second.values[column]),
        bool(second.differs[column]), bool(fit.spread[column]),
        [name_of(layout, each, names, joints) for each in others],
    )  # fmt: skip


def _accuracy(
    question: ArmLogs, rows: Sequence[LogRows], fit: Fit, held: HeldOut, base: FloatArray, joint: int
) -> JointAccuracy:
    system = fit.system
    own = np.flatnonzero(system.joint == joint)
    used = own[fit.weights[own] > 0.0]
    shown = used[np.unique(np.linspace(0, len(used) - 1, min(_SHOWN, len(used))).astype(int))] if len(used) else used
    signals: Mapping[str, list[FloatArray]] = {"position": [], "speed": []}
    ends = np.cumsum([0, *(recording.duration for recording in question.recordings)])
    for each in rows:
        signals["position"].append(each.motion.q[each.motion.kept, joint])
        signals["speed"].append(each.speed[:, joint])

    def values(parts: Sequence[FloatArray]) -> list[float]:
        return [float(f"{parts[log][row]:.6g}") for log, row in zip(system.log[shown], system.row[shown], strict=True)]

    layout = fit.state.layout
    load = system.X[shown, : layout.base] @ fit.state.values[: layout.base] + system.carried[shown]
    return JointAccuracy(
        question.model.joint_names[joint], question.model.joint_units[joint], held.share(joint),
        file_share(held.system, base, joint), len(used), 1.0 - float(np.mean(system.moving[own])),
        float(np.mean(fit.outside[used])) if len(used) else 0.0,
        [float(f"{ends[log] + at:.6g}") for log, at in zip(system.log[shown], system.time[shown], strict=True)],
        values(signals["position"]), values(signals["speed"]),
        [float(f"{each:.6g}") for each in load], [float(f"{each:.6g}") for each in fit.rest[shown]],
    )  # fmt: skip
