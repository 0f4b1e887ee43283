"""Messages on an identification, for a terminal and a report: the answer first, then what is open."""

from collections.abc import Iterator, Sequence

from runner.base.quantities import quantity
from runner.identification.examination import IdentificationExamination
from runner.identification.fit import constant_name
from runner.identification.friction_kinds import WORDS
from runner.identification.result import Identification, IdentifiedParameter

BEHIND_GEARS = (
    "The sensors are behind the gears: rotor inertias and the friction of the gears are not in these torques. What is "
    "called friction here acts between the sensors and the links."
)
_KNOWN, _ROUGH = 0.1, 0.5  # half-width over value
_FEW = 4


def per_cent(share: float) -> str:
    """Return a share in per cent, with two digits where it is above 1 %."""
    return f"{100.0 * share:.{0 if share > 0.0995 else 1 if share > 0.00095 else 2}f} %"


def answer_lines(found: Identification) -> Iterator[str]:
    """Yield the answer: accuracy on unseen torques, what is known, what is not, and what speaks against it."""
    worst = max(found.joints, key=lambda joint: joint.held_out)
    yield (
        f"Torques that the fit has not seen are predicted to {per_cent(found.held_out)} of their rms "
        f"(worst: {worst.joint}, {per_cent(worst.held_out)}); the robot's file misses {per_cent(found.file)}."
    )
    known = [one for one in found.parameters if one.half <= _KNOWN * abs(one.value)]
    rough = [one for one in found.parameters if _KNOWN * abs(one.value) < one.half <= _ROUGH * abs(one.value)]
    yield (
        "The logs determine no parameter."
        if not found.parameters
        else (
            f"{len(known)} of {len(found.parameters)} determined parameters are known within 10 %, {len(rough)} more "
            f"within 50 %; the interval of the others is wider than half of their value."
        )
    )
    if found.prior is not None:
        shares = [(one.prior_share, one.name) for one in found.parameters if one.prior_share is not None]
        alone = [name for share, name in sorted(shares, reverse=True) if share > _ROUGH]
        yield (
            f"Values are combined with those of the robot's file, {per_cent(found.prior)} wide, as asked for; unseen "
            f"torques are predicted without them. More than half of {len(alone)} values is the file's"
            f"{f': {_few(alone)}' if alone else ''}."
        )
    if found.untold:
        yield f"Not determined: {_few([one.name for one in found.untold])}."
    if found.bodies:
        yield found.bodies
    yield from _constants(found)
    yield from doubts(found)


def _constants(found: Identification) -> Iterator[str]:
    """Yield the torque constants that known payloads determine."""
    own = [one for one in found.parameters if one.name.startswith(constant_name(""))]
    if own:
        values = [
            f"{one.name.removeprefix(constant_name(''))} {one.value:.4g} ± {one.half:.2g} (map: {one.file:.4g})"
            for one in own
        ]
        yield f"Torque constants in {own[0].unit} from the known payloads: {'; '.join(values)}."


def doubts(found: Identification) -> Iterator[str]:
    """Yield what speaks against the model or its intervals."""
    if found.follows:
        yield (
            f"{WORDS[found.kind].capitalize()} does not describe the arm: what is left over follows "  # type: ignore[index]
            f"{'; '.join(found.follows[:_FEW])}."
        )
    differing = [one.name for one in found.parameters if one.differs]
    if differing:
        yield (
            f"Ordinary least squares gives other values than chance explains for {_few(differing)}; the equations of "
            "the joints contradict each other there, and the intervals contain both values."
        )
    negative = [one for one in found.parameters if _is_impossible(one)]
    if negative:
        yield (
            f"Impossible in sign, with the whole interval: {_few([one.name for one in negative])}. No bound was used: "
            "the torques hold something that the equations lack."
        )
    yield from found.payloads
    yield from _of_logs(found)


def _is_impossible(one: IdentifiedParameter) -> bool:
    below = one.value + one.half < 0.0
    return below and (one.name.startswith(("viscous", "coulomb", "sigmoid", "Ia")) or _is_inertia(one.name))


def _is_inertia(name: str) -> bool:
    return len(name) < 6 and name.startswith("I") and name.endswith(("xx", "yy", "zz"))


def _of_logs(found: Identification) -> Iterator[str]:
    if len(found.logs) == 1:
        yield (
            "One log knows nothing of what differs between logs: temperature first of all, then load and range of "
            "motion. Give several."
        )
    else:
        spread = [one.name for one in found.parameters if one.spread]
        if spread:
            yield f"The logs differ by more than their own intervals explain in {_few(spread)}; the intervals hold it."
    warmth = {one.warmth for one in found.logs}
    if len(warmth) == 1 and (known := next(iter(warmth))) is not None:
        other = "warm" if known == "cold" else "cold"
        yield f"All logs are of a {known} arm; friction of a {other} one is not known."
    if found.side == "link":
        yield BEHIND_GEARS
    if found.currents:
        yield (
            f"The torques of {', '.join(found.currents)} are currents times the constant of the column map: each mass, "
            "inertia and friction scales with it. Logs with two known payloads determine it."
        )


def method_lines(found: Identification) -> Iterator[str]:
    """Yield how the fit was made."""
    yield (
        f"Friction: {WORDS[found.kind]}"  # type: ignore[index]
        f"{', as asked for' if found.forced else ', chosen by the error on unseen torques'}. Cut-off "
        f"{quantity(found.frequency, 'Hz')}; rank {found.rank}; condition number {found.condition:.3g}."
    )
    late = "late" if found.delay >= 0.0 else "early"
    width = "not known how exactly" if found.delay_half is None else f"± {quantity(found.delay_half, 's')}"
    told = (
        "The logs do not determine the delay of the torques"
        if found.delay_half is None and found.delay == 0.0
        else f"The torques are {quantity(abs(found.delay), 's')} {late} ({width})"
    )
    yield f"{told}. Residuals may be correlated within {quantity(found.block, 's')}."
    for log in found.logs:
        notes = "; ".join(log.notes)
        yield (
            f"{log.name}: {log.rows:,} rows, {quantity(log.duration, 's')}, {quantity(log.period, 's')} apart"
            f"{f'; {notes}' if notes else ''}."
        )


def examination_lines(found: IdentificationExamination) -> Iterator[str]:
    """Yield what logs can determine, what not and which motion would, and what is unusual about them."""
    question, fit = found.question, found.fit
    determined = len(fit.taken) - (fit.state.layout.delay in fit.taken)
    yield (
        f"{determined} of {fit.state.layout.delay} parameters can be told apart: {len(found.sums)} sums of masses, "
        f"inertias{' and rotor inertias' if question.rotors else ''}, the rest friction"
        f"{' and torque constants' if question.currents else ''}."
    )
    for one in found.untold:
        yield f"not determined: {one.name} ({one.reason}). To determine it, {one.motion}."
    if not question.rotors:
        yield BEHIND_GEARS
    if question.currents:
        joints = ", ".join(question.model.joint_names[place] for place in question.currents)
        yield f"torques of {joints}: currents times a constant, which the known payloads determine"
    elif question.constants:
        yield f"torques of {', '.join(question.constants)}: currents times a constant, with which all parameters scale"
    held = "held from row to row" if question.recordings[0].held else "instant"
    yield f"torques: with gravity, {question.recordings[0].side} side, {held}"
    for recording, rows, notes in zip(question.recordings, found.rows, found.notes, strict=True):
        rest = 1.0 - rows.moving.mean()
        text = "; ".join([f"{per_cent(float(rest))} of the rows are near standstill and not in the fit", *notes])
        yield f"{recording.path.name}: {len(recording.t):,} rows, {quantity(recording.duration, 's')}; {text}"
    yield from found.payloads


def _few(names: Sequence[str]) -> str:
    more = f" and {len(names) - _FEW} more" if len(names) > _FEW else ""
    return f"{', '.join(names[:_FEW])}{more}"
