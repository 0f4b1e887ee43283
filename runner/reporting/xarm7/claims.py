"""What the xArm7 report says of the tip's motion, with verdicts."""

from collections.abc import Mapping

from runner.claims import PublishedClaim, judge_motion, load_claims
from runner.reporting.document import Claim, Finding, Section, Table, Text
from runner.reporting.figures import columns
from runner.reporting.job import PRESETS
from runner.reporting.quantities import quantity
from runner.store import Run


def claims_section(runs: Mapping[str, Run]) -> Section:
    """Return the verdicts, as a table and one by one."""
    claims = [_block(claim, runs) for claim in load_claims("xarm7")]
    rows = [[c.number, c.statement, c.printed, *(f"{f.measured}: {f.verdict}" for f in c.findings)] for c in claims]
    return Section(
        "Verdict on every statement",
        (
            Text(
                "The report prints no errors, only where the tip stays and how far it moves. A statement holds when "
                "the least and the largest coordinate of our tip, over two periods, agree with it to half a unit of "
                "the last digit that it prints. The verdict cannot marks what contradicts the report's own path. "
                "Preset as_reported is a controller that knows the desired position alone and so is late; preset "
                "sound also takes desired velocity and acceleration."
            ),
            Table(
                "Verdicts, with the least and the largest coordinate of the tip.",
                ["claim", "statement", "printed", *PRESETS],
                rows,
            ),
            *claims,
        ),
    )


def _block(claim: PublishedClaim, runs: Mapping[str, Run]) -> Claim:
    name = claim.experiment.rpartition("/")[2]
    findings = [_finding(claim, preset, runs[f"{name}/{preset}"]) for preset in PRESETS]
    printed = quantity(claim.value, claim.unit, 4) if claim.printed else "in words"
    command = f"runner experiment={claim.experiment} preset={PRESETS[0]}"
    return Claim(str(claim.number), claim.statement, claim.place, printed, findings, claim.reason, command)


def _finding(claim: PublishedClaim, preset: str, run: Run) -> Finding:
    tip = columns(run.trace, "tip")
    verdict = judge_motion(claim.extents, claim.fails, tip, columns(run.trace, "desired"))
    if run.status == "failed":
        return Finding(preset, run.failure_text, verdict)
    moved = [
        f"{extent.axis} {values.min():.4f} to {values.max():.4f} m"
        for extent in claim.extents
        for values in [tip[:, "xyz".index(extent.axis)]]
    ]
    return Finding(preset, ", ".join(moved), verdict)
