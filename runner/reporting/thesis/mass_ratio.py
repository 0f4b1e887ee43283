"""How heavy a Mini may be before one-way control breaks."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Curves, Notice, Panel, Section, Series, Table, Text
from runner.reporting.figures import origin
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import cell, failures, median, values
from runner.reporting.thesis.combined_plan import MASSES, NOMINAL_MASS, PAYLOADS
from runner.store import Run

_FACTOR = 10.0  # of the tip error of the thesis' own Mini
_COLUMNS = {
    "max_tracking_error": "tip error (m)",
    "macro_max_tracking_error": "Macro error (m)",
    "macro_steady_state_error": "Macro at rest (m)",
    "saturation_fraction": "ticks at a torque limit",
    "reach_loss_fraction": "ticks out of reach",
}


def mass_ratio_section(runs: Mapping[str, Run]) -> Section:
    """Return tracking errors and saturation over the mass of the Mini, and where one-way control breaks."""
    ours = {name: run for name, run in runs.items() if name.startswith("mass/")}
    carrier = _macro_mass(runs[f"mass/{MASSES[0]}/{PAYLOADS[0]}"])
    rows = [
        [
            payload,
            f"{mass:g}",
            number(mass / carrier),
            *(cell(runs[f"mass/{mass}/{payload}"], metric) for metric in _COLUMNS),
        ]
        for payload in PAYLOADS
        for mass in MASSES
    ]
    ratios = np.array(MASSES) / carrier
    panels = [
        Panel(
            title,
            "mass of the Mini over that of the Macro",
            "largest axis error (m)",
            [
                Series(
                    f"payload {payload}",
                    ratios,
                    values((runs[f"mass/{mass}/{payload}"] for mass in MASSES), metric),
                    "points_line",
                )
                for payload in PAYLOADS
            ],
            x_log=True,
            y_log=metric == "max_tracking_error",
        )
        for title, metric in (("Tip", "max_tracking_error"), ("Macro's end point", "macro_max_tracking_error"))
    ]
    blocks: list[Block] = [
        Text(
            "One-way tracking (preset sound, coupled, $t_f = 3$ s, thesis torque limits, no noise) with ever "
            "heavier Minis, which the Macro's model either does not know or knows as a point mass at its end. We "
            f"call one-way control broken from that mass on whose largest tip error exceeds {_FACTOR:g} times that "
            "of the thesis' Mini."
        ),
        Curves("Largest axis error over 0 to $t_f$.", panels, 2, origin(next(iter(ours.values())))),
        *(_breaking(runs, payload, carrier) for payload in PAYLOADS),
        Table(
            "All masses.",
            ["payload", "Mini (kg)", "ratio", *_COLUMNS.values()],
            rows,
            tuple(range(1, len(_COLUMNS) + 3)),
            origin(next(iter(ours.values()))),
        ),
        *failures(ours),
    ]
    return Section("The mass ratio at which one-way control breaks", blocks)


def breaking_masses(runs: Mapping[str, Run], payload: str) -> tuple[float | None, float | None]:
    """Return the largest mass with which one-way control works and the next one, with which it is broken, in kg."""
    nominal = runs[f"mass/{NOMINAL_MASS}/{payload}"]
    threshold = median(nominal, "max_tracking_error")
    works = None
    for mass in MASSES:
        error = median(runs[f"mass/{mass}/{payload}"], "max_tracking_error")
        if error is None or threshold is None or error > _FACTOR * threshold:
            return works, mass
        works = mass
    return works, None


def _breaking(runs: Mapping[str, Run], payload: str, carrier: float) -> Notice:
    works, broken = breaking_masses(runs, payload)
    if broken is None:
        return Notice("finding", f"Payload {payload}: not broken", f"One-way control works up to {works:g} kg.")
    if works is None:
        return Notice("finding", f"Payload {payload}: broken throughout", "One-way control works with no mass tried.")
    run = runs[f"mass/{broken}/{payload}"]
    lost, limited = median(run, "reach_loss_fraction"), median(run, "saturation_fraction")
    before = median(runs[f"mass/{works}/{payload}"], "saturation_fraction")
    if lost:
        reason = f"The target is out of the Mini's reach for {number(100 * lost, 2)} % of the ticks"
    else:
        reason = "The Mini still reaches its target at every tick"
    if limited is not None and before is not None:
        reason += (
            f"; some joint stands at its limit for {number(100 * limited)} % of them ({number(100 * before)} % with "
            "the last mass that works)"
        )
    return Notice(
        "finding",
        f"Payload {payload}: breaks between a ratio of {number(works / carrier)} and {number(broken / carrier)}",
        f"With {works:g} kg the tip error is "
        f"{quantity(median(runs[f'mass/{works}/{payload}'], 'max_tracking_error'), 'm')}, with {broken:g} kg "
        f"{quantity(median(run, 'max_tracking_error'), 'm')}. {reason}. The thesis' ratio is "
        f"{number(NOMINAL_MASS / carrier)}.",
    )


def _macro_mass(run: Run) -> float:
    return float(sum(run.config["robot"]["stages"]["macro"]["masses"].values()))
