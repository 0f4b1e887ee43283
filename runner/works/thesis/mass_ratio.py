"""How heavy a Mini may be before one-way control breaks."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Curves, Panel, Section, Series, Table, Text
from runner.reporting.figures import origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import cell, failures, measured, median, values
from runner.store import Run
from runner.works.thesis.plan import MASSES, NOISY_MASSES, NOMINAL_MASS, PAYLOADS

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
    ours = {name: run for name, run in runs.items() if name.startswith(("mass/", "mass_noise/"))}
    first = runs[f"mass/{MASSES[0]}/{PAYLOADS[0]}"]
    carrier = _macro_mass(first)
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
            "One-way tracking (full equations, coupled, $t_f = 3$ s, thesis torque limits, no noise) with ever "
            "heavier Minis, which the Macro's model either does not know or knows as a point mass at its end: one run "
            "of each. We "
            f"call one-way control broken from that mass on whose largest tip error exceeds {_FACTOR:g} times that "
            "of the thesis' Mini. A run under noise is compared with the thesis' Mini under noise."
        ),
        Curves("Largest axis error over 0 to $t_f$.", panels, 2, origin(first)),
        *(_breaking(runs, payload, carrier) for payload in PAYLOADS),
        _noisy(runs, carrier),
        Table(
            "All masses, without noise.",
            ["payload", "Mini (kg)", "ratio", *_COLUMNS.values()],
            rows,
            tuple(range(1, len(_COLUMNS) + 3)),
            origin(first),
        ),
        *failures(ours),
    ]
    return Section("The mass ratio at which one-way control breaks", blocks)


def breaking_masses(runs: Mapping[str, Run], payload: str) -> tuple[float | None, float | None]:
    """Return the largest mass with which one-way control works without noise and the next, with which not, in kg."""
    nominal = runs[f"mass/{NOMINAL_MASS}/{payload}"]
    threshold = median(nominal, "max_tracking_error")
    works = None
    for mass in MASSES:
        error = median(runs[f"mass/{mass}/{payload}"], "max_tracking_error")
        if error is None or threshold is None or error > _FACTOR * threshold:
            return works, mass
        works = mass
    return works, None


def _breaking(runs: Mapping[str, Run], payload: str, carrier: float) -> Finding:
    """Return between which masses one-way control breaks in single runs without noise."""
    works, broken = breaking_masses(runs, payload)
    nominal = _error(runs, NOMINAL_MASS, payload)
    before, after = _error(runs, works, payload), _error(runs, broken, payload)
    heavier = [_error(runs, mass, payload) for mass in MASSES if broken is not None and mass > broken]
    lost, never_lost = (_percent(runs, mass, payload, "reach_loss_fraction") for mass in (broken, works))
    limited, before_limited = (_percent(runs, mass, payload, "saturation_fraction") for mass in (broken, works))
    common = (
        before < 0.5 * _FACTOR * nominal,
        after > 2.0 * _FACTOR * nominal,
        *(error > _FACTOR * nominal for error in heavier),
        lost > 0.2,
        never_lost <= 0.0,
    )
    known = payload == "known"
    at_limit = (
        f"Some joint stands at its torque limit for {limited} of the ticks, against {before_limited} before."
        if known
        else f"Torque limits are not what changes: some joint stands at its limit for {limited} of the ticks, and for "
        f"{before_limited} before."
    )
    return finding(
        f"Payload {payload}, single runs without noise: breaks between a ratio of {_ratio(works, carrier)} and "
        f"{_ratio(broken, carrier)}",
        f"Without noise the tip error is {before} with {_kilograms(works)} and {after} with {_kilograms(broken)}, "
        f"where the target is out of the Mini's reach for {lost} of the ticks; with the lighter one it never is. "
        f"{at_limit} Every heavier Mini tried is broken, too. The thesis' ratio is {number(NOMINAL_MASS / carrier)}.",
        *common,
        limited > 2.0 * before_limited if known else limited.near(before_limited, 0.2),
    )


def _noisy(runs: Mapping[str, Run], carrier: float) -> Finding:
    """Return what the thesis' noise makes of the masses just below the one that breaks without noise."""
    nominal = measured(runs["figure_5_12/sound"], "max_tracking_error", f"tip error with noise, {NOMINAL_MASS:g} kg")
    light, heavy = NOISY_MASSES
    errors = {
        mass: measured(runs[f"mass_noise/{mass}"], "max_tracking_error", f"tip error with noise, {mass:g} kg")
        for mass in NOISY_MASSES
    }
    highest = {mass: _highest(runs[f"mass_noise/{mass}"], mass) for mass in NOISY_MASSES}
    exact = _error(runs, heavy, "unknown")
    return finding(
        f"Under noise one-way control breaks with a lighter Mini: {heavy:g} kg, a ratio of {_ratio(heavy, carrier)}",
        f"With the thesis' noise over {runs[f'mass_noise/{heavy}'].record['repetitions']} seeds, payload unknown, the "
        f"median tip error is {errors[light]} with {light:g} kg (largest {highest[light]}) and {errors[heavy]} with "
        f"{heavy:g} kg (largest {highest[heavy]}), {errors[heavy] / nominal} times the {nominal} of the thesis' Mini. "
        f"Without noise {heavy:g} kg still works, with {exact}.",
        errors[light] < 0.5 * _FACTOR * nominal,
        highest[light] < 2.0 * _FACTOR * nominal,
        errors[heavy] > 0.5 * _FACTOR * nominal,
        highest[heavy] > 2.0 * _FACTOR * nominal,
        errors[heavy] > 2.0 * errors[light],
        exact < 0.5 * _FACTOR * _error(runs, NOMINAL_MASS, "unknown"),
    )


def _highest(run: Run, mass: float) -> Measured:
    stored = run.metrics.get("max_tracking_error")
    return Measured(f"largest tip error with noise, {mass:g} kg", None if stored is None else stored["max"], "m")


def _error(runs: Mapping[str, Run], mass: float | None, payload: str) -> Measured:
    if mass is None:
        return Measured(f"tip error at the mass that breaks, payload {payload}", None, "m")
    return measured(runs[f"mass/{mass}/{payload}"], "max_tracking_error", f"tip error, {mass:g} kg, payload {payload}")


def _percent(runs: Mapping[str, Run], mass: float | None, payload: str, metric: str) -> Measured:
    share = None if mass is None else median(runs[f"mass/{mass}/{payload}"], metric)
    name = f"{_COLUMNS[metric]}, {_kilograms(mass)}, payload {payload}"
    return Measured(name, None if share is None else 100.0 * share, "%")


def _ratio(mass: float | None, carrier: float) -> str:
    return number(None if mass is None else mass / carrier)


def _kilograms(mass: float | None) -> str:
    return quantity(mass, "kg")


def _macro_mass(run: Run) -> float:
    return float(sum(run.config["robot"]["stages"]["macro"]["masses"].values()))
