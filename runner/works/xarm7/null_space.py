"""Joint motion that the tip does not feel: how still the tip stands."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from runner.reporting.document import Block, Curves, FloatArray, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, joint_columns, model_of, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import above_rounding, number, quantity
from runner.reporting.run_values import clock, failures, median
from runner.reporting.words import in_words
from runner.store import Run
from runner.works.xarm7.null_space_cycles import cycles_section
from runner.works.xarm7.null_space_manipulability import manipulability_section
from runner.works.xarm7.plan import FASTEST_RATE, RULES, SPEEDS

BOUND = 1e-6  # m, of the tip at the commands


@dataclass(frozen=True)
class Standing:
    """How still a tip stands while the joints move.

    Attributes:
        travel: How far the joints have gone at the end: the largest of them, in rad.
        at_ticks: Largest distance of the tip from where it began, at the ticks, in m.
        between: Largest distance between ticks, half way, as joints move evenly from one to the next, in m.
    """

    travel: float
    at_ticks: float
    between: float


def standing(run: Run) -> Standing:
    """Return how still the tip of a run with a goal at its start stands."""
    model, q = model_of(run), joint_columns(run.trace, "q")
    tip = columns(run.trace, "tip")
    between = model.tip_positions(0.5 * (q[1:] + q[:-1]))
    return Standing(float(np.abs(q[-1] - q[0]).max()), _farthest(tip, tip[0]), _farthest(between, tip[0]))


def _farthest(points: FloatArray, place: FloatArray) -> float:
    return float(np.linalg.norm(points - place, axis=1).max(initial=0.0))


def null_space_section(runs: Mapping[str, Run]) -> Section:
    """Return what the joints to spare do: at a fixed tip, over several cycles, and for the arm's manipulability."""
    return Section(
        "What the joints to spare can do",
        (
            Text(
                "The tip's position needs three joints and its pose six. What seven joints have to spare is motion in "
                "the null space of the Jacobian, which the tip does not feel."
            ),
        ),
        (_fixed_tip(runs), cycles_section(runs), manipulability_section(runs)),
    )


def _fixed_tip(runs: Mapping[str, Run]) -> Section:
    """Return how still the tip stands under null-space motion, by speed and rule of integration."""
    ours = {name: run for name, run in runs.items() if name.startswith("null_space/")}
    fastest = runs[f"null_space/rk4/{SPEEDS[-1]}"]
    period = float(fastest.config["controller"]["period"])
    blocks: list[Block] = [
        Text(
            "The tip is told to stay half way between A and B, and the elbow to swing aside: a posture task in the "
            f"null space whose largest joint speed is bounded. Commands every {1e3 * period:g} ms to joints that go "
            "where they are told, unless said otherwise. Joint velocities that the tip does not feel are tangent to "
            "a curved surface of postures; how far a command leaves that surface depends on the rule by which the "
            "velocities are integrated. The tip's error is fed back beside it."
        ),
        Table(
            "Null-space motion at fixed tip: how far the tip moves.",
            [
                "rule",
                "commands (Hz)",
                "plant",
                "largest joint speed (rad/s)",
                "joint travel (rad)",
                "tip at the commands (m)",
                "tip between them (m)",
            ],
            [_row(run) for run in ours.values()],
            (1, 3, 4, 5, 6),
            origin(fastest),
        ),
        _curves(runs),
        _concluded(runs),
        *failures(ours),
    ]
    return Section("Null-space motion at fixed tip", blocks)


def _row(run: Run) -> list[str]:
    controller, plant, tip = run.config["controller"], run.config["plant"]["kind"], standing(run)
    return [
        in_words(controller["integration"]),
        f"{1.0 / controller['period']:g}",
        "kinematic" if plant == "kinematic" else f"{in_words(plant)}, servo",
        number(median(run, "peak_joint_speed")),
        number(tip.travel),
        above_rounding(tip.at_ticks),
        above_rounding(tip.between) if plant == "kinematic" else "–",
    ]


def _curves(runs: Mapping[str, Run]) -> Curves:
    fastest = runs[f"null_space/rk4/{SPEEDS[-1]}"]
    q = joint_columns(fastest.trace, "q")
    joints = [Series(f"q{joint + 1}", clock(fastest), q[:, joint]) for joint in range(q.shape[1])]
    tips = []
    for rule in RULES:
        run = runs[f"null_space/{rule}/{SPEEDS[-1]}"]
        tip = columns(run.trace, "tip")
        distance = np.linalg.norm(tip - tip[0], axis=1)
        tips.append(Series(in_words(rule), clock(run), np.where(distance > 0.0, distance, np.nan)))
    tips.append(Series("bound", clock(fastest), np.full(len(q), BOUND), "dashed"))
    return Curves(
        f"Joints and tip at up to {SPEEDS[-1]:g} rad/s.",
        (
            Panel("Joints (Runge-Kutta)", "time (s)", "joint position (rad)", joints),
            Panel("Tip, by rule", "time (s)", "distance from the start (m)", tips, y_log=True, y_range=(1e-12, 1e-3)),
        ),
        2,
        origin(fastest),
    )


def _concluded(runs: Mapping[str, Run]) -> Finding:
    moved = {rule: standing(runs[f"null_space/{rule}/{SPEEDS[-1]}"]) for rule in RULES}
    slower = standing(runs[f"null_space/midpoint/{SPEEDS[-2]}"])
    often, servo = (standing(runs[f"null_space/{name}"]) for name in ("fastest rate", "servo"))
    period = float(runs[f"null_space/rk4/{SPEEDS[-1]}"].config["controller"]["period"])
    return conclude(
        [Measured(f"tip's way at the commands, {rule}", moved[rule].at_ticks, "m") for rule in RULES],
        Measured(f"tip's way at the commands, midpoint, {SPEEDS[-2]:g} rad/s", slower.at_ticks, "m"),
        [Measured(f"tip's way between the commands, {rule}", moved[rule].between, "m") for rule in RULES],
        Measured(f"tip's way between the commands at {FASTEST_RATE:g} Hz", often.between, "m"),
        FASTEST_RATE * period,
        Measured("tip's way with servos", servo.at_ticks, "m"),
        Measured("time of the tip's largest distance with servos", _time_of_farthest(runs["null_space/servo"]), "s"),
    )


def conclude(
    at_ticks: Sequence[Measured],
    slower: Measured,
    between: Sequence[Measured],
    often: Measured,
    more: float,
    servo: Measured,
    farthest: Measured,
) -> Finding:
    """Return how still the tip stands at the largest speed.

    Args:
        at_ticks: Largest distance of the tip from its place at the commands, by each rule.
        slower: The same by the midpoint rule at the next lower speed.
        between: The same between the commands, by each rule.
        often: The same by the best rule at the largest rate of commands.
        more: How many times the usual rate that is.
        servo: Largest distance with servos on an arm with mass.
        farthest: When that is.
    """
    euler, midpoint, rk4 = at_ticks
    return finding(
        f"At {SPEEDS[-1]:g} rad/s the tip stays within {quantity(BOUND, 'm')} by Runge-Kutta alone",
        f"At the commands the tip moves by {euler} by Euler's rule, {midpoint} by the midpoint rule, and {rk4} by "
        f"Runge-Kutta. The rule that the seven joints run by in this report is midpoint, which is enough at "
        f"{SPEEDS[-2]:g} rad/s ({slower}); faster null-space motion asks for controller.integration={RULES[-1]}. "
        "Between two commands the joints move evenly, along a chord of that curved surface, and the tip leaves its "
        f"place by {between[-1]} or more, whatever the rule: it falls with the square of the rate, to {often} at "
        f"{FASTEST_RATE:g} Hz. With servos on an arm with mass it is the servos that move the tip, by {servo} as the "
        f"motion sets in, {farthest} after the start.",
        rk4 < 0.1 * BOUND,
        midpoint > 2.0 * BOUND,
        euler > 2.0 * BOUND,
        slower < 0.7 * BOUND,
        *(each > 0.9 * between[-1] for each in between[:-1]),
        (between[-1] / often).near(more**2, 0.05),
        servo > 30.0 * between[-1],
        farthest < 0.2,
    )


def _time_of_farthest(run: Run) -> float:
    tip = columns(run.trace, "tip")
    return float(clock(run)[int(np.argmax(np.linalg.norm(tip - tip[0], axis=1)))])
