"""The thesis' numbers with their verdicts."""

from collections.abc import Mapping

from runner.claims import FACTOR, PublishedClaim, judge, load_claims
from runner.reporting.document import Block, Claim, Finding, Section, Table, Text
from runner.reporting.job import PRESETS
from runner.reporting.quantities import number, quantity, spread
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
            "Preset as_reported is what the printed numbers point to: no gravity term, no feedforward, $t_f = 3$ s, "
            "and on the combined arm each stage simulated for itself with the Macro sent to the tip's goal. Preset "
            "sound is what the thesis' own equations (3.32) and (3.40) say, on the coupled arm. Both take the law "
            "as printed, without damping near singular postures. No value has been chosen to make a verdict."
        ),
        Table(
            "Verdicts, with median (smallest to largest) of 40 repetitions.",
            ["claim", "statement", "printed", *PRESETS],
            rows,
        ),
        *(_block(claim, findings, runs) for claim, findings in claims),
    ]
    return Section("Verdict on every number", blocks)


def _block(claim: PublishedClaim, findings: list[Finding], runs: Mapping[str, Run]) -> Claim:
    reason = claim.reason
    if claim.bound is not None:
        values = [_bound(claim, preset, runs) for preset in PRESETS]
        limits = " and ".join(f"{quantity(value, claim.unit)} ({p})" for value, p in zip(values, PRESETS, strict=True))
        reason = f"{claim.bound.reason} A tenth of the Macro's median: {limits}."
    command = f"runner experiment={claim.experiment} preset={PRESETS[0]}"
    return Claim(str(claim.number), claim.statement, claim.place, _printed(claim), findings, reason, command)


def _findings(claim: PublishedClaim, runs: Mapping[str, Run]) -> list[Finding]:
    findings = []
    for preset in PRESETS:
        metric = runs[f"{_figure(claim.experiment)}/{preset}"].metrics[claim.metric]
        verdict = judge(_value(claim, preset, runs), metric["median"], _bound(claim, preset, runs))
        findings.append(Finding(preset, spread(metric), verdict))
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
