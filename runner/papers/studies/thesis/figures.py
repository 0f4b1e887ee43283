"""Drawings and numbers of the chapters of the thesis study."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import above_rounding, number
from runner.papers.reporting.published_claims import load_claims
from runner.papers.studies.thesis.denavit_hartenberg import denavit_hartenberg
from runner.papers.studies.thesis.diagrams.block_diagram import block_diagram, control_graph, describe
from runner.papers.studies.thesis.diagrams.frames import frame_assignment
from runner.papers.studies.thesis.diagrams.workspace import workspace_sphere
from runner.papers.studies.thesis.equations.derivations.thesis_printed import compare
from runner.papers.study.measured import Measured
from runner.papers.study.prose.signals import norm, vector
from runner.papers.study.results import Runs, matching_runs
from runner.papers.study.run_values import values
from runner.reporting.document import Picture, Table
from runner.reporting.figures import origin
from runner.reporting.table import numbers
from runner.reporting.words import PRESET
from runner.robots.workspace import analyse
from runner.store import Run

way_left = norm(vector("desired") - vector("macro_tip"))
"""Distance from the Macro's end point to the desired tip, in m."""
_MEANINGS = {
    "M": ("mass matrix, (3.17)", "kg m²"),
    "V": ("centrifugal and Coriolis torque, (3.19)", "N m"),
    "G": ("gravity torque, (3.24)", "N m"),
    "J": ("basic Jacobian, (3.5)", "m"),
    "T": ("tip transform, (3.1)", "m"),
}
_SAMPLES = 4000  # tip positions in a workspace
_BROKEN = 10.0  # times the tip error of the thesis' own Mini


def frames(runs: Runs, run: str, caption: str, arm: str, width: float, number: str, first: int, tip: str) -> Picture:
    """Return the joint axes and Denavit-Hartenberg frames of an arm at home, from its frame 0 by number to the tip."""
    words = f"{arm} at home with its joint axes and Denavit-Hartenberg frames"
    return Picture(caption, frame_assignment(runs[run].model, first, tip), words, width, origin(runs[run], number))


def link_lengths(run: Run) -> str:
    """Return the Denavit-Hartenberg link lengths of an arm, in m."""
    return _listed([row.a for row in denavit_hartenberg(run.model)])


def link_masses(run: Run) -> str:
    """Return the masses of the links of an arm, in kg."""
    return _listed([inertia.mass for inertia in list(run.model.pin_model.inertias)[1:]])


def _listed(values: Sequence[float]) -> str:
    return f"[{' '.join(f'{value:g}' for value in values)}]"


def workspace(runs: Runs, run: str, name: str, figure: str) -> Picture:
    """Return the sphere of reach of an arm with sampled tip positions, and a cross-section by manipulability."""
    found = analyse(runs[run].model, _SAMPLES, np.random.default_rng(0))
    return Picture(
        f"Workspace of the {name}: {_SAMPLES} sampled tip positions in the sphere of reach, and a meridian "
        f"cross-section coloured by manipulability. Largest distance from the shoulder {number(found.outer, 4)} "
        f"m (sum of the link lengths {number(found.reach, 4)} m), smallest {above_rounding(found.inner, 'm')}.",
        workspace_sphere(found),
        f"A sphere of radius {found.outer:.3g} m filled with points, and its cross-section",
        0.62,
        origin(runs[run], figure),
    )


def dh_table(runs: Runs, run: str, caption: str, number: str, first: int, *printed: Sequence[str]) -> Table:
    """Return the Denavit-Hartenberg table of an arm whose frame 0 has a number, with the printed row of each link."""
    rows = []
    for link, row in enumerate(denavit_hartenberg(runs[run].model), start=first + 1):
        turn = f"$q_{link}$" if row.theta == 0.0 else f"{_angle(row.theta)} + $q_{link}$"
        ours = (turn, f"{row.d:g}", f"{row.a:g}", _angle(row.alpha))
        pairs = zip(ours, *printed[link - first - 1 : link - first], strict=True)
        rows.append([str(link), *(cell for pair in pairs for cell in pair)])
    ours = ("$theta_i$ (rad)", "$d_i$ (m)", "$a_i$ (m)", "$alpha_i$ (rad)")
    header = ["link", *(cell for title in ours for cell in (title, "printed")[: 2 if printed else 1])]
    return Table(caption, header, rows, origin(runs[run], number), prose=True)


def _angle(value: float) -> str:
    """Return an angle as a multiple of pi where it is one."""
    if value == 0.0:
        return "0"
    twelfths = round(12.0 * value / math.pi)
    if abs(12.0 * value / math.pi - twelfths) > 1e-9:
        return f"{value:.6g}"
    divisor = math.gcd(twelfths, 12)
    top, bottom = twelfths // divisor, 12 // divisor
    head = "$-pi" if top == -1 else "$pi" if top == 1 else f"${top} pi"
    return f"{head}$" if bottom == 1 else f"{head} slash {bottom}$"


def printed_matrices(runs: Runs, run: str, caption: str, mini: bool, samples: int) -> Table:
    """Return a table of the largest differences between the thesis' corrected matrices and an arm's model."""
    differences = compare(runs[run].model, mini, samples, np.random.default_rng(0))
    rows = [
        [f"${symbol}$", meaning, above_rounding(differences[symbol], unit)]
        for symbol, (meaning, unit) in _MEANINGS.items()
    ]
    return Table(caption, ["symbol", "quantity", *numbers("largest difference")], rows, origin(runs[run]), prose=True)


def control_structure(runs: Runs, run: str, caption: str, number: str, width: float = 0.68) -> Picture:
    """Return the block diagram of a figure of the thesis; see control_structures.yaml."""
    return Picture(caption, block_diagram(control_graph(number)), describe(number), width, origin(runs[run], number))


def printed(claim: int, end: int, words: str) -> Measured:
    """Return an end of the range that the thesis prints for a claim: 0 is the lower, -1 the upper one."""
    published = next(each for each in load_claims("thesis") if each.number == claim)
    return Measured(words, published.printed[end], published.unit)


def moved_by_bias(run: Run) -> float | None:
    """Return by how much the bias of the Macro's encoders puts the tip elsewhere at the last posture, in m.

    The controllers bring the tip that they believe to the goal: all of the Macro's joints are off by the bias, the
    Mini's are right. The largest axis of J_M b to first order, J_M the Macro's columns of the whole arm's tip Jacobian.
    """
    q = run.joints("q")[-1]
    if not np.isfinite(q).all():
        return None
    joints = sum(not joint.startswith("mini_") for joint in run.provenance["joints"])
    moved = run.model.tip_jacobian(q)[:3, :joints] @ np.full(joints, run.config["noise"]["bias"]["macro"])
    return float(np.abs(moved).max())


def at_rest(run: Run) -> list[float]:
    """Return the steady-state errors of the repetitions of a run that do not diverge, in m."""
    if "steady_state_error" not in run.metrics:
        return []
    values = run.values("steady_state_error")
    return [float(value) for value in values[~np.isnan(values)]]


def count_diverging(run: Run) -> int:
    """Return the number of diverging repetitions of a run."""
    return int(run.config["repetitions"]) - len(at_rest(run))


def farthest_at_rest(run: Run) -> float | None:
    """Return the largest of these errors, in m; None if all repetitions diverge."""
    return max(at_rest(run), default=None)


def lost_from(run: Run) -> float | None:
    """Return the time from which the target is out of reach, in s; None if it is within reach at the end."""
    beyond = way_left(run) > run.config["controller"]["reach"]
    inside = np.flatnonzero(~beyond)
    return float(run.t[inside[-1] + 1 if len(inside) else 0]) if beyond[-1] else None


def singular_value(run: Run) -> FloatArray:
    """Return the smallest singular value of the Mini's columns of the whole arm's Jacobian, shape (T,), in m."""
    positions = run.joints("q")
    values, finite = np.full(len(positions), np.nan), np.isfinite(positions).all(axis=1)
    jacobians = [run.model.tip_jacobian(q)[:3, 3:] for q in positions[finite]]
    values[finite] = np.linalg.svd(np.reshape(jacobians, (-1, 3, 3)), compute_uv=False)[:, -1]
    return values


def spreads(runs: Runs, title: str, name: str, *metrics: str) -> list[str]:
    """Return the metrics of an experiment under each preset behind its title, as a row of a table."""
    return [title, *(runs[f"{name}/{preset}"].metrics[metric].text for preset in PRESET for metric in metrics)]


def mass_of(stage: str) -> Callable[[Run], float]:
    """Return the mass of a stage of a run's arm, in kg."""
    return lambda run: float(sum(run.config["robot"]["stages"][stage]["masses"].values()))


def around_the_break(runs: Runs, payload: str) -> tuple[str, str]:
    """Return the runs of the heaviest Mini with which one-way control works without noise, and of the next one.

    It is broken if the tip's error is above ten times that of the thesis' Mini. Where none works, or none
    is broken, both are one.
    """
    names = [one.name for one in matching_runs(runs, f"mass/{{mass}}/{payload}")]
    limit = runs[f"mass/0.2/{payload}"].median("max_axis_error")
    errors = [runs[name].median("max_axis_error") for name in names]
    broken = [error is None or limit is None or error > _BROKEN * limit for error in errors]
    first = broken.index(True) if any(broken) else len(names)
    return names[max(first - 1, 0)], names[min(first, len(names) - 1)]


def fastest(runs: Runs, pattern: str) -> str:
    """Return the name of the run that settles first among those of a pattern; the first one where none settles."""
    times = {one.name: one.run.median("settling_time") for one in matching_runs(runs, pattern)}
    return min(times, key=lambda name: math.inf if times[name] is None else float(times[name] or 0.0))


def sag(run: Run) -> float:
    """Return |J M^-1 G| / omega_n^2 at the run's final true joint positions, in m."""
    model = run.model
    q = run.joints("q")[-1]
    fall = model.tip_jacobian(q)[:3] @ np.linalg.solve(model.mass_matrix(q), model.gravity_torque(q))
    return float(np.linalg.norm(fall / run.config["controller"]["natural_frequency"] ** 2))


def duration_of(runs: Runs, pattern: str, error: Measured, words: str) -> Measured:
    """Return at which duration, between those of a pattern's runs, the largest axis error is that given."""
    tried = matching_runs(runs, pattern)
    errors = values((one.run for one in tried), "max_axis_error")
    times = [float(one.levels["duration"]) for one in tried]
    return Measured(words, float(np.interp(-float(error.value or 0.0), -errors, times)), "s")
