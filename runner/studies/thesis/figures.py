"""Drawings and numbers of the chapters of the thesis study."""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import above_rounding
from runner.reporting.document import Block, Curves, Picture, Series, Table, Text
from runner.reporting.figures import AXES, origin
from runner.reporting.published_claims import load_claims
from runner.reporting.words import PRESET, in_words
from runner.store import Run
from runner.studies.thesis.compared import Compared, parting, step_of_both
from runner.studies.thesis.denavit_hartenberg import denavit_hartenberg
from runner.studies.thesis.diagrams.block_diagram import block_diagram
from runner.studies.thesis.diagrams.frames import frame_assignment
from runner.studies.thesis.diagrams.operational_space import operational_space_graph
from runner.studies.thesis.equations.derivations.thesis_printed import compare
from runner.study.job import PRESETS
from runner.study.measured import Condition, Measured, check_caption
from runner.study.prose.patterns import found
from runner.study.run_values import cell, measured, values

DIFFERENT = 1.1  # ratio from which on two values are not called the same
_MEANINGS = {
    "M": ("mass matrix, (3.17)", "kg m²"),
    "V": ("centrifugal and Coriolis torque, (3.19)", "N m"),
    "G": ("gravity torque, (3.24)", "N m"),
    "J": ("basic Jacobian, (3.5)", "m"),
    "T": ("tip transform, (3.1)", "m"),
}
_BROKEN = 10.0  # times the tip error of the thesis' own Mini


def frames(
    runs: Mapping[str, Run], run: str, caption: str, arm: str, width: float, number: str, first: int, tip: str
) -> Picture:
    """Return the joint axes and Denavit-Hartenberg frames of an arm at home, from its frame 0 by number to the tip."""
    words = f"{arm} at home with its joint axes and Denavit-Hartenberg frames"
    return Picture(caption, frame_assignment(runs[run].model, first, tip), words, width, origin(runs[run], number))


def dh_table(runs: Mapping[str, Run], run: str, caption: str, number: str, first: int) -> Table:
    """Return the Denavit-Hartenberg table of an arm whose frame 0 has a number, angles as multiples of pi."""
    rows = []
    for link, row in enumerate(denavit_hartenberg(runs[run].model), start=first + 1):
        turn = f"$q_{link}$" if row.theta == 0.0 else f"{_angle(row.theta)} + $q_{link}$"
        rows.append([str(link), turn, f"{row.d:g}", f"{row.a:g}", _angle(row.alpha)])
    header = ["link", "$theta_i$ (rad)", "$d_i$ (m)", "$a_i$ (m)", "$alpha_i$ (rad)"]
    return Table(caption, header, rows, (), origin(runs[run], number))


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


def printed_matrices(runs: Mapping[str, Run], run: str, caption: str, mini: bool, samples: int) -> Table:
    """Return how far the thesis' matrices, mended, and the model of an arm are apart at so many random states."""
    differences = compare(runs[run].model, mini, samples, np.random.default_rng(0))
    rows = [
        [f"${symbol}$", meaning, above_rounding(differences[symbol], unit)]
        for symbol, (meaning, unit) in _MEANINGS.items()
    ]
    return Table(caption, ["symbol", "quantity", "largest difference"], rows, (2,), origin(runs[run]))


def law(runs: Mapping[str, Run], run: str, caption: str, number: str) -> Picture:
    """Return the block diagram of the law of one arm that a run executed."""
    controller, limited = runs[run].config["controller"], runs[run].config["torque_limits"]["max"] is not None
    goal = runs[run].config["trajectory"]["kind"] == "goal"
    graph = operational_space_graph(controller["gravity_compensation"], controller["feedforward"], limited, goal)
    to, limit = "a goal at rest" if goal else "a moving target", "with" if limited else "without"
    words = f"Block diagram of one arm's loop: {to}, operational-space controller, arm {limit} torque limits, encoders"
    return Picture(caption, block_diagram(graph), words, 0.68, origin(runs[run], number))


def ratio(runs: Mapping[str, Run], number: str, metric: str, over: str = "full_equations") -> Measured:
    """Return a metric of a published figure under one preset over that under another, which is named."""
    experiment, other = _experiment(number), next(preset for preset in PRESET if preset != over)
    first, second = (measured(runs[f"{experiment}/{own}"], metric, f"{metric}, {PRESET[own]}") for own in (other, over))
    return first / second


def both(runs: Mapping[str, Run], number: str, metric: str) -> list[str]:
    """Return a metric of a published figure with the full equations, and as the thesis ran it, with its range."""
    stored = (runs[f"{_experiment(number)}/{preset}"].metrics.get(metric) for preset in reversed(PRESETS))
    return ["no value" if each is None or each.median is None else each.text for each in stored]


def alike(value: Measured) -> list[Condition]:
    """Return the conditions that a ratio is called the same as 1."""
    return [value < DIFFERENT, value > 1.0 / DIFFERENT]


def differs(*values: Measured) -> list[Condition]:
    """Return the conditions that ratios are larger than what is called the same as 1."""
    return [value > DIFFERENT for value in values]


def reproduced(
    runs: Mapping[str, Run],
    number: str,
    caption: str,
    metrics: Sequence[str],
    conditions: Sequence[Condition],
    until: float | None = None,
) -> list[Block]:
    """Return one published figure, such as "3.5", with both presets in it, and what the plant's step is worth in it.

    Args:
        runs: The runs of the study by name.
        number: Number of the figure.
        caption: What differs between the presets, and what moves.
        metrics: The metrics that the caption compares.
        conditions: The conditions for the caption; where one fails, a finding says so.
        until: End of the time axis, in s; None shows the whole runs.
    """
    experiment = _experiment(number)
    own = {words: runs[f"{experiment}/{preset}"] for preset, words in PRESET.items()}
    first = next(iter(own.values()))
    claims = [each for each in load_claims("thesis") if each.experiment == f"thesis/{experiment}" and each.printed]
    figure = Compared(own, claims, until)
    joints = list(range(1, len(first.provenance["joints"]) + 1))
    panels = figure.torques(joints)
    if len(first.provenance["stages"]) > 1:
        panels += figure.ticks(joints[3:]) if figure.chatters() else []
        panels += figure.errors("macro_error", "Macro's error")
    panels += figure.errors("error", "Tip error")
    if first.config["trajectory"]["kind"] == "goal":
        panels += figure.enlarged()
    told = {each.metric: each.number for each in claims}
    text = " ".join(filter(None, [step_of_both(own, metrics), *parting(own, told)]))
    told_of = f"{caption}; curves of repetition 0, numbers are medians (smallest to largest). {figure.scales()}".strip()
    curves = Curves(told_of, panels, 3, origin(first, f"figure {number}"))
    return [curves, Text(text), *check_caption(f"Figure {number}", caption, conditions)]


def _experiment(number: str) -> str:
    return f"figure_{number.replace('.', '_')}"


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
    """Return how many repetitions of a run diverge."""
    return int(run.config["repetitions"]) - len(at_rest(run))


def mass_of(runs: Mapping[str, Run], name: str, words: str = "mass of the Mini") -> Measured:
    """Return the mass of a run's Mini."""
    masses = runs[name].config["robot"]["stages"]["mini"]["masses"]
    return Measured(words, float(sum(masses.values())), "kg")


def around_the_break(runs: Mapping[str, Run], payload: str) -> tuple[str, str]:
    """Return the runs of the heaviest Mini with which one-way control works without noise, and of the next one.

    It is broken where the tip errs more than ten times as much as that of the thesis' Mini. Where none works, or none
    is broken, both are one.
    """
    names = [one.name for one in found(runs, f"mass/{{mass}}/{payload}")]
    limit = runs[f"mass/0.2/{payload}"].median("max_axis_error")
    errors = [runs[name].median("max_axis_error") for name in names]
    broken = [error is None or limit is None or error > _BROKEN * limit for error in errors]
    first = broken.index(True) if any(broken) else len(names)
    return names[max(first - 1, 0)], names[min(first, len(names) - 1)]


def fastest(runs: Mapping[str, Run], pattern: str) -> str:
    """Return the name of the run that settles first among those of a pattern; the first one where none settles."""
    times = {one.name: one.run.median("settling_time") for one in found(runs, pattern)}
    return min(times, key=lambda name: math.inf if times[name] is None else float(times[name] or 0.0))


def level_in_words(name: str, place: int) -> str:
    """Return a part of a run's name in words, counted from 0."""
    return in_words(name.split("/")[place])


def excess(simulated: Callable[[Run], float | None], predicted: Callable[[Run], float]) -> Callable[[Run], str]:
    """Return what gives by how much a value of a run is larger than predicted, in per cent, for a table."""

    def text(run: Run) -> str:
        value, closed = simulated(run), predicted(run)
        more = 100.0 * (value / closed - 1.0) if closed and value is not None else math.nan
        return "below 0.01 %" if abs(more) < 0.01 else f"{more:+.2f} %"

    return text


def sag(run: Run) -> float:
    """Return |J M^-1 G| / omega_n^2 at the run's final true joint positions, in m."""
    model = run.model
    q = run.joints("q")[-1]
    fall = model.tip_jacobian(q)[:3] @ np.linalg.solve(model.mass_matrix(q), model.gravity_torque(q))
    return float(np.linalg.norm(fall / run.config["controller"]["natural_frequency"] ** 2))


def ten_times(column: str) -> Callable[[Run, Run], FloatArray]:
    """Return a signal of the Mini ten times as large, at the ticks of the Macro."""
    return lambda macro, mini: 10.0 * mini.trace()[column].to_numpy()[: len(macro.trace())]


def printed_range(claim: int, low: float, high: float) -> list[Series]:
    """Return the range that a claim prints as a band between two durations."""
    ends = [np.full(2, printed(claim, end, "").value) for end in (0, -1)]
    return [Series("printed range", np.array([low, high]), ends[1], "dotted", low=ends[0], high=ends[1])]


def duration_of(runs: Mapping[str, Run], pattern: str, error: Measured, words: str) -> Measured:
    """Return at which duration, between those of a pattern's runs, the largest axis error is that given."""
    tried = found(runs, pattern)
    errors = values((one.run for one in tried), "max_axis_error")
    times = [float(one.levels["t_f"]) for one in tried]
    return Measured(words, float(np.interp(-float(error.value or 0.0), -errors, times)), "s")


def mass_ratio(run: Run) -> float:
    """Return the mass of a run's Mini over that of its Macro."""
    mini, macro = (sum(run.config["robot"]["stages"][stage]["masses"].values()) for stage in ("mini", "macro"))
    return float(mini / macro)


def heavier_than(runs: Mapping[str, Run], name: str, payload: str) -> list[Measured]:
    """Return the tip error with each Mini that is heavier than that of a run."""
    return [
        measured(one.run, "max_axis_error", f"tip error, {one.levels['mass']} kg, payload {payload}")
        for one in found(runs, f"mass/{{mass}}/{payload}")
        if mass_ratio(one.run) > mass_ratio(runs[name])
    ]


def final_difference(run: Run, reference: Run) -> float:
    """Return the distance of the joint positions at the end of two runs, in rad."""
    last, final = (each.joints("q")[-1] for each in (run, reference))
    return float(np.linalg.norm(last - final))


def to_step_before(runs: Mapping[str, Run]) -> Callable[[Run], str]:
    """Return what gives the difference of a run over that of the one before it, with twice its step, for a table."""
    reference = runs["plants/rk4"]
    tried = [one.run for one in found(runs, "plants/{step}") if one.run is not reference]

    def ratio(run: Run) -> str:
        before = tried[tried.index(run) - 1]
        return f"{final_difference(run, reference) / final_difference(before, reference):.3f}"

    return ratio


_REST = 0.5  # s, at the end of a run


def lag(run: Run) -> float:
    """Return the norm of the largest lag, in m."""
    return float(np.linalg.norm(_lag(run)))


def lag_along(axis: str, signed: bool = False) -> Callable[[Run], float]:
    """Return the largest lag along an axis, desired less true position, without its sign unless asked for, in m."""
    along = AXES.index(axis)
    return lambda run: float(_lag(run)[along] if signed else abs(_lag(run)[along]))


def error_in_z_at_rest(run: Run) -> float:
    """Return the mean error in z at the end of a run, in m."""
    at_rest = run.t > run.t[-1] - _REST
    return float(run.vector("error")[at_rest].mean(axis=0)[2])


def _lag(run: Run) -> FloatArray:
    """Return the largest lag along each axis, desired less true position, shape (3,), in m."""
    controller, desired = run.config["controller"], run.vector("desired")
    factor = 2.0 * float(controller["damping_ratio"]) / float(controller["natural_frequency"])
    return np.asarray(factor * 1.875 * (desired[-1] - desired[0]) / float(run.config["trajectory"]["duration"]))


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
            *(cell(runs[f"{goal}/{preset}"], stage + metric) for metric in ("settling_time", "steady_state_error")),
            *(cell(runs[f"{track}/{preset}"], stage + metric) for metric in ("max_axis_error", "steady_state_error")),
        ]
        for preset in PRESETS
        for name, goal, track, stage in _ARMS
    ]


def encoder_bound(run: Run) -> float | None:
    """Return the largest axis error of the Macro's end point as its encoders tell it at the last posture, in m."""
    q, frame = run.joints("q")[-1], run.provenance["stages"]["mini"]
    if not np.isfinite(q).all():
        return None
    model, step = run.model, 1e-6
    at_rest, *moved = (model.frame_poses(q + step * joint, (frame,))[0][:3, 3] for joint in np.eye(4, len(q), -1))
    slopes = np.abs([each - at_rest for each in moved]).sum(axis=0) / step  # the first of four moves no joint
    return float(slopes.max() * run.config["noise"]["position"]["macro"])
