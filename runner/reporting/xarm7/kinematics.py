"""The report's kinematics against the model: chain, tip position, inverse kinematics and its branches."""

from collections.abc import Mapping
from itertools import product

import numpy as np

from runner.reporting.document import Formula, Notice, Section, Table, Text
from runner.reporting.figures import model_of, origin
from runner.reporting.quantities import number, quantity
from runner.reporting.xarm7.printed_kinematics import (
    CENTIMETRES,
    Mended,
    chain_tip,
    printed_inverse,
    printed_tip,
    random_postures,
)
from runner.robots.model import FloatArray
from runner.robots.three_joint import BRANCHES, MOVING, Branch, ThreeJointArm
from runner.store import Run

_SAMPLES = 1000
_PLACES = 41  # along the line
_CASES = {
    "as printed, lengths in cm": Mended(root=False, sign=False),
    "as printed, lengths in m": Mended(root=False, sign=False, unit=1.0),
    "$q_2$ put right, in cm": Mended(root=False, sign=True),
    "$q_2$ put right, in m": Mended(root=False, sign=True, unit=1.0),
    "$q_4$ put right": Mended(root=True, sign=False),
    "both put right": Mended(root=True, sign=True),
}


def kinematics_section(runs: Mapping[str, Run]) -> Section:
    """Return what of the report's kinematics is right, and by how much the rest is wrong."""
    run = runs["three_joints/sound"]
    parts = (
        _forward(run),
        _inverse(run),
        _branches(run, float(runs["round_posture/sound"].config["trajectory"]["start"][0])),
    )
    return Section("Kinematics as printed", sections=parts)


def _forward(run: Run) -> Section:
    model = model_of(run)
    postures = random_postures(model, _SAMPLES)
    tips = model.tip_positions(postures)
    rows = [
        [name, what, quantity(float(apart.max()), "m"), quantity(float(np.median(apart)), "m")]
        for name, what, formula in (
            ("$A_14, A_24, A_34$", "the product of the printed transforms, in numbers", chain_tip),
            ("$P_(e x), P_(e y), P_(e z)$", "the same in symbols", printed_tip),
        )
        for apart in [np.linalg.norm([formula(q) for q in postures] - tips, axis=1)]
    ]
    return Section(
        "The tip's position",
        (
            Text(
                "The printed chain and the arm's published dimensions are the same to the rounding of $l_4$, "
                f"$theta_1$, $l_5$ and $theta_2$. The tip's position is printed twice; over {_SAMPLES} random "
                "postures within the joint limits the first form agrees with the model, and the second does not: "
                "where $theta_1$ and $theta_2$ are meant, behind $l_4$ and $l_5$, it has $q_1$, $q_5$ and $q_2$. "
                "The Jacobian inherits this."
            ),
            Table(
                "Distance between the printed tip position and the model's.",
                ["printed", "what it is", "largest", "median"],
                rows,
                (2, 3),
                origin(run),
            ),
        ),
    )


def _inverse(run: Run) -> Section:
    arm = ThreeJointArm(model_of(run), float(run.config["controller"]["wrist"]))
    points = _line(float(run.config["trajectory"]["start"][0]), run)
    exact = np.array([arm.solve(point, BRANCHES[0])[list(MOVING)] for point in points])
    rows = []
    for name, mended in _CASES.items():
        q = np.array([printed_inverse(point, float(run.config["controller"]["wrist"]), mended) for point in points])
        off = np.abs(q - exact).max(axis=0)
        apart = np.linalg.norm([arm.tip(*row) for row in q] - points, axis=1)
        rows.append([name, number(float(off[1])), number(float(off[2])), number(float(apart.max()))])
    return Section(
        "Inverse kinematics",
        (
            Text("With $r$ the distance from the base axis and $z$ the height above the shoulder the report prints"),
            Formula(
                "q_2 = arctan (p_3 r - p_4 z) / (p_4 r - p_3 z), quad q_4 = arctan M / (sqrt(p_1^2 + p_2^2) - M^2) "
                "- arctan p_1 / p_2",
                "q two as the arc tangent of p three r minus p four z over p four r minus p three z; q four as the "
                "arc tangent of M over the root of p one squared plus p two squared, minus M squared, minus the arc "
                "tangent of p one over p two",
            ),
            Text("where forward kinematics asks for"),
            Formula(
                'q_2 = "atan2"(p_3 r - p_4 z, p_4 r + p_3 z), quad q_4 = "atan2"(M, plus.minus sqrt(p_1^2 + p_2^2 - '
                'M^2)) - "atan2"(p_1, p_2)',
                "q two as atan2 of p three r minus p four z and p four r plus p three z; q four as atan2 of M and "
                "plus or minus the root of p one squared plus p two squared minus M squared, minus atan2 of p one "
                "and p two",
            ),
            Text(
                "$M^2$ outside the root is a length to the fourth taken from a length squared, so that the answer "
                f"depends on the unit: the report's is the centimetre ({CENTIMETRES:g} to the metre). $p_1$ to $p_4$ "
                "and $M$ are printed right. As the report's own graphs follow the line, its code must have been "
                "right where its text is not."
            ),
            Table(
                "Largest errors of the printed formulas along the line; what is left in the end is the rounding of the "
                "printed lengths.",
                ["formulas", "$q_2$ (rad)", "$q_4$ (rad)", "tip (m)"],
                rows,
                (1, 2, 3),
                origin(run),
            ),
        ),
    )


def _branches(run: Run, other: float) -> Section:
    model = model_of(run)
    arm = ThreeJointArm(model, float(run.config["controller"]["wrist"]))
    printed = float(run.config["trajectory"]["start"][0])
    rows, outside, misses = [], set(), []
    for branch, x in product(BRANCHES, (printed, other)):
        points = _line(x, run)
        q = np.array([arm.solve(point, branch) for point in points])
        misses.append(float(np.abs(model.tip_positions(q) - points).max()))
        margins = model.limit_margins(q).min(axis=0)
        worst = int(np.argmin(margins))
        if margins[worst] < 0.0:
            outside.add(branch)
        ranges = [f"{q[:, j].min():.2f} to {q[:, j].max():.2f}" for j in MOVING[1:]]
        rows.append([_name(branch), f"{x:g}", *ranges, f"{number(float(margins[worst]))} (q{worst + 1})"])
    inside = [_name(branch) for branch in BRANCHES if branch not in outside]
    return Section(
        "The four ways to reach a point",
        (
            Text(
                "The report mentions further solutions for $q_2$ and $q_4$ that it did not use. There are four: the "
                "arm faces the point or turns its back ($r < 0$), and the root in $q_4$ has two signs. Each inverts "
                f"forward kinematics, to {number(max(misses))} m; the joint limits decide."
            ),
            Table(
                "Joint positions along the line, and the smallest distance to a joint limit, below zero beyond it.",
                ["branch", "X (m)", "$q_2$ (rad)", "$q_4$ (rad)", "smallest margin (rad)"],
                rows,
                (1, 4),
                origin(run),
            ),
            Notice(
                "finding",
                f"{len(inside)} of {len(BRANCHES)} branches is inside the joint limits",
                f"Inside at both values of X: {', '.join(inside)}. It is the one that the printed formulas are meant "
                "to choose.",
            ),
        ),
    )


def _name(branch: Branch) -> str:
    shoulder = "facing the point" if branch.shoulder > 0 else "turned away"
    return f"{shoulder}, {'plus' if branch.elbow > 0 else 'minus'}"


def _line(x: float, run: Run) -> FloatArray:
    """Return points along the line at some X, shape (K, 3), in m."""
    start, goal = (np.array(run.config["trajectory"][key]) for key in ("start", "goal"))
    points = np.linspace(start, goal, _PLACES)
    points[:, 0] = x
    return points
