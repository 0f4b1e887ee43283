"""The thesis' numbers with their verdicts."""

from collections.abc import Mapping

from runner.claims import FACTOR, PublishedClaim, judge, load_claims
from runner.reporting.document import Block, Claim, Section, Table, Text
from runner.reporting.document import Finding as Verdict
from runner.reporting.findings import Finding, finding
from runner.reporting.job import PRESETS
from runner.reporting.measured import Measured
from runner.reporting.quantities import number, quantity, spread
from runner.reporting.run_values import measured
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
            f"A printed value holds when the median of our 40 repetitions lies within a factor of {FACTOR} of it. A "
            "printed range is taken as the range over the axes, and its upper end compared with our worst axis. "
            "Preset as_reported is fitted to these printed numbers, as the thesis' code is not published: three free "
            "choices for a single arm (no gravity term, no feedforward, $t_f = 3$ s) and four more for the combined "
            "one (each stage simulated for itself, with a base that does not turn; the Macro sent to the tip's goal, "
            "the Mini following a series of goals). That it meets a number says that these choices explain it, not "
            "that the thesis made them. Preset sound has none: it is what the thesis' own equations (3.32) and (3.40) "
            "say, on the coupled arm, with the same $t_f$. Both take the law as printed, without damping near singular "
            "postures."
        ),
        _what_falls(runs),
        Table(
            "Verdicts, with median (smallest to largest) of 40 repetitions.",
            ["claim", "statement", "printed", *PRESETS],
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
        f"As_reported over sound: {fall}. The other four are set {stay}, which neither equation moves.",
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
        values = [_bound(claim, preset, runs) for preset in PRESETS]
        limits = " and ".join(f"{quantity(value, claim.unit)} ({p})" for value, p in zip(values, PRESETS, strict=True))
        reason = f"{claim.bound.reason} A tenth of the Macro's median: {limits}."
    command = f"runner experiment={claim.experiment} preset={PRESETS[0]}"
    return Claim(str(claim.number), claim.statement, claim.place, _printed(claim), findings, reason, command)


def _findings(claim: PublishedClaim, runs: Mapping[str, Run]) -> list[Verdict]:
    findings = []
    for preset in PRESETS:
        metric = runs[f"{_figure(claim.experiment)}/{preset}"].metrics[claim.metric]
        verdict = judge(_value(claim, preset, runs), metric["median"], _bound(claim, preset, runs))
        findings.append(Verdict(preset, spread(metric), verdict))
    return findings


def _value(claim: PublishedClaim, preset: str, runs: Mapping[str, Run]) -> float:
    """Return what ours is compared with: the printed value, or ours of the run that it is said to be like."""
    if claim.value is not None or claim.like is None:
        return float(claim.value or 0.0)
    return float(runs[f"{_figure(claim.like.experiment)}/{preset}"].metrics[claim.like.metric]["median"])


def _bound(claim: PublishedClaim, preset: str, runs: Mapping[str, Run]) -> float | None:
    if claim.bound is None:
        return None
    median = runs[f"{_figure(claim.bound.experiment)}/{preset}"].metrics[claim.bound.metric]["median"]
    return None if median is None else float(median) * claim.bound.scale


def _figure(experiment: str) -> str:
    return experiment.rpartition("/")[2]


def _printed(claim: PublishedClaim) -> str:
    if not claim.printed:
        return "in words"
    return f"{' to '.join(number(value) for value in claim.printed)} {claim.unit}"
