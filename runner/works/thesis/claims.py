"""The thesis' numbers with their verdicts."""

from collections.abc import Mapping

from runner.claims import CONTRADICTION, FACTOR, PublishedClaim, load_claims
from runner.reporting.claims import claim_blocks, run_name, verdict_table
from runner.reporting.document import Block, Section, Text
from runner.reporting.findings import Finding, finding
from runner.reporting.job import PRESETS
from runner.reporting.measured import Measured
from runner.reporting.run_values import measured
from runner.reporting.words import PRESET
from runner.store import Run


def claims_section(runs: Mapping[str, Run]) -> Section:
    """Return the verdicts on the numbers of chapters 3 to 5, as a table and one by one."""
    claims = claim_blocks(load_claims("thesis"), runs)
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
        verdict_table("Verdicts, with median (smallest to largest) of 40 repetitions.", claims),
        *claims,
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
        measured(runs[run_name(claim.experiment, preset)], claim.metric, f"claim {claim.number}, {preset}")
        for preset in PRESETS
    )
    return as_reported / sound
