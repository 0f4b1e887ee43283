"""What the xArm7 report says of the tip's motion, with verdicts."""

from collections.abc import Mapping, Sequence

import numpy as np

from runner.claims import CONTRADICTION, load_claims
from runner.reporting.claim import Claim
from runner.reporting.claims import claim_blocks, verdict_table
from runner.reporting.document import Section, Text
from runner.reporting.findings import Finding, finding
from runner.reporting.job import PRESETS
from runner.reporting.measured import Measured
from runner.reporting.run_values import measured
from runner.reporting.words import PRESET
from runner.store import Run


def claims_section(runs: Mapping[str, Run]) -> Section:
    """Return the verdicts, as a table and one by one."""
    claims = claim_blocks(load_claims("xarm7"), runs)
    return Section(
        "Verdict on every statement",
        (
            Text(
                "The report prints no errors, only where the tip stays and how far it moves. A statement holds when "
                "the least and the largest coordinate of the simulated tip, over two periods, agree with it to half a "
                "unit of the last digit that it prints; the simulation is worse when they do not. Where the report "
                "tells of a failure, the statement holds when the simulation fails too, and the simulation is better "
                f"when it does not. The report {CONTRADICTION} where a statement does not fit the path that it "
                "prescribes itself, whatever the arm does."
            ),
            Text(
                f"Each statement is simulated under two presets. The first, {PRESET['as_reported']} (as_reported on "
                "the command line), is a controller that knows the desired position alone and so is late; the second, "
                f"{PRESET['sound']} (sound on the command line), also takes desired velocity and acceleration."
            ),
            verdict_table("Verdicts, with the least and the largest coordinate of the tip.", claims),
            _concluded(claims, runs),
            *claims,
        ),
    )


def _concluded(claims: Sequence[Claim], runs: Mapping[str, Run]) -> Finding:
    given = [{each.verdict for each in claim.findings} for claim in claims]
    late = runs["three_joints/as_reported"]
    trajectory, period = late.config["trajectory"], float(late.config["controller"]["period"])
    length = float(np.linalg.norm(np.subtract(trajectory["goal"], trajectory["start"])))
    speed = np.pi * length / float(trajectory["duration"])
    off = [
        measured(runs[f"{name}/{preset}"], "cross_track_error", f"distance from the line, {name}, {preset}")
        for name in ("three_joints", "seven_joints")
        for preset in PRESETS
    ]
    return conclude(
        len(claims),
        Measured("statements that hold under both presets", float(given.count({"holds"}))),
        Measured("statements that contradict the report's own path", float(given.count({CONTRADICTION}))),
        off,
        measured(late, "max_tracking_error", "tip error of three joints without feedforward"),
        Measured("way within one period of the controller", speed * period, "m"),
    )


def conclude(
    count: int, holding: Measured, contradicting: Measured, off: Sequence[Measured], late: Measured, way: Measured
) -> Finding:
    """Return what comes of the report's statements.

    Args:
        count: How many there are.
        holding: How many hold under both presets.
        contradicting: How many contradict the report's own path.
        off: Distances of the tip from the line, by three joints and by seven, under each preset.
        late: Tip error of three joints without feedforward.
        way: What the desired tip goes at most within one period of the controller.
    """
    return finding(
        f"{holding} of {count} statements hold under both presets, {contradicting} contradicts the report's own path",
        "By three joints and by seven, with feedforward and without, the tip is on the line. Without feedforward it is "
        f"late on the line: by {late} where three joints move, which is the way that the desired tip goes within one "
        "period of the controller.",
        holding >= count - 1.0,
        contradicting >= 1.0,
        *(each < 1e-5 for each in off),
        late.near(way, 0.02),
    )
