"""The thesis' last question: can an inaccurate Macro reach the accuracy and response of a Mini?"""

from collections.abc import Mapping

import numpy as np

from runner.claims import load_claims
from runner.reporting.figures import joint_columns, model_of
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import measured
from runner.store import Run


def mini_accuracy(runs: Mapping[str, Run]) -> Finding:
    """Return whether a Macro takes on the accuracy and response of the Mini that it carries."""
    rest = _at_rest(runs, "rest/one_way", "the pair, the Mini's weight known")
    held = _at_rest(runs, "rest/mini_held", "the Macro alone, the Mini's weight known", "macro_")
    tip = _at_rest(runs, "figure_5_12/sound", "the pair")
    macro = _at_rest(runs, "macro_alone/sound", "the Macro alone", "macro_")
    fitted = _at_rest(runs, "figure_5_12/as_reported", "the pair (as_reported)")
    fitted_macro = _at_rest(runs, "macro_alone/as_reported", "the Macro alone (as_reported)", "macro_")
    ground = _at_rest(runs, "figure_4_4/sound", "a Mini on firm ground")
    bound = Measured("what the encoders place it within", _encoder_bound(runs["rest/mini_held"]), "m")
    tracked = measured(runs["figure_5_12/sound"], "max_tracking_error", "the pair, moving")
    alone = measured(runs["macro_alone/sound"], "macro_max_tracking_error", "the Macro alone, moving")
    rate = float(runs["rest/one_way"].config["controller"]["natural_frequency"]["mini"])
    return finding(
        "6b. Can an inaccurate Macro take on the accuracy and response of the Mini that it carries? At this bandwidth "
        "accuracy no, against the thesis; response yes",
        f"At rest after the trajectory, with gravity compensated, the Mini's own included, and a Mini of {rate:g} "
        f"rad/s under white encoder noise, the tip of the pair errs by {rest} and the Macro's end point alone by "
        f"{held}; a Mini on firm ground errs by {ground}. Read within "
        f"{number(_encoder_error(runs['rest/mini_held']))} rad, the encoders place the Macro's end point within "
        f"{bound} at each tick, and so fast a Mini follows their noise, which the slow Macro filters. White noise "
        "averages: this says nothing of a slower Mini, or of one whose base is estimated by a filter. Where the Macro "
        f"does not know the Mini's weight there is a gain, {macro} to {tip}: the Mini takes back the sag that it has "
        f"caused. The thesis' gain, {_printed(15)} to {_printed(14)}, is that of as_reported, {fitted_macro} to "
        f"{fitted}: gravity that the Macro's law is taken to leave out. A term in that law does the same without a "
        f"Mini. While it moves the tip errs {alone / tracked} times less than the Macro.",
        rest > 0.9 * held,
        rest < bound,
        ground < 0.1 * held,
        tip < 0.8 * macro,
        fitted < 0.8 * fitted_macro,
        held < 0.8 * fitted_macro,
        alone > 5.0 * tracked,
    )


def _at_rest(runs: Mapping[str, Run], run: str, name: str, stage: str = "") -> Measured:
    return measured(runs[run], f"{stage}steady_state_error", f"{name}, at rest")


def _printed(claim: int) -> str:
    """Return the upper end of the range that the thesis prints for a claim, with its unit."""
    published = next(each for each in load_claims("thesis") if each.number == claim)
    return quantity(published.printed[-1], published.unit)


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
