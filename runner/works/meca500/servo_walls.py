"""Up to which wall an admittance behind joint servos is stable: what its linear map tells and what runs show."""

import json
from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from runner.assembly import servo_contact
from runner.config.validation import validate
from runner.controllers.admittance_stability import stiffest_wall
from runner.reporting.document import Block, Curves, Panel, Series, Table, Text
from runner.reporting.figures import joint_columns, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import number
from runner.servo_contact import ServoContact, contact_radius, stiffest_servo_wall
from runner.store import Run
from runner.works.meca500.bouncing import bounces
from runner.works.meca500.plan import MAP_SHARES, SERVO_CASES, ServoCase, law


def servo_wall_blocks(runs: Mapping[str, Run]) -> list[Block]:
    """Return what is said of walls before an arm with servos."""
    rows = []
    for case in SERVO_CASES:
        found = [runs[case.job_name(share)] for share in MAP_SHARES]
        stable = [wall_of(run) for run in found if not bounces(run)]
        unstable = [wall_of(run) for run in found if bounces(run)]
        rows.append(
            [
                f"{1e3 * case.period:g}",
                f"{1e3 * case.tick:g}",
                number(case.spring),
                number(_bound(found[0])),
                number(stiffest_wall(law(), case.period, 0, 0.0, 0)),
                number(max(stable)) if stable else "none",
                number(min(unstable)) if unstable else "none",
                f"{sum(map(_as_told, found))} of {len(found)}",
            ]
        )
    first = runs[SERVO_CASES[0].job_name(MAP_SHARES[0])]
    return [
        Text(
            "Behind servos the arm's masses, the servos' springs and their periods close the loop too. There one "
            "period of the controller is followed tick by tick for small motions at the start: the sensor's reading "
            "with the tool's inertia, filter, inverse kinematics, set-points, servos, arm, and the wall as PyBullet "
            "has it. The largest modulus of the eigenvalues of that map tells, and a run tells it by a caveat. It "
            "holds while the tip presses and no joint is at its torque limit, so that the goal of these runs is 5 mm "
            "in the wall, where that of ideal joints is 10 mm."
        ),
        _figure(runs),
        Table(
            "Stiffest wall behind joint servos, in N/m: predicted, and between which runs the observed bound lies.",
            [
                "period (ms)",
                "of the servos (ms)",
                "their springs (N m/rad)",
                "predicted",
                "for ideal joints",
                "stiffest stable",
                "softest unstable",
                "as predicted",
            ],
            rows,
            tuple(range(8)),
            origin(first),
        ),
        servo_wall_finding(**servo_wall_values(runs)),
    ]


def servo_wall_values(runs: Mapping[str, Run]) -> dict[str, Measured]:
    """Return what the finding on walls before an arm with servos is about."""
    found = [runs[case.job_name(share)] for case in SERVO_CASES for share in MAP_SHARES]
    above = [run for run in found if _radius(run) > 1.0]
    below = [run for run in found if _radius(run) <= 1.0]
    wrong = [_saturation(run) for run in below if bounces(run)]
    calm = [_saturation(run) for run in below if not bounces(run)]
    bounds = {case: _bound(runs[case.job_name(MAP_SHARES[0])]) for case in SERVO_CASES}
    about = [bound / stiffest_wall(law(), case.period, 0, 0.0, 0) for case, bound in bounds.items() if bound]
    nearest = min(abs(wall_of(run) / bound - 1.0) for run in found if (bound := _bound(run)))
    return {
        "right": Measured("runs behind servos stable or not as predicted", sum(map(_as_told, found))),
        "count": Measured("runs behind servos", len(found)),
        "above": Measured("runs behind servos beyond the bound", len(above)),
        "bounced": Measured("those of them that bounced", sum(map(bounces, above))),
        "nearest": Measured("least distance from the bound", 100.0 * nearest, "%"),
        "wrong": Measured("runs that bounced below the bound", len(wrong)),
        "saturated": Measured(
            "least share of ticks at a torque limit in these", 100.0 * min(wrong) if wrong else None, "%"
        ),
        "calm": Measured("largest such share in the stable ones below it", 100.0 * max(calm) if calm else None, "%"),
        "low": Measured("least ratio of the bound to that of ideal joints", min(about)),
        "high": Measured("largest ratio of the bound to that of ideal joints", max(about)),
    }


def servo_wall_finding(
    right: Measured,
    count: Measured,
    above: Measured,
    bounced: Measured,
    nearest: Measured,
    wrong: Measured,
    saturated: Measured,
    calm: Measured,
    low: Measured,
    high: Measured,
) -> Finding:
    """Return how well the map of the whole loop tells which walls an arm with masses and servos stands."""
    return finding(
        "Behind servos the map of the whole loop tells the wall, while no joint is at its torque limit",
        f"Of {count} runs on joint servos {right} are stable or not as predicted, the nearest {nearest} from the "
        f"bound. Of the {above} beyond it {bounced} bounce. Below it {wrong} bounce, with a joint at its torque limit "
        f"in {saturated} of the ticks or more; in the stable ones below it is {calm} at most. The bound is {low} to "
        f"{high} times that of ideal joints: servos can make contact less stable, and, where they are soft, more.",
        right > count * 0.85,
        count >= 24.0,
        above >= 12.0,
        bounced >= above,
        nearest < 20.0,
        saturated > 50.0,
        calm < 20.0,
        low < 0.95,
        high > 1.5,
    )


def wall_of(run: Run) -> float:
    """Return the stiffness of a run's wall, in N/m."""
    return float(run.config["environment"]["stiffness"])


def _saturation(run: Run) -> float:
    """Return the largest share of ticks that a joint is at its torque limit."""
    joints = joint_columns(run.trace, "q").shape[1]
    return max(float(run.metrics[f"saturation_fraction_q{joint + 1}"]["values"][0]) for joint in range(joints))


def _as_told(run: Run) -> bool:
    return bounces(run) == (_radius(run) > 1.0)


def _radius(run: Run) -> float:
    return contact_radius(_contact(*_key(run)))


def _bound(run: Run) -> float | None:
    return _stiffest(*_key(run, {"stiffness": 1.0}))


def _key(run: Run, wall: Mapping[str, float] | None = None) -> tuple[str, tuple[float, ...]]:
    """Return a run's config, with other values of its wall, and its first posture, as what can be looked up."""
    config = {**run.config, "environment": {**run.config["environment"], **(wall or {})}}
    return json.dumps(config, sort_keys=True), tuple(joint_columns(run.trace, "q")[0].tolist())


@lru_cache(maxsize=64)
def _contact(config: str, q: tuple[float, ...]) -> ServoContact:
    contact = servo_contact(validate(json.loads(config)), np.array(q))
    assert contact is not None  # noqa: S101 - the plan's runs have servos, a law and a wall
    return contact


@lru_cache(maxsize=64)
def _stiffest(config: str, q: tuple[float, ...]) -> float | None:
    return stiffest_servo_wall(_contact(config, q))


def _figure(runs: Mapping[str, Run]) -> Curves:
    panels = []
    for case in SERVO_CASES:
        points: dict[bool, list[tuple[float, float]]] = {False: [], True: []}
        for share in MAP_SHARES:
            run = runs[case.job_name(share)]
            points[bounces(run)].append((wall_of(run), _radius(run)))
        walls = [wall for found in points.values() for wall, _ in found]
        series = [Series("bound", np.array([min(walls), max(walls)]), np.ones(2), "line")]
        for unstable, name in ((False, "stable"), (True, "unstable")):
            if points[unstable]:
                x, y = np.array(points[unstable]).T
                series.append(Series(name, x, y, "points"))
        panels.append(Panel(_title(case), "stiffness of the wall (N/m)", "spectral radius", series))
    return Curves(
        "Contact behind joint servos: the spectral radius of its map in one period of the controller, and whether the "
        "run bounced. Above 1 the map is unstable.",
        panels,
        2,
        origin(runs[SERVO_CASES[0].job_name(MAP_SHARES[0])]),
    )


def _title(case: ServoCase) -> str:
    return f"{1e3 * case.period:g} ms, servos {1e3 * case.tick:g} ms, {case.spring:g} N m/rad"
