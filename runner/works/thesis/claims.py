"""The thesis' numbers with their verdicts."""

from collections.abc import Mapping

from runner.claims import CONTRADICTION, FACTOR, Bound, PublishedClaim, judge, load_claims
from runner.reporting.document import Block, Claim, Section, Table, Text
from runner.reporting.document import Finding as Verdict
from runner.reporting.findings import Finding, finding
from runner.reporting.job import PRESETS
from runner.reporting.measured import Measured
from runner.reporting.quantities import quantity, ranged, spread
from runner.reporting.run_values import measured, median
from runner.reporting.words import PRESET
from runner.store import Run


def claims_section(runs: Mapping[str, Run]) -> Section:
    """Return the verdicts on the numbers of chapters 3 to 5, as a table and one by one."""
    claims = [(claim, _findings(claim, runs)) for claim in load_claims("thesis")]
    rows = [
        [str(claim.number), claim.statement, _printed(claim), *(f"{f.measured}: {f.verdict}" for f in findings)]
        for claim, findings in claims
    ]
    blocks: list[Block] = [
        Text(
            f"A printed value holds when the median of 40 simulated repetitions lies within a factor of {FACTOR} of "
            "it. The simulation is better when its median is smaller than that, and worse when it is larger. The "
            f"thesis {CONTRADICTION} where another number that it prints speaks against this one. A printed range is "
            "taken as the range over the axes; its upper end is compared with the worst axis."
        ),
        Text(
            f"Each number is simulated under two presets. The first, {PRESET['as_reported']} (as_reported on the "
            "command line), is fitted to the printed numbers, as the thesis' code is not published: three free "
            "choices for a single arm (no gravity term, no feedforward, $t_f = 3$ s) and four more for the combined "
            "one (each stage simulated for itself, with a base that does not turn; the Macro sent to the tip's goal, "
            "the Mini following a series of goals). That it meets a number says that these choices explain it, not "
            f"that the thesis made them. The second, {PRESET['sound']} (sound on the command line), has no free "
            "choice: it is what the thesis' own equations (3.32) and (3.40) say, on the coupled arm, with the same "
            "$t_f$. Both take the law as printed, without damping near singular postures."
        ),
        _what_falls(runs),
        Table(
            "Verdicts, with median (smallest to largest) of 40 repetitions.",
            ["claim", "statement", "printed", *PRESET.values()],
            rows,
        ),
        *(_block(claim, findings, runs) for claim, findings in claims),
    ]
    return Section("Verdict on every number", blocks)


_FALL = {
    2: 10.0,
    4: 50.0,
    6: 300.0,
    7: 80.0,
    11: 7.0,
    12: 5.0,
    15: 4.0,
    16: 12.0,
    17: 10.0,
}  # at least, by so many times
_STAY = {3: "the torque limit", 9: "the encoders", 13: "the torque limit", 14: "the encoders"}


def _what_falls(runs: Mapping[str, Run]) -> Finding:
    """Return which of the printed errors the full equations make smaller, and by how much."""
    errors = {claim.number: claim for claim in load_claims("thesis") if claim.unit == "m"}
    shares = {number: _fall(claim, runs) for number, claim in errors.items()}
    fall = ", ".join(f"{shares[number]} (claim {number})" for number in _FALL)
    stay = " and ".join(
        f"by {why} in claims {' and '.join(str(number) for number in _STAY if _STAY[number] == why)}"
        for why in dict.fromkeys(_STAY.values())
    )
    return finding(
        "The full equations make nine of the thirteen errors smaller, and four not",
        f"Error as reported over error with the full equations: {fall}. The other four are set {stay}, which neither "
        "preset moves.",
        *(shares[number] >= least for number, least in _FALL.items()),
        *(shares[number].near(1.0, 0.15) for number in _STAY),
    )


def _fall(claim: PublishedClaim, runs: Mapping[str, Run]) -> Measured:
    as_reported, sound = (
        measured(runs[f"{_figure(claim.experiment)}/{preset}"], claim.metric, f"claim {claim.number}, {preset}")
        for preset in PRESETS
    )
    return as_reported / sound


def _block(claim: PublishedClaim, findings: list[Verdict], runs: Mapping[str, Run]) -> Claim:
    reason = claim.reason
    if claim.bound is not None:
        times = " and ".join(
            f"{quantity(_scaled_median(claim.bound, preset, runs), claim.unit)} ({PRESET[preset]})"
            for preset in PRESETS
        )
        reason = f"{claim.bound.reason} A tenth of the simulated Macro's median is {times}."
    if claim.metric == "steady_state_error":
        late = (_late(claim, preset, runs) for preset in PRESETS)
        reason = " ".join(text for text in (reason, *late) if text)
    command = f"runner experiment={claim.experiment} preset={PRESETS[0]}"
    return Claim(str(claim.number), claim.statement, claim.place, _printed(claim), findings, reason, command)


def _late(claim: PublishedClaim, preset: str, runs: Mapping[str, Run]) -> str:
    """Return how many repetitions have not settled when the error at rest is taken; nothing where all have."""
    run = runs[f"{_figure(claim.experiment)}/{preset}"]
    band = float(run.config["robot"]["settling_band"])
    errors = run.metrics.get("steady_state_error", {"values": ()})["values"]
    late = sum(1 for error in errors if error is not None and error > band)
    if not late:
        return ""
    told = f"{late} of {len(errors)} repetitions ({PRESET[preset]})"
    return f"{told} are beyond {quantity(band, 'm')} in the last half second."


def _findings(claim: PublishedClaim, runs: Mapping[str, Run]) -> list[Verdict]:
    findings = []
    for preset in PRESETS:
        metric = runs[f"{_figure(claim.experiment)}/{preset}"].metrics[claim.metric]
        verdict = judge(_value(claim, preset, runs), metric["median"], _bound(claim, preset, runs))
        findings.append(Verdict(preset, spread(metric, claim.value), verdict))
    return findings


def _value(claim: PublishedClaim, preset: str, runs: Mapping[str, Run]) -> float:
    """Return what the simulation is compared with: the printed value, or the run that it is said to be like."""
    if claim.value is not None or claim.like is None:
        return float(claim.value or 0.0)
    return float(runs[f"{_figure(claim.like.experiment)}/{preset}"].metrics[claim.like.metric]["median"])


def _bound(claim: PublishedClaim, preset: str, runs: Mapping[str, Run]) -> float | None:
    """Return what the thesis' other number, or the simulated one in its place where that is larger, lets one expect."""
    if claim.bound is None:
        return None
    printed = _other(claim.bound).value
    expected = [None if printed is None else printed * claim.bound.scale, _scaled_median(claim.bound, preset, runs)]
    return max((value for value in expected if value is not None), default=None)


def _scaled_median(bound: Bound, preset: str, runs: Mapping[str, Run]) -> float | None:
    other = _other(bound)
    simulated = median(runs[f"{_figure(other.experiment)}/{preset}"], other.metric)
    return None if simulated is None else simulated * bound.scale


def _other(bound: Bound) -> PublishedClaim:
    return next(claim for claim in load_claims("thesis") if claim.number == bound.claim)


def _figure(experiment: str) -> str:
    return experiment.rpartition("/")[2]


def _printed(claim: PublishedClaim) -> str:
    if not claim.printed:
        return "in words"
    low, high = claim.printed[0], claim.printed[-1]
    return quantity(low, claim.unit) if low == high else ranged(low, high, claim.unit)
