"""The report's kinematics against the model: chain, tip position, inverse kinematics and its branches."""

from collections.abc import Mapping, Sequence
from itertools import product

import numpy as np

from runner.reporting.document import Formula, Section, Table, Text
from runner.reporting.figures import model_of, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import number, quantity
from runner.robots.model import FloatArray
from runner.robots.three_joint import BRANCHES, MOVING, Branch, ThreeJointArm
from runner.store import Run
from runner.works.xarm7.printed_kinematics import (
    CENTIMETRES,
    Mended,
    chain_tip,
    printed_inverse,
    printed_tip,
    random_postures,
)

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
    chain, symbols = (
        np.linalg.norm([formula(q) for q in postures] - tips, axis=1) for formula in (chain_tip, printed_tip)
    )
    rows = [
        [name, what, quantity(float(apart.max()), "m"), quantity(float(np.median(apart)), "m")]
        for name, what, apart in (
            ("$A_14, A_24, A_34$", "the product of the printed transforms, in numbers", chain),
            ("$P_(e x), P_(e y), P_(e z)$", "the same in symbols", symbols),
        )
    ]
    return Section(
        "The tip's position",
        (
            Text(
                "The report prints the tip's position twice: as product of its transforms, and in symbols. Both are "
                f"held against the arm's published dimensions, over {_SAMPLES} random postures within the joint "
                "limits. Behind $l_4$ and $l_5$ the symbols have $q_1$, $q_5$ and $q_2$ where the transforms have "
                "the constants $theta_1$ and $theta_2$; the Jacobian is printed with the same symbols."
            ),
            Table(
                "Distance between the printed tip position and the model's.",
                ["printed", "what it is", "largest", "median"],
                rows,
                (2, 3),
                origin(run),
            ),
            conclude_forward(
                Measured("largest distance of the transforms' tip", float(chain.max()), "m"),
                Measured("median distance of the tip in symbols", float(np.median(symbols)), "m"),
            ),
        ),
    )


def conclude_forward(chain: Measured, symbols: Measured) -> Finding:
    """Return which of the printed tip positions is right.

    Args:
        chain: Largest distance of the tip by the printed transforms from the model's.
        symbols: Median distance of the tip in symbols.
    """
    return finding(
        "The printed transforms are right, the tip's position in symbols is not",
        f"The transforms place the tip within {chain} of the model, as far as the printed lengths and angles are "
        f"rounded. The tip's position in symbols is off by {symbols} in the median.",
        chain < 1e-4,
        symbols > 0.1,
    )


def _inverse(run: Run) -> Section:
    arm = ThreeJointArm(model_of(run), float(run.config["controller"]["wrist"]))
    points = _line(float(run.config["trajectory"]["start"][0]), run)
    exact = np.array([arm.solve(point, BRANCHES[0])[list(MOVING)] for point in points])
    rows, misses = [], []
    for name, mended in _CASES.items():
        q = np.array([printed_inverse(point, float(run.config["controller"]["wrist"]), mended) for point in points])
        off = np.abs(q - exact).max(axis=0)
        apart = np.linalg.norm([arm.tip(*row) for row in q] - points, axis=1)
        rows.append([name, number(float(off[1])), number(float(off[2])), number(float(apart.max()))])
        misses.append(Measured(f"tip's distance from the line, {name}", float(apart.max()), "m"))
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
                f"depends on the unit: the report's is the centimetre ({CENTIMETRES:g} to the metre)."
            ),
            Table(
                "Largest errors of the printed formulas along the line.",
                ["formulas", "$q_2$ (rad)", "$q_4$ (rad)", "tip (m)"],
                rows,
                (1, 2, 3),
                origin(run),
            ),
            conclude_inverse(misses[-1], misses[:-1]),
        ),
    )


def conclude_inverse(right: Measured, wrong: Sequence[Measured]) -> Finding:
    """Return what it takes to put the printed inverse kinematics right.

    Args:
        right: Largest distance of the tip from the line with both formulas put right.
        wrong: The same as printed, or with one of them put right.
    """
    least = min(wrong, key=lambda miss: np.inf if miss.value is None else miss.value)
    return finding(
        "Both formulas have to be put right, and nothing else",
        f"With both put right the tip is within {right} of the line, as far as the printed lengths are rounded: what "
        "else they take is printed right. As printed, or with one of them put right, the tip "
        f"misses the line by {least} or more. As the report tells of a tip that stays on the line, its code was "
        "probably right where its text is not.",
        right < 1e-4,
        *(miss > 50.0 * right for miss in wrong),
    )


def _branches(run: Run, other: float) -> Section:
    model = model_of(run)
    arm = ThreeJointArm(model, float(run.config["controller"]["wrist"]))
    printed = float(run.config["trajectory"]["start"][0])
    rows, misses = [], []
    room: dict[Branch, list[float]] = {branch: [] for branch in BRANCHES}
    for branch, x in product(BRANCHES, (printed, other)):
        points = _line(x, run)
        q = np.array([arm.solve(point, branch) for point in points])
        misses.append(float(np.abs(model.tip_positions(q) - points).max()))
        margins = model.limit_margins(q).min(axis=0)
        worst = int(np.argmin(margins))
        room[branch].append(float(margins[worst]))
        ranges = [f"{q[:, j].min():.2f} to {q[:, j].max():.2f}" for j in MOVING[1:]]
        rows.append([_name(branch), f"{x:g}", *ranges, f"{number(float(margins[worst]))} (q{worst + 1})"])
    wrist = float(run.config["controller"]["wrist"])
    meant = [printed_inverse(point, wrist, Mended(root=True, sign=True)) for point in _line(printed, run)]
    first = [arm.solve(point, BRANCHES[0])[list(MOVING)] for point in _line(printed, run)]
    return Section(
        "The four ways to reach a point",
        (
            Text(
                "The report mentions further solutions for $q_2$ and $q_4$ that it did not use. There are four: the "
                "arm faces the point or turns its back ($r < 0$), and the root in $q_4$ has two signs."
            ),
            Table(
                "Joint positions along the line, and the smallest distance to a joint limit, below zero beyond it.",
                ["branch", "X (m)", "$q_2$ (rad)", "$q_4$ (rad)", "smallest margin (rad)"],
                rows,
                (1, 4),
                origin(run),
            ),
            conclude_branches(
                Measured(f"smallest joint margin, {_name(BRANCHES[0])}", min(room[BRANCHES[0]]), "rad"),
                [
                    Measured(f"largest of the smallest joint margins, {_name(branch)}", max(room[branch]), "rad")
                    for branch in BRANCHES[1:]
                ],
                Measured("largest distance between a branch's tip and the line", max(misses), "m"),
                Measured(
                    "distance of the mended formulas from that branch",
                    float(np.abs(np.subtract(meant, first)).max()),
                    "rad",
                ),
            ),
        ),
    )


def conclude_branches(inside: Measured, others: Sequence[Measured], miss: Measured, meant: Measured) -> Finding:
    """Return which branch the joint limits leave.

    Args:
        inside: Smallest margin of the first branch to a joint limit at both values of X.
        others: The same of the others, at that value of X where it is larger.
        miss: Largest distance of any branch's tip from the line.
        meant: Largest difference between the first branch and the printed formulas put right.
    """
    return finding(
        f"One branch of {len(BRANCHES)} is inside the joint limits",
        "All of them lead the tip along the line. At both values of X the arm that faces the point with the plus sign "
        f"keeps {inside} to every joint limit; each of the others is beyond a limit. That branch is the one of the "
        "printed formulas, put right.",
        inside > 0.5,
        *(margin < -0.1 for margin in others),
        miss < 1e-9,
        meant < 1e-3,
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
