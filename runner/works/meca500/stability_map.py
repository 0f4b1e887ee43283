"""Up to which wall a sampled admittance is stable: the predicted bound and what runs show."""

from collections.abc import Mapping

import numpy as np

from runner.controllers.admittance_stability import stiffest_wall
from runner.reporting.document import Curves, Formula, Panel, Section, Series, Table, Text
from runner.reporting.figures import origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import number
from runner.store import Run
from runner.works.meca500.bouncing import bounces
from runner.works.meca500.plan import DAMPING, MAP_PERIODS, MAP_SHARES, MASS, STIFFNESS, law
from runner.works.meca500.servo_walls import servo_wall_blocks, wall_of


def stability_map_section(runs: Mapping[str, Run]) -> Section:
    """Return the map over the wall's stiffness and the period, and what servos make of it."""
    rows = []
    for period in MAP_PERIODS:
        found = [runs[f"map/kinematic/{period}/{share}"] for share in MAP_SHARES]
        stable = [wall_of(run) for run in found if not bounces(run)]
        unstable = [wall_of(run) for run in found if bounces(run)]
        rows.append(
            [
                f"{1e3 * period:g}",
                number(stiffest_wall(law(), period, 0, 0.0, 0)),
                number(stiffest_wall(law(), period, 0, 0.0, 1)),
                number(max(stable)) if stable else "none",
                number(min(unstable)) if unstable else "none",
            ]
        )
    first = runs[f"map/kinematic/{MAP_PERIODS[0]}/{MAP_SHARES[0]}"]
    return Section(
        "Stability at a wall over its stiffness and the sample time",
        (
            Text(
                "In contact the sampled law and the wall close a loop: what the tip does in one period is felt in the "
                "next, and a stiff wall answers more than it is asked. One period takes the state of velocity and "
                "positions from one tick to the next by a matrix, and contact is stable where its eigenvalues lie "
                "inside the unit circle. That holds for ideal joints, which go where they are told: they reach each "
                "command by the next tick (delay 0), or a tick later (delay 1). The masses and servos of an arm are "
                "not in it:"
            ),
            Formula(
                "vec(dot(x)_(k+1), x_(k+1)) = Phi vec(dot(x)_k, x_k) - Gamma k_w x_(k-d), quad "
                'max abs(lambda) < 1, quad d = 0 "or" 1',
                "the next velocity and position are Phi times the last ones minus Gamma times k w times the position d "
                "ticks before; stable where the largest modulus of an eigenvalue is below one; d is zero or one",
            ),
            Text(
                f"The law has $M = {MASS:g}$ kg, $B = {DAMPING:g}$ N s/m, $K = {STIFFNESS:g}$ N/m; the wall has no "
                "damping. The tip stands at the wall, and with ideal joints its goal goes 10 mm into it. A run counts "
                "as unstable when in its last third the tip leaves the wall, or the force swings more widely than in "
                "the third before."
            ),
            _map(runs),
            Table(
                "Stiffest wall, in N/m: predicted for ideal joints, and between which runs the observed bound lies.",
                [
                    "period (ms)",
                    "predicted, delay 0",
                    "predicted, delay 1",
                    "stiffest stable",
                    "softest unstable",
                ],
                rows,
                tuple(range(5)),
                origin(first),
            ),
            ideal_wall_finding(**ideal_wall_values(runs)),
            *servo_wall_blocks(runs),
        ),
    )


def ideal_wall_values(runs: Mapping[str, Run]) -> dict[str, Measured]:
    """Return what the finding on walls before ideal joints is about."""
    right, count = agreement(runs)
    shares, periods = MAP_SHARES, MAP_PERIODS
    about = [stiffest_wall(law(), period, 0, 0.0, 0) * period / (2.0 * DAMPING) for period in periods]
    return {
        "right": Measured("runs stable or not as predicted", right),
        "count": Measured("runs on the kinematic plant", count),
        "nearest": Measured("least distance from the bound", 100.0 * min(abs(share - 1.0) for share in shares), "%"),
        "least": Measured("least wall over the bound", min(shares)),
        "most": Measured("largest wall over the bound", max(shares)),
        "period": Measured("longest sample time", 1e3 * periods[-1], "ms"),
        "bound": Measured("bound at the longest sample time", stiffest_wall(law(), periods[-1], 0, 0.0, 0), "N/m"),
        "low": Measured("least ratio of the bound to 2 B / h", min(about)),
        "high": Measured("largest ratio of the bound to 2 B / h", max(about)),
    }


def ideal_wall_finding(
    right: Measured,
    count: Measured,
    nearest: Measured,
    least: Measured,
    most: Measured,
    period: Measured,
    bound: Measured,
    low: Measured,
    high: Measured,
) -> Finding:
    """Return how well the bound tells which walls an arm of ideal joints stands."""
    return finding(
        "For ideal joints the bound tells which wall the law stands",
        f"On the kinematic plant, whose joints go where they are told, {right} of {count} runs, from {least} to {most} "
        f"times the bound, are stable or not as predicted, the nearest {nearest} from it. Here filter and wall alone "
        f"close the loop. The bound falls with the sample time: it is {low} to {high} times $2 B slash h$, and "
        f"{bound} at {period} and this damping.",
        right >= count,
        count >= 20.0,
        least < 0.9,
        most > 1.1,
        nearest < 20.0,
        low > 0.9,
        high < 1.25,
    )


def agreement(runs: Mapping[str, Run]) -> tuple[int, int]:
    """Return how many runs on the kinematic plant are stable or not as predicted, and of how many."""
    agree = [
        bounces(runs[f"map/kinematic/{period}/{share}"]) == (share > 1.0)
        for period in MAP_PERIODS
        for share in MAP_SHARES
    ]
    return sum(agree), len(agree)


def _map(runs: Mapping[str, Run]) -> Curves:
    periods = np.geomspace(MAP_PERIODS[0], MAP_PERIODS[-1], 12)
    bounds = {delay: np.array([stiffest_wall(law(), h, 0, 0.0, delay) for h in periods]) for delay in (0, 1)}
    points: dict[bool, list[tuple[float, float]]] = {False: [], True: []}
    for period in MAP_PERIODS:
        for share in MAP_SHARES:
            run = runs[f"map/kinematic/{period}/{share}"]
            points[bounces(run)].append((1e3 * period, wall_of(run)))
    series = [
        Series(f"predicted, delay {delay}", 1e3 * periods, bound, "line" if delay == 0 else "dashed")
        for delay, bound in bounds.items()
    ]
    for unstable, name in ((False, "stable"), (True, "unstable")):
        if points[unstable]:
            x, y = np.array(points[unstable]).T
            series.append(Series(name, x, y, "points"))
    return Curves(
        "Stability of contact with ideal joints over sample time and stiffness of the wall.",
        [Panel("kinematic", "sample time (ms)", "stiffness of the wall (N/m)", series, x_log=True, y_log=True)],
        1,
        origin(runs[f"map/kinematic/{MAP_PERIODS[0]}/{MAP_SHARES[0]}"]),
    )
