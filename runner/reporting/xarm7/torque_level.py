"""The line by joint torques: the thesis' laws on the xArm7, and the payload up to which they hold it."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Curves, Notice, Panel, Section, Series, Table, Text
from runner.reporting.figures import joint_columns, model_of, origin
from runner.reporting.quantities import quantity
from runner.reporting.run_values import cell, clock, failures, median, values
from runner.reporting.xarm7.studies import error_norm, first_saturation, smallest_margin
from runner.reporting.xarm7.studies_plan import LAWS, TORQUE_PAYLOADS
from runner.store import Run

BOUND = 1e-4  # m, of the largest axis error


def torque_level_section(runs: Mapping[str, Run]) -> Section:
    """Return tracking and torques of operational-space and computed-torque control over the payload."""
    ours = {name: run for name, run in runs.items() if name.startswith("torque/")}
    first = runs[f"torque/{LAWS[0]}/0"]
    controller = first.config["controller"]
    rows = [
        [law, case if case == "pose" else f"{float(case):g}", *_cells(runs[f"torque/{law}/{case}"])]
        for law in LAWS
        for case in (*(f"{mass:g}" for mass in TORQUE_PAYLOADS), "pose")
    ]
    blocks: list[Block] = [
        Text(
            "The real arm takes joint positions only; in simulation it also takes torques. The line over one period, "
            f"commanded at {1.0 / controller['period']:g} Hz by operational-space control and by computed torque, "
            f"$omega_n = {controller['natural_frequency']:g}$ rad/s, $xi = {controller['damping_ratio']:g}$, home's "
            f"posture in the null space, on PyBullet (step {1e3 * first.provenance['plant_step']:g} ms) with the "
            "effort limits of all seven joints. The laws' model knows the payload. Position task, but for the rows "
            "named pose, which hold the orientation, too, without payload."
        ),
        Table(
            "The line by joint torques.",
            [
                "law",
                "payload (kg)",
                "largest error (m)",
                "off the line (m)",
                "nearest to its limit",
                "ticks at a limit",
                "first at its limit",
                "joint margin (rad)",
            ],
            rows,
            (1, 2, 3, 5, 7),
            origin(first),
        ),
        _curves(runs),
        _finding(runs),
        *failures(ours),
    ]
    return Section("The line by joint torques", blocks)


def holds(run: Run) -> bool:
    """Tell whether the tip's largest axis error stays within the bound."""
    error = median(run, "max_tracking_error")
    return error is not None and error <= BOUND


def _cells(run: Run) -> list[str]:
    torques = np.abs(joint_columns(run.trace, "tau"))[:-1].max(axis=0, initial=0.0)
    shares = torques / model_of(run).effort_limits
    saturated = first_saturation(run)
    joint = int(np.argmax(shares)) if saturated is None else saturated[0]
    share = median(run, "saturation_fraction")
    return [
        cell(run, "max_tracking_error"),
        cell(run, "cross_track_error"),
        f"q{joint + 1}, {100.0 * shares[joint]:.3g} %",
        "–" if share is None else f"{100.0 * share:.3g} %",
        "none" if saturated is None else f"q{saturated[0] + 1}, at {saturated[1]:.3g} s",
        smallest_margin(run),
    ]


def _curves(runs: Mapping[str, Run]) -> Curves:
    over_payload = [
        Series(
            law,
            np.array(TORQUE_PAYLOADS),
            values((runs[f"torque/{law}/{mass:g}"] for mass in TORQUE_PAYLOADS), "max_tracking_error"),
            "points_line",
        )
        for law in LAWS
    ]
    over_payload.append(
        Series("bound", np.array([TORQUE_PAYLOADS[0], TORQUE_PAYLOADS[-1]]), np.array([BOUND, BOUND]), "dashed")
    )
    panels = [Panel("Over the payload", "payload (kg)", "largest axis error (m)", over_payload, y_log=True)]
    for law in LAWS:
        series = []
        for mass in TORQUE_PAYLOADS[:4]:
            run = runs[f"torque/{law}/{mass:g}"]
            series.append(Series(f"{mass:g} kg", clock(run), error_norm(run)))
        panels.append(Panel(law, "time (s)", "error norm (m)", series, y_log=True, y_range=(1e-8, 3.0)))
    return Curves(
        "Tip error of both laws by payload, and over time near the limit.",
        panels,
        3,
        origin(runs[f"torque/{LAWS[0]}/0"]),
    )


def _finding(runs: Mapping[str, Run]) -> Notice:
    parts, lasting = [], []
    for law in LAWS:
        kept = [mass for mass in TORQUE_PAYLOADS if holds(runs[f"torque/{law}/{mass:g}"])]
        lost = [mass for mass in TORQUE_PAYLOADS if mass not in kept]
        lasting.append(max(kept, default=None))
        unloaded = runs[f"torque/{law}/0"]
        parts.append(
            f"{law}: {quantity(median(unloaded, 'max_tracking_error'), 'm')} without load, largest torque of q2 "
            f"{quantity(median(unloaded, 'peak_torque_q2'), 'N m')}; within the bound up to "
            f"{quantity(max(kept, default=None), 'kg')}, beyond it from {quantity(min(lost, default=None), 'kg')} on"
        )
    least = min((mass for mass in lasting if mass is not None), default=None)
    return Notice(
        "finding",
        f"Both laws track within {quantity(BOUND, 'm')} up to {quantity(least, 'kg')}"
        if None not in lasting
        else f"Not both laws track within {quantity(BOUND, 'm')}",
        f"{'. '.join(parts)}. Just above what the shoulder can hold its torque is clipped for a few ticks at the ends "
        "of the line, where the flange is farthest out and brakes, and the tip hardly shows it; a little more and "
        "the arm sinks faster than the clipped torque can stop it.",
    )
