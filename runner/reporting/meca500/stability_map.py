"""Up to which wall a sampled admittance is stable: the predicted bound and what runs show."""

from collections.abc import Mapping

import numpy as np

from runner.controllers.admittance_stability import stiffest_wall
from runner.reporting.document import Curves, Formula, Notice, Panel, Section, Series, Table, Text
from runner.reporting.figures import origin
from runner.reporting.meca500.plan import DAMPING, MAP_PERIODS, MAP_SHARES, MASS, STIFFNESS, law
from runner.reporting.meca500.servo_compliance import servo_compliance
from runner.reporting.meca500.signals import wrenches
from runner.reporting.quantities import number
from runner.store import Run

_STILL = 1e-4  # N, below which a force that swings is rounding


def bounces(run: Run) -> bool:
    """Tell whether contact is unstable as observed.

    It is where in the last third of a run the tip leaves the wall, or the force swings more widely than in the third
    before.
    """
    force = -wrenches(run, "external")[:, 0]
    third = len(force) // 3
    before, last = force[third : 2 * third], force[-third:]
    return bool(last.min() <= 0.0 or np.ptp(last) > max(np.ptp(before), _STILL))


def stability_map_section(runs: Mapping[str, Run]) -> Section:
    """Return the map over the wall's stiffness and the period, on both plants."""
    rows = []
    for plant, periods in MAP_PERIODS.items():
        for period in periods:
            found = {share: runs[f"map/{plant}/{period}/{share}"] for share in MAP_SHARES[plant]}
            stable = [_wall(run) for run in found.values() if not bounces(run)]
            unstable = [_wall(run) for run in found.values() if bounces(run)]
            rows.append(
                [
                    plant,
                    f"{1e3 * period:g}",
                    number(stiffest_wall(law(), period, 0, 0.0, 0)),
                    number(stiffest_wall(law(), period, 0, 0.0, 1)),
                    _servo_spring(next(iter(found.values()))) if plant == "bullet" else "–",
                    number(max(stable)) if stable else "–",
                    number(min(unstable)) if unstable else "none",
                ]
            )
    first = runs[f"map/kinematic/0.001/{MAP_SHARES['kinematic'][0]}"]
    right, count = agreement(runs)
    return Section(
        "Stability at a wall over its stiffness and the sample time",
        (
            Text(
                "In contact the sampled law and the wall close a loop: what the tip does in one period is felt in the "
                "next, and a stiff wall answers more than it is asked. One period takes the state of velocity and "
                "positions from one tick to the next by a matrix, and contact is stable where its eigenvalues lie "
                "inside the unit circle. The arm reaches each command by the next tick (delay 0), or a tick later "
                "(delay 1), which is what a wall is refused by before a run on servos:"
            ),
            Formula(
                "vec(dot(x)_(k+1), x_(k+1)) = Phi vec(dot(x)_k, x_k) - Gamma k_w x_(k-d), quad "
                'max abs(lambda) < 1, quad d = 0 "or" 1',
                "the next velocity and position are Phi times the last ones minus Gamma times k w times the position d "
                "ticks before; stable where the largest modulus of an eigenvalue is below one; d is zero or one",
            ),
            Text(
                f"The law has $M = {MASS:g}$ kg, $B = {DAMPING:g}$ N s/m, $K = {STIFFNESS:g}$ N/m; the wall has no "
                "damping. The tip stands at the wall, and its goal goes 10 mm into it. A run counts as unstable when "
                "in its last third the tip leaves the wall, or the force swings more widely than in the third before."
            ),
            _map(runs),
            Table(
                "Stiffest wall, in N/m: predicted, and between which runs the observed bound lies.",
                [
                    "plant",
                    "period (ms)",
                    "predicted, delay 0",
                    "predicted, delay 1",
                    "spring of the servos",
                    "stiffest stable",
                    "softest unstable",
                ],
                rows,
                tuple(range(1, 7)),
                origin(first),
            ),
            Notice(
                "finding",
                "Where the arm follows, the bound is exact; on servos it is on the safe side",
                f"On the kinematic plant {right} of {count} runs, from half the bound to twice it, are stable or not "
                "as predicted, the nearest 10 % from the bound. The bound falls with the sample time: about "
                f"2 B / h, so that the real controller's 16.7 ms stands "
                f"{number(stiffest_wall(law(), MAP_PERIODS['kinematic'][-1], 0, 0.0, 0))} N/m at this damping. On "
                "joint servos no run has bounced, far beyond both bounds: the servos' own springs, in series with the "
                "wall, keep what the law feels softer than any wall. The check before a run, with a delay of a tick, "
                "does not count on that.",
            ),
        ),
    )


def _wall(run: Run) -> float:
    return float(run.config["environment"]["stiffness"])


def _servo_spring(run: Run) -> str:
    return number(1.0 / float(servo_compliance(run)[0, 0]))


def agreement(runs: Mapping[str, Run]) -> tuple[int, int]:
    """Return how many runs on the kinematic plant are stable or not as predicted, and of how many."""
    agree = [
        bounces(runs[f"map/kinematic/{period}/{share}"]) == (share > 1.0)
        for period in MAP_PERIODS["kinematic"]
        for share in MAP_SHARES["kinematic"]
    ]
    return sum(agree), len(agree)


def _map(runs: Mapping[str, Run]) -> Curves:
    periods = np.geomspace(MAP_PERIODS["kinematic"][0], MAP_PERIODS["kinematic"][-1], 12)
    bounds = {delay: np.array([stiffest_wall(law(), h, 0, 0.0, delay) for h in periods]) for delay in (0, 1)}
    panels = []
    for plant in MAP_PERIODS:
        points: dict[bool, list[tuple[float, float]]] = {False: [], True: []}
        for period in MAP_PERIODS[plant]:
            for share in MAP_SHARES[plant]:
                run = runs[f"map/{plant}/{period}/{share}"]
                points[bounces(run)].append((1e3 * period, _wall(run)))
        series = [
            Series(f"predicted, delay {delay}", 1e3 * periods, bound, "line" if delay == 0 else "dashed")
            for delay, bound in bounds.items()
        ]
        for unstable, name in ((False, "stable"), (True, "unstable")):
            if points[unstable]:
                x, y = np.array(points[unstable]).T
                series.append(Series(name, x, y, "points"))
        panels.append(Panel(plant, "sample time (ms)", "stiffness of the wall (N/m)", series, x_log=True, y_log=True))
    return Curves(
        "Stability of contact over sample time and stiffness of the wall.",
        panels,
        2,
        origin(runs[f"map/kinematic/0.001/{MAP_SHARES['kinematic'][0]}"]),
    )
