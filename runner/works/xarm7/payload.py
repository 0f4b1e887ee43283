"""What a payload asks of the joints, where effort limits bite, and what then happens to the tip."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from runner.reporting.document import Block, Curves, FloatArray, Notice, Panel, Section, Series, Table, Text
from runner.reporting.figures import joint_columns, model_of, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import number
from runner.reporting.run_values import cell, failures, measured, median, values
from runner.robots import RobotModel
from runner.store import Run
from runner.works.xarm7.plan import ASKED_PAYLOADS, PAYLOADS, XS
from runner.works.xarm7.studies import SHOULDER, clipped_share, error_at_end, first_saturation, lost_at, rate

_PLANE = [1, 3, 5]  # the joints that turn in the arm's vertical plane
_KEPT = dict(zip(XS, PAYLOADS[1:], strict=False))  # kg, with which the tip stays on the line
_LOST = dict(zip(XS, PAYLOADS[2:], strict=False))  # kg, the next that was tried
_GRID = 12  # angles of each, where the search for the widest posture begins


@dataclass(frozen=True)
class Stretch:
    """The arm stretched out level, as far as its joint limits let it.

    Attributes:
        distance: Horizontal distance of the flange from the first axis, in m.
        payloads: Payload with which each joint's static torque is its limit, shape (nq,), in kg; inf for none.
    """

    distance: float
    payloads: FloatArray


def largest_payloads(torque: FloatArray, per_kilogram: FloatArray, limits: FloatArray) -> FloatArray:
    """Return the payload at which each joint reaches its limit first, shape (nq,), in kg; inf where it never does.

    Args:
        torque: Torques without payload, shape (..., nq), in N m.
        per_kilogram: What each kilogram adds, shape (..., nq), in N m/kg.
        limits: Effort limits, shape (nq,), in N m.
    """
    room = limits - np.sign(per_kilogram) * torque
    slope = np.abs(per_kilogram)
    masses = np.divide(room, slope, out=np.full(slope.shape, np.inf), where=slope > 1e-9)
    smallest: FloatArray = masses.reshape(-1, masses.shape[-1]).min(axis=0)
    return smallest


def stretched(model: RobotModel) -> Stretch:
    """Return the arm's widest posture in its vertical plane, and what it carries there."""
    lower, upper = model.position_limits[:, _PLANE]

    def posture(angles: FloatArray) -> FloatArray:
        q = np.zeros(model.nq)
        q[_PLANE] = angles
        return q

    steps = [np.linspace(*span, _GRID) for span in zip(lower, upper, strict=True)]
    grid = np.stack(np.meshgrid(*steps), axis=-1).reshape(-1, len(_PLANE))
    reached = model.tip_positions(np.array([posture(angles) for angles in grid]))[:, 0]
    found = minimize(
        lambda angles: -model.tip_position(posture(angles))[0],
        x0=grid[int(np.argmax(reached))],
        jac=lambda angles: -model.tip_jacobian(posture(angles))[0, _PLANE],
        bounds=list(zip(lower, upper, strict=True)),
        options={"ftol": 1e-15, "gtol": 1e-12},
    )
    q = posture(found.x)
    unloaded = model.gravity_torque(q)
    added = model.with_payload(1.0).gravity_torque(q) - unloaded
    return Stretch(-float(found.fun), largest_payloads(unloaded, added, model.effort_limits))


def payload_section(runs: Mapping[str, Run]) -> Section:
    """Return torques, saturation and tracking over the payload, at both values of X, and the arm stretched out."""
    ours = {name: run for name, run in runs.items() if name.startswith("payload/")}
    first = runs[f"payload/{XS[0]}/asked/{ASKED_PAYLOADS[0]:g}"]
    model = model_of(first)
    rated = float(first.config["robot"]["rated_payload"])
    carried = {x: _carried(runs, x) for x in XS}
    stretch = stretched(model)
    blocks: list[Block] = [
        Text(
            f"A point mass at the flange, up to the maker's rating of {rated:g} kg and beyond, on the line from A to B "
            f"at {rate(first)}. What the motion asks of the joints follows from inverse dynamics; as the motion is the "
            "same for every payload, its torques are linear in the mass. With servos on PyBullet, whose gravity term "
            "knows the payload, the effort limits clip them."
        ),
        Table(
            "Payload with which each joint meets its effort limit: along the line, and at rest stretched out level, "
            f"{stretch.distance:.3f} m from the first axis, in kg.",
            ["joint", "limit (N m)", *(f"line, X = {x:g} m" for x in XS), "stretched out"],
            [
                [
                    f"q{joint + 1}",
                    f"{limit:g}",
                    *(_kilograms(carried[x][joint]) for x in XS),
                    _kilograms(stretch.payloads[joint]),
                ]
                for joint, limit in enumerate(model.effort_limits)
            ],
            (1, 2, 3, 4),
            origin(first),
        ),
        Table(
            "The line with servos on an arm with mass.",
            [
                "X (m)",
                "payload (kg)",
                "largest error (m)",
                "largest torque of q2 (N m)",
                "ticks at a limit",
                "first at its limit",
                "tip lost at (s)",
            ],
            [_row(runs[f"payload/{x}/{mass:g}"], x, mass) for x in XS for mass in PAYLOADS],
            (0, 1, 2, 3, 4, 6),
            origin(runs[f"payload/{XS[0]}/{PAYLOADS[0]:g}"]),
        ),
        _curves(runs, model),
        _concluded(runs, carried, stretch, rated),
        *_warnings(ours),
        *failures(ours),
    ]
    return Section("Payload, and where effort limits bite", blocks)


def _asked(runs: Mapping[str, Run], x: float) -> tuple[FloatArray, FloatArray]:
    """Return the torques asked without payload, and what each kilogram adds, shapes (T, nq)."""
    light, heavy = (joint_columns(runs[f"payload/{x}/asked/{mass:g}"].trace, "tau") for mass in ASKED_PAYLOADS)
    rows = min(len(light), len(heavy))
    return light[:rows], (heavy[:rows] - light[:rows]) / (ASKED_PAYLOADS[1] - ASKED_PAYLOADS[0])


def _carried(runs: Mapping[str, Run], x: float) -> FloatArray:
    model = model_of(runs[f"payload/{x}/asked/{ASKED_PAYLOADS[0]:g}"])
    return largest_payloads(*_asked(runs, x), model.effort_limits)


def _kilograms(mass: float) -> str:
    return number(float(mass)) if np.isfinite(mass) and mass < 100.0 else "above 100"


def _row(run: Run, x: float, mass: float) -> list[str]:
    saturated, lost = first_saturation(run), lost_at(run)
    share = median(run, "saturation_fraction")
    return [
        f"{x:g}",
        f"{mass:g}",
        cell(run, "max_tracking_error"),
        cell(run, "peak_torque_q2"),
        "–" if share is None else f"{100.0 * share:.3g} %",
        "none" if saturated is None else f"q{saturated[0] + 1}, at {saturated[1]:.3g} s",
        "not lost" if lost is None else f"{lost:.3g}",
    ]


def _curves(runs: Mapping[str, Run], model: RobotModel) -> Curves:
    masses = np.linspace(0.0, PAYLOADS[-1], 51)
    panels = []
    for x in XS:
        torque, added = _asked(runs, x)
        shares = np.array([np.abs(torque + m * added).max(axis=0) / model.effort_limits for m in masses])
        series = [Series(f"q{joint + 1}", masses, shares[:, joint]) for joint in range(model.nq)]
        series.append(Series("limit", masses, np.ones(masses.size), "dashed"))
        panels.append(Panel(f"Asked at X = {x:g} m", "payload (kg)", "share of its limit", series))
    errors = [
        Series(
            f"X = {x:g} m",
            np.array(PAYLOADS),
            values((runs[f"payload/{x}/{mass:g}"] for mass in PAYLOADS), "max_tracking_error"),
            "points_line",
        )
        for x in XS
    ]
    panels.append(Panel("Servos, effort limited", "payload (kg)", "largest axis error (m)", errors, y_log=True))
    return Curves(
        "What the line asks of each joint as a share of its effort limit, and the tip error with limited servos.",
        panels,
        3,
        origin(runs[f"payload/{XS[0]}/{PAYLOADS[0]:g}"]),
    )


def _concluded(runs: Mapping[str, Run], carried: Mapping[float, FloatArray], stretch: Stretch, rated: float) -> Finding:
    def error(x: float, mass: float) -> Measured:
        return measured(
            runs[f"payload/{x}/{mass:g}"], "max_tracking_error", f"largest axis error, {x:g} m, {mass:g} kg"
        )

    lost = {x: runs[f"payload/{x}/{_LOST[x]:g}"] for x in XS}
    return conclude(
        rated,
        float(lost[XS[0]].config["robot"]["settling_band"]),
        [_limits(f"along the line at {x:g} m", carried[x]) for x in XS],
        _limits("stretched out", stretch.payloads),
        [error(x, _KEPT[x]) for x in XS],
        [error(x, mass) for x in XS for mass in PAYLOADS if mass >= _LOST[x]],
        [
            clipped_share(run, SHOULDER, f"ticks with the shoulder at its limit, {x:g} m, {_LOST[x]:g} kg")
            for x, run in lost.items()
        ],
        [Measured(f"error at the end, {x:g} m, {_LOST[x]:g} kg", error_at_end(run), "m") for x, run in lost.items()],
    )


def _limits(where: str, payloads: FloatArray) -> tuple[Measured, Measured]:
    """Return with which payload the shoulder meets its limit, and with which the first of the other joints."""
    others = float(np.delete(payloads, SHOULDER).min())
    return (
        Measured(f"payload of the shoulder {where}", float(payloads[SHOULDER]), "kg"),
        Measured(f"least payload of the other joints {where}", others, "kg"),
    )


def conclude(
    rated: float,
    band: float,
    line: Sequence[tuple[Measured, Measured]],
    stretched_out: tuple[Measured, Measured],
    kept: Sequence[Measured],
    lost: Sequence[Measured],
    clipped: Sequence[Measured],
    left: Sequence[Measured],
) -> Finding:
    """Return what the arm carries along the line.

    Args:
        rated: The maker's rating, in kg.
        band: The settling band, in m.
        line: Payload with which the shoulder, and the first of the other joints, meets its limit, at each X.
        stretched_out: The same at rest stretched out level.
        kept: Largest axis error with servos at each X with the payload that is kept.
        lost: The same with those above it.
        clipped: Share of the ticks at which the shoulder is at its limit with the first of these, at each X.
        left: Axis error at the end there.
    """
    return finding(
        f"The shoulder carries the rated {rated:g} kg along the line at X = {XS[1]:g} m, and not at X = {XS[0]:g} m",
        f"The first limit is met by the shoulder (q{SHOULDER + 1}), with {line[0][0]} at X = {XS[0]:g} m and with "
        f"{line[1][0]} at X = {XS[1]:g} m. Of the payloads tried the servos keep the tip on the line up to "
        f"{_KEPT[XS[0]]:g} kg and {_KEPT[XS[1]]:g} kg (errors of {kept[0]} and {kept[1]}). With the next, "
        f"{_LOST[XS[0]]:g} kg and {_LOST[XS[1]]:g} kg, the shoulder's torque is clipped at {clipped[0]} and "
        f"{clipped[1]} of the ticks; the arm gives way and does not recover: in the end the tip is off by {left[0]} "
        f"and {left[1]}. Stretched out level, {stretched_out[0]} are held, by the shoulder. These are numbers of the "
        "inertial set in use.",
        line[0][0] < 0.95 * rated,
        line[1][0] >= rated,
        *(shoulder < 0.95 * others for shoulder, others in (*line, stretched_out)),
        *(error < 0.5 * band for error in kept),
        *(error > 20.0 * band for error in lost),
        *(share > 50.0 for share in clipped),
        *(error > 20.0 * band for error in left),
    )


def _warnings(ours: Mapping[str, Run]) -> list[Block]:
    texts = sorted(
        {str(caveat["text"]) for run in ours.values() for caveat in run.caveats if caveat["rule"] == "overload"}
    )
    return [Notice("warning", "Beyond the rating", f"In these runs {'; '.join(texts)}.")] if texts else []
