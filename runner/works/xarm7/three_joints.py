"""The report's first part: the line by three joints, its figures, and the X that it prints."""

from collections.abc import Mapping, Sequence

import numpy as np

from runner.reporting.document import Block, Curves, Formula, Panel, Picture, Section, Series, Table, Text
from runner.reporting.drawings import arm_motion
from runner.reporting.figures import columns, joint_columns, model_of, origin, playback
from runner.reporting.findings import Finding, finding
from runner.reporting.job import PRESETS
from runner.reporting.measured import Measured
from runner.reporting.metric_titles import title
from runner.reporting.quantities import above_rounding, number
from runner.reporting.words import PRESET
from runner.robots.three_joint import MOVING
from runner.store import Run
from runner.works.xarm7.studies import measured_margin, smallest_margin

HEIGHT = 0.5  # m, of the axes of x, y and z alike, so that what does not move looks like it
_HALF_A_DIGIT = 5e-5  # m, of the last digit that the report prints of Z
_STILLS = (0.0, 0.25, 0.5)  # of the period: at A, half way, at B


def three_joints_section(runs: Mapping[str, Run]) -> Section:
    """Return the report's figures, ours beside them, and the two values of X."""
    run = runs["three_joints/sound"]
    period = float(run.config["trajectory"]["duration"])
    return Section(
        "The line by three joints",
        (
            Text(
                "Joints 1, 2 and 4 move; $q_3 = q_5 = q_7 = 0$ and $q_6 = 0.75$ rad. Every 10 ms the desired tip is "
                "turned into joint positions, which a perfect position servo reaches until the next. The desired tip "
                "goes from A to B and back by"
            ),
            Formula(
                "x(t) = A + 1/2 (B - A) (1 - cos(2 pi t slash T))",
                "x of t equals A plus half of B minus A times one minus cosine of two pi t over T",
            ),
            sketch(run),
            tip_curves(
                [(PRESET[preset], runs[f"three_joints/{preset}"]) for preset in PRESETS], "Graphs of x, y and z"
            ),
            joint_curves(runs),
            _error_curves(runs),
            _errors(runs),
            playback(run, "The line by three joints, full equations: from A to B.", 0.5 * period),
        ),
        (_two_values_of_x(runs),),
    )


def sketch(run: Run) -> Picture:
    """Return the arm at A, half way and at B in one picture."""
    trace, period = run.trace, float(run.config["trajectory"]["duration"])
    rows = [int(np.searchsorted(trace["t"].to_numpy(), share * period - 1e-9)) for share in _STILLS]
    tip, desired = columns(trace, "tip"), columns(trace, "desired")
    times = trace["t"].to_numpy()[rows].tolist()
    svg = arm_motion(model_of(run), joint_columns(trace, "q")[rows], times, tip, desired, desired[rows[-1]])
    return Picture(
        "The motion: the arm at A, half way, and at B (goal), drawn from the simulation.",
        svg,
        "The xArm7 in three postures with its tip on a horizontal line",
        0.75,
        origin(run, "sketch of the motion"),
    )


def tip_curves(runs: Sequence[tuple[str, Run]], label: str = "") -> Curves:
    """Return x, y and z of the tip over time, on axes of equal height.

    Args:
        runs: The runs with the names of their curves; the first one's desired tip is shown, too.
        label: What the source calls the figure.
    """
    first = runs[0][1]
    desired = columns(first.trace, "desired")
    panels = []
    for index, axis in enumerate("xyz"):
        series = [Series(name, run.trace["t"].to_numpy(), columns(run.trace, "tip")[:, index]) for name, run in runs]
        series.append(Series("desired", first.trace["t"].to_numpy(), desired[:, index], "dotted"))
        middle = 0.5 * float(desired[:, index].min() + desired[:, index].max())
        span = (middle - 0.5 * HEIGHT, middle + 0.5 * HEIGHT)
        panels.append(Panel(f"Axis {axis}", "time (s)", f"{axis} (m)", series, y_range=span))
    return Curves("Position of the tip over two periods.", panels, 3, origin(first, label))


def joint_curves(runs: Mapping[str, Run]) -> Curves:
    """Return q1, q2 and q4 over time."""
    pairs = [(preset, runs[f"three_joints/{preset}"]) for preset in PRESETS]
    panels = [
        Panel(
            f"Joint {joint + 1}",
            "time (s)",
            f"q{joint + 1} (rad)",
            [
                Series(
                    PRESET[preset],
                    run.trace["t"].to_numpy(),
                    run.trace[f"q{joint + 1}"].to_numpy(),
                    "line" if preset == PRESETS[0] else "dashed",
                )
                for preset, run in pairs
            ],
        )
        for joint in MOVING
    ]
    return Curves("Positions of the moving joints.", panels, 3, origin(pairs[0][1], "Graphs of q1, q2 and q4"))


def _error_curves(runs: Mapping[str, Run]) -> Curves:
    panels = []
    for preset in PRESETS:
        trace = runs[f"three_joints/{preset}"].trace
        error = columns(trace, "error")
        series = [Series(axis, trace["t"].to_numpy(), error[:, index]) for index, axis in enumerate("xyz")]
        panels.append(Panel(PRESET[preset].capitalize(), "time (s)", "tip error (m)", series))
    return Curves(
        "Desired less actual tip position, over two periods.",
        panels,
        2,
        origin(runs["three_joints/as_reported"]),
    )


def _errors(runs: Mapping[str, Run]) -> Table:
    names = ("max_tracking_error", "cross_track_error", "peak_joint_speed", "peak_torque")
    rows = [
        [
            title(name),
            *(
                above_rounding(m["median"], m["unit"])
                for p in PRESETS
                for m in [runs[f"three_joints/{p}"].metrics[name]]
            ),
        ]
        for name in names
    ]
    return Table(
        "Errors and efforts; the torque is what the motion asks for, by inverse dynamics.",
        ["metric", *PRESET.values()],
        rows,
        (1, 2),
        origin(runs["three_joints/as_reported"]),
    )


def _two_values_of_x(runs: Mapping[str, Run]) -> Section:
    pair = [runs["three_joints/sound"], runs["round_posture/sound"]]
    model = model_of(pair[0])
    home = np.array(pair[0].config["robot"]["home"])
    tip = model.tip_position(home)
    cells = [_posture_cells(run) for run in pair]
    xs = [float(run.config["trajectory"]["start"][0]) for run in pair]
    margins = [measured_margin(run, f"smallest joint margin at X = {x:g} m") for run, x in zip(pair, xs, strict=True)]
    reaches = [
        Measured(f"largest distance from the shoulder at X = {x:g} m", _reach(run), "m")
        for run, x in zip(pair, xs, strict=True)
    ]
    height = float(pair[0].config["trajectory"]["start"][2])
    rows = [[name, *values] for name, *values in zip(cells[0], *(c.values() for c in cells), strict=True)]
    blocks: list[Block] = [
        Text(
            f"The report prints X = {xs[0]:g} m. The posture with round angles "
            f"({', '.join(f'{q:g}' for q in home)} rad), which has the report's own $q_6$, holds the tip elsewhere. "
            "Here the printed value is kept, and both are run."
        ),
        Table(
            "Both values of X, full equations, over two periods.",
            ["quantity", *(f"X = {x:g} m" for x in xs)],
            rows,
            (1, 2),
            origin(pair[1]),
        ),
        conclude_misprint(
            Measured("X of the round posture", float(tip[0]), "m"),
            Measured("Z of the round posture", float(tip[2]), "m"),
            Measured("printed X with another digit", xs[1], "m"),
            Measured("printed Z", height, "m"),
            xs[0],
        ),
        conclude_reach(margins, reaches, xs),
    ]
    return Section("X = 0.643 or 0.6043?", blocks)


def conclude_misprint(x: Measured, z: Measured, other: Measured, height: Measured, printed: float) -> Finding:
    """Return why the printed X may be a misprint.

    Args:
        x: X of the tip in the posture with round angles.
        z: Z of it.
        other: The printed X with another digit in it.
        height: Z as printed.
        printed: X as printed, in m.
    """
    return finding(
        f"X = {printed:g} m may be a misprint of {number(other.value, 4)} m",
        f"The round posture holds the tip at X = {number(x.value, 4)} m, Z = {number(z.value, 4)} m: the printed Z to "
        "its last digit, and the printed X with a digit left out.",
        *(
            condition
            for apart in (z - height, x - other)
            for condition in (apart < _HALF_A_DIGIT, apart > -_HALF_A_DIGIT)
        ),
    )


def conclude_reach(margins: Sequence[Measured], reaches: Sequence[Measured], xs: Sequence[float]) -> Finding:
    """Return whether the line can be run at both values of X.

    Args:
        margins: Smallest margin to a joint limit at each.
        reaches: Largest distance of the tip from the shoulder at each.
        xs: The printed X and the other, in m.
    """
    return finding(
        "Both can be reached, with room at every joint",
        f"The smallest distance to a joint limit is {margins[0]} at X = {xs[0]:g} m and {margins[1]} at "
        f"X = {xs[1]:g} m. The larger X stretches the arm further, to {reaches[0]} from the shoulder in place of "
        f"{reaches[1]}. Reachability does not tell which of the two the authors ran.",
        *(margin > 0.5 for margin in margins),
        reaches[0] > 1.02 * reaches[1],
    )


def _reach(run: Run) -> float:
    """Return the largest distance of a run's tip from the shoulder, in m."""
    return float(np.linalg.norm(columns(run.trace, "tip") - model_of(run).shoulder, axis=1).max())


def _posture_cells(run: Run) -> dict[str, str]:
    q = joint_columns(run.trace, "q")
    cells = {f"q{j + 1} (rad)": f"{q[:, j].min():.3f} to {q[:, j].max():.3f}" for j in MOVING}
    return cells | {
        "smallest margin to a joint limit (rad)": smallest_margin(run),
        "largest distance from the shoulder (m)": number(_reach(run)),
        "largest tracking error (m)": number(run.metrics["max_tracking_error"]["median"]),
        "largest torque of q2 (N m)": number(run.metrics["peak_torque_q2"]["median"]),
        "largest joint speed (rad/s)": number(run.metrics["peak_joint_speed"]["median"]),
    }
