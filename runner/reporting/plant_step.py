"""Integration error of a run in sentences, from the values stored with the run."""

from collections.abc import Mapping, Sequence
from typing import Any

from runner.base.quantities import above_rounding, number, quantity
from runner.caveats.integration_error import COMPARED
from runner.reporting.metric_titles import key_names, title
from runner.reporting.words import PLANT
from runner.store import Run

_MOST_TOLD = 2  # metrics in a sentence
_LEAST = 1e-4  # of a metric: smaller fractions are printed as less than that


def describe_plant(run: Run, metrics: Sequence[str] = ()) -> str:
    """Return a run's plant, its step, and the contribution of the step to some metrics, in three sentences at most.

    Args:
        run: The run.
        metrics: Names of metrics; empty stands for those that say most of its task.
    """
    kind, step = str(run.config["plant"]["kind"]), run.provenance["plant_step"]
    head = f"{PLANT.get(kind, kind)} is the plant, in steps of {quantity(step, 's')}."
    flexible = run.config["plant"].get("flexible_joints")
    if flexible is not None:
        head += f" Joints are flexible, with encoders at the {flexible['encoders']}s."
    links = run.config["plant"].get("links")
    if kind == "rk4_flexible_links" and links is not None:
        bent = ", ".join(name for name, beam in links.items() if beam is not None)
        head += f" Links bend ({bent}); pictures show the arm with straight ones, and the tip where it is."
    if kind not in COMPARED:
        return head
    return f"{head} {_estimate_error(run, metrics or key_names(run))}"


def _estimate_error(run: Run, metrics: Sequence[str]) -> str:
    error = run.plant_error
    if error is None:
        return "The error of the integration step was not measured: plant_error=true measures it."
    if "reason" in error:
        return f"The error of the integration step cannot be measured on Runge-Kutta: {error['reason']}."
    if error["parted"] is not None:
        return (
            f"Runge-Kutta, with the same noise, goes another way from {quantity(error['parted'], 's')} on: the tips "
            f"are {above_rounding(error['largest'], 'm', 2)} apart at most, {above_rounding(error['end'], 'm', 2)} at "
            "the end. Their metrics are not comparable."
        )
    shares = [text for name in metrics if (text := share_of(error, name))][:_MOST_TOLD]
    return (
        f"The integration step contributes {' and '.join(shares)}."
        if shares
        else "The integration step has no measurable effect."
    )


def share_of(error: Mapping[str, Any], metric: str) -> str:
    """Return the contribution of the step to a metric, such as "0.3 % of the settling time"; empty if unknown."""
    share = error.get("metrics", {}).get(metric, {}).get("share")
    return "" if share is None else f"{percent(share)} of the {title(metric)}"


def percent(share: float) -> str:
    """Return a share in per cent, such as "0.31 %"."""
    return f"less than {number(100.0 * _LEAST)} %" if share < _LEAST else f"{number(100.0 * share, 2)} %"
