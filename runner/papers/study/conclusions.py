"""Conclusions of a report as data: verdicts, findings with conditions, caveats and numbers."""

from collections.abc import Mapping, Sequence

from runner.papers.reporting.claims import Claim, Verdicts
from runner.papers.reporting.equation import Equations
from runner.papers.study.expected_caveats import ExpectedCaveat, caveats_as_data
from runner.papers.study.measured import findings
from runner.reporting.document import Document
from runner.reporting.markup import without_marks
from runner.reporting.outline import blocks
from runner.store import Calibration, Run


def list_failed_findings(document: Document) -> list[str]:
    """Return the findings of a report that no longer hold, a line for each failed condition."""
    return [
        f"section {number}: {found.claim}: not so: {condition.text} ({condition.measured})"
        for number, found in findings(document)
        for condition in found.conditions
        if not condition.holds
    ]


def conclusions(
    document: Document,
    runs: Mapping[str, Run],
    calibrations: Mapping[str, Calibration],
    expected: Sequence[ExpectedCaveat],
) -> dict[str, object]:
    """Return the conclusions of a report, as plain data.

    Args:
        document: The report.
        runs: The stored runs that it uses, by name.
        calibrations: The stored calibrations that it uses, by name.
        expected: The caveats that it expects of them.
    """
    return {
        "title": document.title,
        "verdicts": [_verdict(row) for block in blocks(document) if isinstance(block, Verdicts) for row in block.rows],
        "findings": [
            {
                "section": number,
                "title": found.claim,
                "text": without_marks(found.sentences),
                "holds": found.holds,
                "conditions": [
                    {"text": each.text, "holds": each.holds, "measured": each.measured} for each in found.conditions
                ],
            }
            for number, found in findings(document)
        ],
        "equations": [
            {"title": row.title, "number": row.number, "place": row.place, "verdict": row.verdict}
            for block in blocks(document)
            if isinstance(block, Equations)
            for row in block.rows
        ],
        "caveats": caveats_as_data(runs, expected),
        "numbers": {name: _numbers(run) for name, run in runs.items()},
        "calibrations": {name: _calibrated(calibration) for name, calibration in calibrations.items()},
    }


def _verdict(claim: Claim) -> dict[str, object]:
    ours = [
        {"preset": found.preset, "way": found.words, "measured": found.measured, "verdict": found.verdict}
        | {"hangs": dict(found.hangs)}
        for found in claim.findings
    ]
    return {"claim": claim.number, "statement": claim.statement, "printed": claim.printed, "ours": ours}


def _numbers(run: Run) -> dict[str, object]:
    return {
        "run": run.hash,
        "status": run.status,
        "metrics": _summaries(run.record["metrics"]),
    }


def _calibrated(calibration: Calibration) -> dict[str, object]:
    return {
        "calibration": calibration.hash,
        "truth": dict(calibration.truth),
        **{table: _summaries(calibration.record[table]) for table in ("estimates", "errors", "deviations")},
    }


def _summaries(table: Mapping[str, Mapping[str, object]]) -> dict[str, dict[str, object]]:
    return {name: {key: each[key] for key in ("unit", "median", "min", "max")} for name, each in table.items()}
