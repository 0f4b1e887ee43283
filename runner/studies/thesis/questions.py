"""Values for the thesis questions that metrics do not give: effectiveness of the pair, encoder error bound."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.figures import joint_columns, model_of
from runner.reporting.words import PRESET
from runner.store import Run
from runner.study.job import PRESETS
from runner.study.run_values import cell

_REST = "steady_state_error"
_ARMS = (
    ("Macro alone (its end point)", "macro_alone_goal", "macro_alone", "macro_"),
    ("one-way", "figure_5_8", "figure_5_12", ""),
    ("two-way", "figure_5_10", "figure_5_13", ""),
)


def effectiveness(runs: Mapping[str, Run]) -> list[list[str]]:
    """Return goal and tracking of the Macro alone and of the pair, under each preset: a row for each."""
    return [
        [
            PRESET[preset],
            name,
            *(cell(runs[f"{goal}/{preset}"], f"{stage}{metric}") for metric in ("settling_time", _REST)),
            *(cell(runs[f"{track}/{preset}"], f"{stage}{metric}") for metric in ("max_axis_error", _REST)),
        ]
        for preset in PRESETS
        for name, goal, track, stage in _ARMS
    ]


def encoder_bound(run: Run) -> float | None:
    """Return the largest axis error of the Macro's end point as its encoders tell it at the last posture, in m."""
    q, frame = joint_columns(run.trace, "q")[-1], run.provenance["stages"]["mini"]
    if not np.isfinite(q).all():
        return None
    model, step = model_of(run), 1e-6
    at_rest, *moved = (model.frame_poses(q + step * joint, (frame,))[0][:3, 3] for joint in np.eye(4, len(q), -1))
    slopes = np.abs([each - at_rest for each in moved]).sum(axis=0) / step  # the first of four moves no joint
    return float(slopes.max() * run.config["noise"]["position"]["macro"])
