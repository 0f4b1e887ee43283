"""Joint motion that the tip does not feel: how still the tip stands."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from runner.reporting.document import Block, Curves, FloatArray, Notice, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, joint_columns, model_of, origin
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import clock, failures, median
from runner.reporting.xarm7.null_space_cycles import cycles_section
from runner.reporting.xarm7.null_space_manipulability import manipulability_section
from runner.reporting.xarm7.studies_plan import FASTEST_RATE, RULES, SPEEDS
from runner.store import Run

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
        _finding(runs),
        *failures(ours),
    ]
    return Section("Null-space motion at fixed tip", blocks)


def _row(run: Run) -> list[str]:
    controller, plant, tip = run.config["controller"], run.config["plant"]["kind"], standing(run)
    return [
        controller["integration"],
        f"{1.0 / controller['period']:g}",
        "kinematic" if plant == "kinematic" else f"{plant}, servo",
        number(median(run, "peak_joint_speed")),
        number(tip.travel),
        number(tip.at_ticks),
        number(tip.between) if plant == "kinematic" else "–",
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
        tips.append(Series(rule, clock(run), np.where(distance > 0.0, distance, np.nan)))
    tips.append(Series("bound", clock(fastest), np.full(len(q), BOUND), "dashed"))
    return Curves(
        f"Joints and tip at up to {SPEEDS[-1]:g} rad/s.",
        (
            Panel("Joints (rk4)", "time (s)", "joint position (rad)", joints),
            Panel("Tip, by rule", "time (s)", "distance from the start (m)", tips, y_log=True, y_range=(1e-12, 1e-3)),
        ),
        2,
        origin(fastest),
    )


def _finding(runs: Mapping[str, Run]) -> Notice:
    speed = SPEEDS[-1]
    moved = {rule: standing(runs[f"null_space/{rule}/{speed}"]) for rule in RULES}
    good = [rule for rule in RULES if moved[rule].at_ticks < BOUND]
    parts = ", ".join(f"{rule} {quantity(moved[rule].at_ticks, 'm')}" for rule in RULES)
    often = standing(runs["null_space/fastest rate"])
    servo = standing(runs["null_space/servo"])
    rk4 = moved["rk4"]
    needed = FASTEST_RATE * float(np.sqrt(often.between / BOUND))
    return Notice(
        "finding",
        f"At {speed:g} rad/s the tip stays within {quantity(BOUND, 'm')} with {' or '.join(good) or 'no rule'}",
        f"At the commands the tip moves by {parts}. Our law's own rule is midpoint, which is enough for slower motion "
        "and for the line; fast null-space motion asks for controller.integration=rk4. Between two commands the "
        "joints move evenly, along a chord of that curved surface, and the tip leaves its place by up to "
        f"{quantity(rk4.between, 'm')}, whatever the rule: it falls with the square of the rate, to "
        f"{quantity(often.between, 'm')} at {FASTEST_RATE} Hz, and below {quantity(BOUND, 'm')} from "
        f"{number(needed, 2)} Hz on. With servos on an arm with mass it is "
        f"the servos that move the tip, by {quantity(servo.at_ticks, 'm')} as the motion sets in.",
    )
