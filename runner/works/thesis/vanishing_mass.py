"""What remains of the coupling as the Mini's mass vanishes: its base's inertial force at the Mini."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
import pinocchio as pin

from runner.reporting.document import Block, Curves, FloatArray, Panel, Section, Series, Table, Text
from runner.reporting.figures import joint_columns, model_of, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import number
from runner.reporting.run_values import clock, failures
from runner.store import Run
from runner.works.thesis.plan import VANISHING
from runner.works.thesis.studies import largest

_MINI = slice(3, 6)


def vanishing_section(runs: Mapping[str, Run]) -> Section:
    """Return the difference between the coupled and the decoupled arm for three masses of the Mini."""
    ours = {name: run for name, run in runs.items() if name.startswith("vanishing/")}
    rows, macros, minis, torques = [], [], [], []
    for mass in VANISHING:
        coupled, decoupled = (runs[f"vanishing/{mass}/{dynamics}"] for dynamics in ("coupled", "decoupled"))
        difference = np.abs(_difference(coupled, decoupled, "q"))
        macro, mini = largest(difference[:, :3]), largest(difference[:, _MINI])
        torque = largest(np.abs(_difference(coupled, decoupled, "tau")[:, _MINI]) / mass)
        per_mass = None if macro is None else macro / mass
        macros.append(Measured(f"Macro joints per mass, {mass:g} kg", per_mass, "rad/kg"))
        minis.append(Measured(f"Mini joints, {mass:g} kg", mini, "rad"))
        torques.append(Measured(f"Mini torque per mass, {mass:g} kg", torque, "N m/kg"))
        rows.append([f"{mass:g}", number(macro), number(per_mass), number(mini), number(torque)])
    coupled, decoupled = (runs[f"vanishing/{VANISHING[-1]}/{dynamics}"] for dynamics in ("coupled", "decoupled"))
    blocks: list[Block] = [
        Text("One-way tracking without noise, Runge-Kutta plant, the Mini's two point masses made ever lighter."),
        Table(
            "Largest difference of joint positions and Mini torques between the coupled and the decoupled arm.",
            [
                "each mass (kg)",
                "Macro joints (rad)",
                "per mass (rad/kg)",
                "Mini joints (rad)",
                "Mini torque per mass (N m/kg)",
            ],
            rows,
            (0, 1, 2, 3, 4),
            origin(coupled),
        ),
        _limits(macros, minis, torques),
        *_inertial_force(coupled, decoupled, VANISHING[-1]),
        *failures(ours),
    ]
    return Section("A Mini of vanishing mass", blocks)


def _limits(macros: Sequence[Measured], minis: Sequence[Measured], torques: Sequence[Measured]) -> Finding:
    light, lightest = minis[-2:]
    tenfold = VANISHING[-2] / VANISHING[-1]
    return finding(
        "With the Mini's mass the error of decoupling vanishes at the Macro, not at the Mini",
        f"The difference of the Macro's joints falls in proportion to the mass: {_listed(macros)}. That of the Mini's "
        f"joints falls from {light} to {lightest} only where the mass falls {number(tenfold)} times, and its torque "
        f"per mass not at all: {_listed(torques)}. Its base is accelerated, however light it is.",
        *(each.near(macros[0], 0.05) for each in macros[1:]),
        light < 0.6 * tenfold * lightest,
        *(each.near(torques[0], 0.1) for each in torques[1:]),
    )


def _listed(values: Iterable[Measured]) -> str:
    return ", ".join(str(value) for value in values)


def _inertial_force(coupled: Run, decoupled: Run, mass: float) -> list[Block]:
    """Return the difference of the Mini's torques beside the inertial torque of its base's motion."""
    measured = _difference(coupled, decoupled, "tau")[:, _MINI] / mass
    predicted = _inertial_torque(coupled)[:, _MINI] / mass
    rows, ticks = min(len(measured), len(predicted)), _ticks_per_period(coupled)
    if rows < 2 * ticks:
        return [_explained(None, None)]
    measured, predicted = (_averaged(torque[:rows], ticks) for torque in (measured, predicted))
    t = clock(coupled)[ticks // 2 :][: len(measured)]
    joint = int(np.nanargmax(np.nan_to_num(np.abs(measured)).max(axis=0)))
    return [
        Curves(
            f"Torque of joint {joint + 4} of a Mini of {2 * mass:g} kg, coupled less decoupled, and the torque that "
            "its base's acceleration and rotation ask for, computed from the motion alone; both averaged over a "
            "Macro period, as the Mini's loop needs some milliseconds to follow each jump of the Macro's torque.",
            (
                Panel(
                    "",
                    "time (s)",
                    "torque per mass (N m/kg)",
                    (
                        Series("simulated", t, measured[:, joint]),
                        Series("inertial force of the base's motion", t, predicted[:, joint], "dashed"),
                    ),
                ),
            ),
            1,
            origin(coupled),
        ),
        _explained(largest(np.abs(measured - predicted)), largest(np.abs(measured))),
    ]


def _explained(residual: float | None, total: float | None) -> Finding:
    left = Measured("torque that the base's inertial force does not explain", residual, "N m/kg")
    whole = Measured("difference of the Mini's torques per mass", total, "N m/kg")
    return finding(
        "What remains at the Mini is its base's inertial force",
        f"The simulated difference and the torque that the base's motion asks for are at most {left} apart, of "
        f"{whole}.",
        left < 0.15 * whole,
        whole > 0.1,
    )


def _ticks_per_period(run: Run) -> int:
    period = run.config["controller"]["period"]
    return max(1, round(float(period["macro"]) / float(period["mini"])))


def _averaged(torque: FloatArray, ticks: int) -> FloatArray:
    """Return the running mean of each column over so many rows."""
    weights = np.full(ticks, 1.0 / ticks)
    return np.array([np.convolve(column, weights, "valid") for column in torque.T]).T


def _difference(first: Run, second: Run, signal: str) -> FloatArray:
    rows = min(len(first.trace), len(second.trace))
    difference: FloatArray = joint_columns(first.trace[:rows], signal) - joint_columns(second.trace[:rows], signal)
    return difference


def _inertial_torque(run: Run) -> FloatArray:
    """Return the torque that a run's motion asks for beyond what it would on a base that only turns gravity.

    It is the inverse dynamics of the whole arm less that of the Mini on a resting base at the same wrist, where the
    Macro's joints neither move nor accelerate; shape (T, nq), in N m.
    """
    model = model_of(run).pin_model
    data = model.createData()
    q, dq = joint_columns(run.trace, "q"), joint_columns(run.trace, "dq")
    tick = float(np.diff(clock(run)).min()) if len(q) > 1 else 1.0
    ddq = np.diff(dq, axis=0) / tick  # torques are held, so this is the mean over the tick
    result = np.zeros_like(ddq)
    resting = np.concatenate([np.zeros(3), np.ones(3)])
    middle, speed = 0.5 * (q[1:] + q[:-1]), 0.5 * (dq[1:] + dq[:-1])
    for row, position, velocity, acceleration in zip(result, middle, speed, ddq, strict=True):
        whole = pin.rnea(model, data, position, velocity, acceleration).copy()
        row[:] = whole - pin.rnea(model, data, position, velocity * resting, acceleration * resting)
    return result
