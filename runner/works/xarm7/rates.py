"""Tracking error against the rate of the commands."""

from collections.abc import Mapping, Sequence

import numpy as np

from runner.reporting.document import Block, Curves, Formula, Panel, Section, Series, Table, Text
from runner.reporting.figures import origin
from runner.reporting.findings import Finding, finding
from runner.reporting.job import PRESETS
from runner.reporting.measured import Measured
from runner.reporting.quantities import number
from runner.reporting.run_values import cell, failures, measured, values
from runner.reporting.words import PRESET, in_words
from runner.store import Run
from runner.works.xarm7.plan import PLANTS, RATES
from runner.works.xarm7.studies import largest_error_at

_MAKERS = (100, 250)  # Hz, recommended and allowed
_TITLES = {"as_reported": "Without feedforward", "sound": "With feedforward"}


def lag(run: Run, rate: float) -> float:
    """Return the largest lag of the line without feedforward, by the closed form, in m.

    A goal that moves at speed v runs ahead until K times the lag makes up for it; the midpoint rule meets the goal of
    the tick with the tip of half a period later: lag = v / (K (1 - h K / 2)).
    """
    controller, trajectory = run.config["controller"], run.config["trajectory"]
    length = float(np.linalg.norm(np.subtract(trajectory["goal"], trajectory["start"])))
    speed = np.pi * length / float(trajectory["duration"])
    gain = float(controller["gain"])
    return float(speed / (gain * (1.0 - 0.5 * gain / rate)))


def rates_section(runs: Mapping[str, Run]) -> Section:
    """Return tracking errors over the command rate, with and without feedforward, on both plants."""
    ours = {name: run for name, run in runs.items() if name.startswith("rates/")}
    first = runs[f"rates/kinematic/as_reported/{RATES[0]}"]
    rows = [
        [
            "yes" if preset == "sound" else "no",
            in_words(plant),
            f"{rate}",
            cell(run, "max_tracking_error"),
            number(lag(run, rate)) if preset == "as_reported" else "–",
            cell(run, "rms_tracking_error"),
            cell(run, "cross_track_error"),
        ]
        for preset in PRESETS
        for plant in PLANTS
        for rate in RATES
        for run in [runs[f"rates/{plant}/{preset}/{rate}"]]
    ]
    servo = runs[f"rates/bullet/sound/{RATES[0]}"]
    blocks: list[Block] = [
        Text(
            f"The maker recommends {_MAKERS[0]} commands a second and allows {_MAKERS[1]}. The line from A to B with "
            f"$K = {first.config['controller']['gain']:g}$ 1/s, on joints that go where they are told (kinematic) and "
            f"with servos of {servo.config['plant']['servo']['stiffness']:g} N m/rad on an arm with mass (PyBullet, "
            f"step {1e3 * servo.provenance['plant_step']:g} ms), whose set-points move evenly between commands. "
            "Without feedforward the tip lags by the speed $v$ over $K$; integrated by the midpoint rule over $h$, "
            "the time between commands, the largest lag on a line of length $D$ with period $T$ is"
        ),
        Formula(
            "max |x_d - x| = v / (K (1 - h K slash 2)), quad v = pi D slash T",
            "the largest lag equals v over K times one minus h K over two, with v equal to pi D over T",
        ),
        Table(
            "Errors by command rate, from A to B.",
            [
                "feedforward",
                "plant",
                "rate (Hz)",
                "largest error (m)",
                "closed form (m)",
                "rms error (m)",
                "off the line (m)",
            ],
            rows,
            (2, 3, 4, 5, 6),
            origin(first),
        ),
        _curves(runs),
        _concluded(runs),
        *failures(ours),
    ]
    return Section("Tracking error against command rate", blocks)


def _curves(runs: Mapping[str, Run]) -> Curves:
    rates = np.array(RATES, dtype=float)
    panels = []
    for preset in PRESETS:
        series = [
            Series(
                in_words(plant),
                rates,
                values((runs[f"rates/{plant}/{preset}/{rate}"] for rate in RATES), "max_tracking_error"),
                "points_line" if plant == "bullet" or preset == "sound" else "points",
            )
            for plant in PLANTS
        ]
        if preset == "as_reported":
            fine = np.geomspace(rates[0], rates[-1], 100)
            run = runs[f"rates/kinematic/as_reported/{RATES[0]}"]
            series.append(Series("closed form", fine, np.array([lag(run, rate) for rate in fine]), "dashed"))
        shown = np.concatenate([line.y for line in series])
        ends = np.array([0.5 * np.nanmin(shown, initial=1.0), 1.5 * np.nanmax(shown, initial=1e-6)])
        series += [
            Series(f"{rate} Hz", np.array([rate, rate], dtype=float), ends, "dotted", color=3 + index)
            for index, rate in enumerate(_MAKERS)
        ]
        y_log = preset == "sound"
        panels.append(
            Panel(_TITLES[preset], "command rate (Hz)", "largest axis error (m)", series, x_log=True, y_log=y_log)
        )
    return Curves(
        "Largest axis error against command rate; dotted the rates that the maker recommends and allows.",
        panels,
        2,
        origin(runs[f"rates/kinematic/as_reported/{RATES[0]}"]),
    )


def _concluded(runs: Mapping[str, Run]) -> Finding:
    def error(plant: str, preset: str, rate: int) -> Measured:
        run = runs[f"rates/{plant}/{preset}/{rate}"]
        return measured(run, "max_tracking_error", f"largest axis error, {plant}, {PRESET[preset]}, {rate} Hz")

    first = runs[f"rates/kinematic/as_reported/{RATES[0]}"]
    servo = runs[f"rates/bullet/sound/{_MAKERS[-1]}"]
    return conclude(
        [
            (error(plant, "as_reported", rate), Measured(f"closed form, {rate} Hz", lag(first, rate), "m"))
            for plant in PLANTS
            for rate in RATES
        ],
        [error("kinematic", "sound", rate) for rate in RATES],
        [error("kinematic", "sound", rate) for rate in _MAKERS],
        [error("bullet", "sound", rate) for rate in _MAKERS],
        Measured("time of the servos' largest error", largest_error_at(servo), "s"),
        [
            measured(runs[f"rates/kinematic/{preset}/{_MAKERS[0]}"], "cross_track_error", f"off the line, {preset}")
            for preset in PRESETS
        ],
        error("kinematic", "as_reported", _MAKERS[0]),
    )


def conclude(
    late: Sequence[tuple[Measured, Measured]],
    ahead: Sequence[Measured],
    makers: Sequence[Measured],
    servo: Sequence[Measured],
    jerked: Measured,
    off: Sequence[Measured],
    lagging: Measured,
) -> Finding:
    """Return what the rate of commands is good for.

    Args:
        late: Largest axis error without feedforward and its closed form, by plant and rate.
        ahead: Largest axis error with feedforward on the kinematic plant, by rate.
        makers: The same at the maker's two rates.
        servo: The same at these with servos at joints with mass.
        jerked: When the servos' error is largest, at the larger of the maker's rates.
        off: Distance from the line without feedforward and with it, kinematic plant, at the lower of the maker's rates.
        lagging: Largest axis error without feedforward there.
    """
    order = Measured("power of the rate", _power(ahead[0].value, ahead[-1].value), "1", (ahead[0], ahead[-1]))
    return finding(
        "Without feedforward the tip lags by the closed form; with it the rate sets the error, until the servo does",
        "The lag is the closed form at every rate, on both plants. With feedforward on the kinematic plant the error "
        f"falls with the power {order} of the rate: {makers[0]} at {_MAKERS[0]} Hz, {makers[1]} at {_MAKERS[1]} Hz. "
        f"Servos at joints with mass leave {servo[0]} and {servo[1]}: they are jerked at A, where the line's "
        f"acceleration sets in at once (the error is largest at {jerked}), and more commands do not help. At "
        f"{_MAKERS[0]} Hz the tip stays within {off[0]} of the line without feedforward, and {off[1]} with it: the lag "
        "is along the line.",
        *(error.near(closed_form, 0.02) for error, closed_form in late),
        order > 1.8,
        order < 2.6,
        *(larger > 10.0 * smaller for larger, smaller in zip(servo, makers, strict=True)),
        servo[1].near(servo[0], 0.15),
        jerked < 0.25,
        *(each < 0.01 * lagging for each in off),
    )


def _power(slow: float | None, fast: float | None) -> float | None:
    """Return by which power of the rate an error falls from the lowest to the largest."""
    return float(np.log(slow / fast) / np.log(RATES[-1] / RATES[0])) if slow and fast else None
