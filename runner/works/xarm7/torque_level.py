"""The line by joint torques: the thesis' laws on the xArm7, and the payload up to which they hold it."""

from collections.abc import Mapping, Sequence

import numpy as np

from runner.reporting.document import Block, Curves, FloatArray, Panel, Section, Series, Table, Text
from runner.reporting.figures import joint_columns, model_of, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import quantity
from runner.reporting.run_values import cell, clock, failures, measured, median, values
from runner.reporting.words import in_words
from runner.store import Run
from runner.works.xarm7.plan import LAWS, TORQUE_PAYLOADS
from runner.works.xarm7.studies import (
    SHOULDER,
    clipped,
    clipped_share,
    error_norm,
    first_saturation,
    smallest_margin,
)

BOUND = 1e-4  # m, of the largest axis error
_LAST = 2  # the last of the payloads with which both laws hold the line


def torque_level_section(runs: Mapping[str, Run]) -> Section:
    """Return tracking and torques of operational-space and computed-torque control over the payload."""
    ours = {name: run for name, run in runs.items() if name.startswith("torque/")}
    first = runs[f"torque/{LAWS[0]}/0"]
    controller = first.config["controller"]
    rows = [
        [in_words(law), case if case == "pose" else f"{float(case):g}", *_cells(runs[f"torque/{law}/{case}"])]
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
        _concluded(runs),
        *failures(ours),
    ]
    return Section("The line by joint torques", blocks)


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
            in_words(law),
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
        panels.append(
            Panel(in_words(law).capitalize(), "time (s)", "error norm (m)", series, y_log=True, y_range=(1e-8, 3.0))
        )
    return Curves(
        "Tip error of both laws by payload, and over time near the limit.",
        panels,
        3,
        origin(runs[f"torque/{LAWS[0]}/0"]),
    )


def _concluded(runs: Mapping[str, Run]) -> Finding:
    def errors(masses: Sequence[float]) -> list[list[Measured]]:
        return [
            [
                measured(
                    runs[f"torque/{law}/{mass:g}"],
                    "max_tracking_error",
                    f"largest axis error, {law}, {mass:g} kg",
                )
                for mass in masses
            ]
            for law in LAWS
        ]

    last = [runs[f"torque/{law}/{TORQUE_PAYLOADS[_LAST]:g}"] for law in LAWS]
    return conclude(
        errors(TORQUE_PAYLOADS[: _LAST + 1]),
        errors(TORQUE_PAYLOADS[_LAST + 1 :]),
        [measured(runs[f"torque/{law}/0"], "peak_torque_q2", f"largest torque of the shoulder, {law}") for law in LAWS],
        [
            Measured(f"clipped ticks, {law}, {TORQUE_PAYLOADS[_LAST]:g} kg", float(clipped(run, SHOULDER).size))
            for law, run in zip(LAWS, last, strict=True)
        ],
        [
            Measured(f"last clipped tick, {law}, {TORQUE_PAYLOADS[_LAST]:g} kg", _last(clipped(run, SHOULDER)), "s")
            for law, run in zip(LAWS, last, strict=True)
        ],
        [
            clipped_share(
                runs[f"torque/{law}/{TORQUE_PAYLOADS[_LAST + 1]:g}"],
                SHOULDER,
                f"ticks with the shoulder at its limit, {in_words(law)}, {TORQUE_PAYLOADS[_LAST + 1]:g} kg",
            )
            for law in LAWS
        ],
    )


def _last(times: FloatArray) -> float | None:
    return float(times[-1]) if times.size else None


def conclude(
    held: Sequence[Sequence[Measured]],
    lost: Sequence[Sequence[Measured]],
    torques: Sequence[Measured],
    ticks: Sequence[Measured],
    until: Sequence[Measured],
    shares: Sequence[Measured],
) -> Finding:
    """Return up to which payload the laws hold the line.

    Args:
        held: Largest axis error by law and payload, up to the last that is held.
        lost: The same with the payloads beyond.
        torques: Largest torque of the shoulder without load, by law.
        ticks: Ticks at which a torque is clipped with the last payload that is held, by law.
        until: The last of these.
        shares: Share of the ticks at which the shoulder is at its limit with the first payload beyond, by law.
    """
    last, beyond = TORQUE_PAYLOADS[_LAST], TORQUE_PAYLOADS[_LAST + 1]
    laws = "; ".join(
        f"{in_words(law)}: {errors[0]} without load, with up to {torque} at the shoulder"
        for law, errors, torque in zip(LAWS, held, torques, strict=True)
    )
    return finding(
        f"Both laws track within {quantity(BOUND, 'm')} up to {last:g} kg, and lose the line with {beyond:g} kg",
        f"{laws[0].upper()}{laws[1:]}. With {last:g} kg the shoulder's torque is clipped as the motion sets in at A, "
        f"in {ticks[0]} ticks by the one law and {ticks[1]} by the other, and the tip hardly shows it: {held[0][-1]} "
        f"and {held[1][-1]}. With {beyond:g} kg it is clipped at {shares[0]} and {shares[1]} of the ticks, and the "
        f"tip is off by {lost[0][0]} and {lost[1][0]}.",
        *(error < 0.5 * BOUND for errors in held for error in errors),
        *(error > 50.0 * BOUND for errors in lost for error in errors),
        *(count < 10.0 for count in ticks),
        *(time < 0.1 for time in until),
        *(share > 5.0 for share in shares),
    )
