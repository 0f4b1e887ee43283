"""The thesis' last question: can an inaccurate Macro reach the accuracy and response of a Mini?"""

from collections.abc import Mapping

import numpy as np

from runner.claims import load_claims
from runner.reporting.document import Notice
from runner.reporting.figures import joint_columns, model_of
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import median
from runner.reporting.thesis.studies import ratio
from runner.store import Run

_NO_GAIN = 0.8  # of the Macro's own error: only a smaller share counts as a gain


def mini_accuracy(runs: Mapping[str, Run]) -> Notice:
    """Return whether a Macro takes on the accuracy and response of the Mini that it carries."""
    tip, macro = _at_rest(runs["figure_5_12/sound"], runs["macro_alone/sound"])
    told = _at_rest(runs["rest/one_way"], runs["rest/mini_held"])
    before, after = _at_rest(runs["figure_5_12/as_reported"], runs["macro_alone/as_reported"])
    bound, mini = _encoder_bound(runs["rest/mini_held"]), median(runs["figure_4_4/sound"], "steady_state_error")
    gain = _gains(*told)
    question = "6b. Can an inaccurate Macro take on the accuracy and response of the Mini that it carries?"
    rest = (
        "At rest after the trajectory, with gravity compensated, the Mini's own included, the tip of the pair errs "
        f"by {quantity(told[0], 'm')} and the Macro's end point alone by {quantity(told[1], 'm')}; a Mini on firm "
        f"ground errs by {quantity(mini, 'm')}. "
    )
    reason = (
        f"So there is a gain, down to what the encoders of its base tell, {quantity(bound, 'm')} at most. "
        if gain
        else "So the Mini gives no steady-state gain: it cannot beat the encoders that locate its base. Read within "
        f"{number(_encoder_error(runs['rest/mini_held']))} rad, they place the Macro's end point only to within "
        f"{quantity(bound, 'm')}, and the Mini follows their noise, which the slow Macro filters. "
    )
    weight = (
        f"Where the Macro does not know the Mini's weight there is a gain, {quantity(macro, 'm')} to "
        f"{quantity(tip, 'm')}: the Mini takes back the sag that it has caused. "
        if _gains(tip, macro)
        else ""
    )
    explained = (
        f"The thesis' gain, {_printed(15)} to {_printed(14)}, is that of as_reported, {quantity(after, 'm')} to "
        f"{quantity(before, 'm')}: gravity that the Macro's law has left out. A term in that law does the same "
        "without a Mini. "
        if _gains(before, after)
        else "Nor does as_reported show the thesis' gain. "
    )
    tracked = median(runs["figure_5_12/sound"], "max_tracking_error")
    alone = median(runs["macro_alone/sound"], "macro_max_tracking_error")
    response = (
        f"Response, however, yes: while it moves the tip errs {ratio(alone, tracked)} times less than the Macro."
        if _gains(tracked, alone)
        else "Nor response: the tip tracks no better than the Macro."
    )
    title = "Yes" if gain else "Accuracy no, against the thesis" + ("; response yes" if _gains(tracked, alone) else "")
    return Notice("finding", f"{question} {title}", rest + reason + weight + explained + response)


def _printed(claim: int) -> str:
    """Return the upper end of the range that the thesis prints for a claim, with its unit."""
    published = next(each for each in load_claims("thesis") if each.number == claim)
    return quantity(published.printed[-1], published.unit)


def _at_rest(pair: Run, alone: Run) -> tuple[float | None, float | None]:
    return median(pair, "steady_state_error"), median(alone, "macro_steady_state_error")


def _gains(ours: float | None, alone: float | None) -> bool:
    return ours is not None and alone is not None and ours < _NO_GAIN * alone


def _encoder_error(run: Run) -> float:
    return float(run.config["noise"]["position"]["macro"])


def _encoder_bound(run: Run) -> float | None:
    """Return the largest axis error of the Macro's end point as its encoders tell it at the last posture, in m."""
    q = joint_columns(run.trace, "q")[-1]
    if not np.isfinite(q).all():
        return None
    model = model_of(run)
    base = model.frame_poses(q, (run.provenance["stages"]["mini"],))[0][:3, 3]
    step = 1e-6
    moved = []
    for joint in range(3):
        nudged = q.copy()
        nudged[joint] += step
        moved.append((model.frame_poses(nudged, (run.provenance["stages"]["mini"],))[0][:3, 3] - base) / step)
    return float(np.abs(moved).sum(axis=0).max() * _encoder_error(run))
