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
from runner.works.thesis.bandwidth import at_rest, floor, in_motion
from runner.works.thesis.plan import BANDWIDTHS, BIASED, MACRO_BIAS


def mini_accuracy(runs: Mapping[str, Run]) -> Finding:
    """Return whether a Macro takes on the accuracy and response of the Mini that it carries."""
    fast, slow = (at_rest(runs, rate) for rate in (BANDWIDTHS[0], BANDWIDTHS[-1]))
    biased_fast, biased_slow = (at_rest(runs, rate, True) for rate in BIASED)
    moved = floor(runs)
    held = _at_rest(runs, "bandwidth/held", "the Macro alone, the Mini's weight known", "macro_")
    tip = _at_rest(runs, "figure_5_12/sound", "the pair")
    macro = _at_rest(runs, "macro_alone/sound", "the Macro alone", "macro_")
    fitted = _at_rest(runs, "figure_5_12/as_reported", "the pair (as reported)")
    fitted_macro = _at_rest(runs, "macro_alone/as_reported", "the Macro alone (as reported)", "macro_")
    ground = _at_rest(runs, "figure_4_4/sound", "a Mini on firm ground")
    bound = Measured("what the encoders place it within", _encoder_bound(runs["bandwidth/held"]), "m")
    tracked = measured(runs["figure_5_12/sound"], "max_tracking_error", "the pair, moving")
    alone = measured(runs["macro_alone/sound"], "macro_max_tracking_error", "the Macro alone, moving")
    moving, best, lagging = (in_motion(runs, rate) for rate in (*BANDWIDTHS[:2], BANDWIDTHS[-1]))
    return finding(
        "6b. Can an inaccurate Macro take on the accuracy and response of the Mini that it carries? Response yes; "
        "accuracy under white noise with a Mini that is slower than the thesis', not beyond a bias of the Macro's "
        "encoders",
        "At rest after the trajectory, with gravity compensated, the Mini's own included, the Macro's end point alone "
        f"errs by {held}, a Mini on firm ground by {ground}. Carried and at {BANDWIDTHS[0]:g} rad/s, as in the thesis, "
        f"it gains nothing: {fast}. Read within {number(_encoder_error(runs['bandwidth/held']))} rad, the encoders "
        f"place the Macro's end point within {bound} at each tick, and so fast a Mini follows that noise. It is white, "
        f"and a slower Mini averages it: at {BANDWIDTHS[-1]:g} rad/s the tip rests within {slow}, for a largest error "
        f"in motion of {lagging} in place of {moving}; at {BANDWIDTHS[1]:g} rad/s that is {best}. A bias does "
        f"not average: with {quantity(MACRO_BIAS, 'rad')} on each of the Macro's encoders beside the noise the tip "
        f"rests {biased_fast} off at {BIASED[0]:g} rad/s and {biased_slow} at {BIASED[-1]:g} rad/s; the bias "
        f"alone puts it {moved} elsewhere. Where the Macro does not know the Mini's weight there is a gain at "
        f"{BANDWIDTHS[0]:g} rad/s, too, {macro} to {tip}: the Mini takes back the sag that it has caused. The thesis' "
        f"gain, {_printed(15)} to {_printed(14)}, is that of the runs as reported, {fitted_macro} to {fitted}: gravity "
        "that the Macro's law is taken to leave out. A term in it does the same without a Mini. While it moves the tip "
        f"errs {alone / tracked} times less than the Macro.",
        fast > 0.9 * held,
        fast < bound,
        ground < 0.1 * held,
        slow < 0.5 * held,
        best < 0.9 * moving,
        lagging > 2.0 * moving,
        biased_slow.near(moved, 0.15),
        biased_slow > 0.7 * biased_fast,
        biased_fast > moved,
        biased_slow > 5.0 * slow,
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
