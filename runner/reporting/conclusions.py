"""What a report concludes, for programs: verdicts, findings with their conditions, caveats, numbers."""

from collections.abc import Mapping, Sequence

from runner.reporting.document import Claim, Document
from runner.reporting.expected_caveats import ExpectedCaveat, caveats_as_data
from runner.reporting.findings import findings
from runner.reporting.outline import blocks
from runner.store import Run


def fallen(document: Document) -> list[str]:
    """Return the findings of a report that no longer hold, a line for each failed condition."""
    return [
        f"section {number}: {found.claim}: not so: {condition.text} ({condition.measured})"
        for number, found in findings(document)
        for condition in found.conditions
        if not condition.holds
    ]


def conclusions(document: Document, runs: Mapping[str, Run], expected: Sequence[ExpectedCaveat]) -> dict[str, object]:
    """Return all that a report concludes, as plain data.

    Args:
        document: The report.
        runs: The stored runs behind it, by name.
        expected: The caveats that it expects of them.
    """
    return {
        "title": document.title,
        "verdicts": [_verdict(block) for block in blocks(document) if isinstance(block, Claim)],
        "findings": [
            {
                "section": number,
                "title": found.claim,
                "text": found.sentences,
                "holds": found.holds,
                "conditions": [vars(condition) for condition in found.conditions],
            }
            for number, found in findings(document)
        ],
        "caveats": caveats_as_data(runs, expected),
        "numbers": {name: _numbers(run) for name, run in runs.items()},
    }


def _verdict(claim: Claim) -> dict[str, object]:
    ours: Sequence[dict[str, str]] = [
        {"preset": found.preset, "measured": found.measured, "verdict": found.verdict} for found in claim.findings
    ]
    return {"claim": claim.number, "statement": claim.statement, "printed": claim.printed, "ours": ours}


def _numbers(run: Run) -> dict[str, object]:
    return {
        "run": run.hash,
        "status": run.status,
        "metrics": {
            name: {key: metric[key] for key in ("unit", "median", "min", "max")} for name, metric in run.metrics.items()
        },
    }
