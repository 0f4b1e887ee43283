"""Tracking error against the rate of the commands."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Curves, Formula, Notice, Panel, Section, Series, Table, Text
from runner.reporting.figures import origin
from runner.reporting.job import PRESETS
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import cell, failures, median, values
from runner.reporting.xarm7.studies_plan import PLANTS, RATES
from runner.store import Run

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
            plant,
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
            f"with servos of {servo.config['plant']['servo']['stiffness']:g} N m/rad on an arm with mass (bullet, step "
            f"{1e3 * servo.provenance['plant_step']:g} ms), whose set-points move evenly between commands. Without "
            "feedforward the tip lags by the speed $v$ over $K$; integrated by the midpoint rule over $h$, the time "
            "between commands, the largest lag on a line of length $D$ with period $T$ is"
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
        _finding(runs),
        *failures(ours),
    ]
    return Section("Tracking error against command rate", blocks)


def _curves(runs: Mapping[str, Run]) -> Curves:
    rates = np.array(RATES, dtype=float)
    panels = []
    for preset in PRESETS:
        series = [
            Series(
                plant,
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


def _finding(runs: Mapping[str, Run]) -> Notice:
    def error(plant: str, preset: str, rate: int) -> float | None:
        return median(runs[f"rates/{plant}/{preset}/{rate}"], "max_tracking_error")

    slow, fast = (error("kinematic", "sound", rate) for rate in (RATES[0], RATES[-1]))
    order = number(float(np.log(slow / fast) / np.log(RATES[-1] / RATES[0])), 2) if slow and fast else "–"
    at = [f"{quantity(error('kinematic', 'sound', rate), 'm')} at {rate} Hz" for rate in _MAKERS]
    servo = [quantity(error("bullet", "sound", rate), "m") for rate in _MAKERS]
    off = [quantity(median(runs[f"rates/kinematic/{p}/{_MAKERS[0]}"], "cross_track_error"), "m") for p in PRESETS]
    return Notice(
        "finding",
        "Without feedforward the gain sets the error, with it the rate does, until the servo does",
        f"With feedforward on the kinematic plant the error falls with the power {order} of the rate: {', '.join(at)}. "
        f"Servos at joints with mass leave {' and '.join(servo)}: they are jerked at A, where the line's acceleration "
        f"sets in at once, and more commands do not help. At {_MAKERS[0]} Hz the tip "
        f"stays within {off[0]} of the line without feedforward, and {off[1]} with it: the lag is along the line.",
    )
