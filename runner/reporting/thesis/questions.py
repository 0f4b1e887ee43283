"""Short answers to the thesis' research questions, section 1.3, items 3 to 6."""

from collections.abc import Mapping

from runner.reporting.document import Block, Notice, Section, Table, Text
from runner.reporting.figures import origin
from runner.reporting.job import PRESETS
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import cell, median
from runner.reporting.thesis.combined_plan import NOMINAL_MASS
from runner.reporting.thesis.mass_ratio import breaking_masses
from runner.reporting.thesis.mini_accuracy import mini_accuracy
from runner.reporting.thesis.studies import ratio
from runner.reporting.thesis.whole_body import fastest_method_3, fastest_speed
from runner.store import Run


def questions_section(runs: Mapping[str, Run]) -> Section:
    """Return the answers, every number from the runs."""
    return Section(
        "The thesis' research questions",
        (
            Text(
                "Section 1.3 of the thesis sets itself six tasks. The first two are those of chapters 3 and 4; here "
                "are answers to the others. Medians over the repetitions, thesis noise and limits, preset sound "
                "unless said."
            ),
            _strategy(runs),
            _independent(runs),
            *_effectiveness(runs),
            _together(runs),
            mini_accuracy(runs),
        ),
    )


def _strategy(runs: Mapping[str, Run]) -> Notice:
    tracked = {name: median(runs[f"{figure}/sound"], "max_tracking_error") for name, figure in _TRACKING.items()}
    alone = median(runs["macro_alone/sound"], "macro_max_tracking_error")
    known = {name: error for name, error in tracked.items() if error is not None}
    best = min(known, key=lambda name: known[name]) if known else None
    works, broken = breaking_masses(runs, "unknown")
    good = best is not None and alone is not None and known[best] < alone
    listed = ", ".join(f"{name} {quantity(error, 'm')}" for name, error in tracked.items())
    conditions = (
        "Each arm needs its own dynamics alone, as long as the Macro's target leaves the Mini room ($x_d - r_0$) "
        "and the Mini knows its target's velocity, and gravity in its turning base. "
        if good
        else ""
    )
    return Notice(
        "finding",
        f"3. An overall strategy from the dynamics of two separate arms? {f'Yes: {best}' if good else 'No'}",
        f"Largest tracking error of the tip: {listed}; the Macro alone {quantity(alone, 'm')}. {conditions}"
        + (
            f"One-way control works up to a Mini of {works:g} kg"
            if works is not None
            else "One-way control works with no Mini"
        )
        + (f" and breaks with {broken:g} kg" if broken is not None else "")
        + f"; the thesis' weighs {NOMINAL_MASS:g} kg.",
    )


_TRACKING = {"one-way": "figure_5_12", "two-way": "figure_5_13", "independent": "figure_5_3"}


def _independent(runs: Mapping[str, Run]) -> Notice:
    pairs = {
        p: [median(runs[f"{f}/{p}"], "max_tracking_error") for f in ("figure_5_3", "figure_5_12")] for p in PRESETS
    }
    independent, coupled = pairs["sound"]
    better = independent is not None and coupled is not None and coupled < independent
    macro = median(runs["figure_5_3/sound"], "macro_max_tracking_error")
    verdict = (
        f"Coupled, by a factor of {ratio(independent, coupled)} in the largest tracking error "
        f"({ratio(*pairs['as_reported'])} with as_reported). "
        if better
        else f"Independent: coupling makes the largest tracking error {ratio(coupled, independent)} times larger. "
    )
    return Notice(
        "finding",
        "4. Independent or coupled controllers?",
        verdict + f"Independent, the tip misses by {quantity(independent, 'm')} where the Macro's end point misses by "
        f"{quantity(macro, 'm')}: it bears all the Macro's errors, and its offset turns with the wrist.",
    )


def _effectiveness(runs: Mapping[str, Run]) -> list[Block]:
    rows = []
    for preset in PRESETS:
        for name, goal, track in (
            ("Macro alone (its end point)", "macro_alone_goal", "macro_alone"),
            ("one-way", "figure_5_8", "figure_5_12"),
            ("two-way", "figure_5_10", "figure_5_13"),
        ):
            prefix = "macro_" if goal == "macro_alone_goal" else ""
            rows.append(
                [
                    preset,
                    name,
                    cell(runs[f"{goal}/{preset}"], f"{prefix}settling_time"),
                    cell(runs[f"{goal}/{preset}"], f"{prefix}steady_state_error"),
                    cell(runs[f"{track}/{preset}"], f"{prefix}max_tracking_error"),
                    cell(runs[f"{track}/{preset}"], f"{prefix}steady_state_error"),
                ]
            )
    return [
        Notice("finding", "5. How effective is the overall controller in simulation?", _summary(runs)),
        Table(
            "Medians over the repetitions.",
            [
                "preset",
                "controller",
                "goal: settles (s)",
                "steady error (m)",
                "tracking: largest error (m)",
                "steady error (m)",
            ],
            rows,
            (2, 3, 4, 5),
            origin(runs["figure_5_12/sound"]),
        ),
    ]


def _summary(runs: Mapping[str, Run]) -> str:
    sentences = []
    for preset in PRESETS:
        alone = median(runs[f"macro_alone/{preset}"], "macro_max_tracking_error")
        pairs = [
            (name, median(runs[f"{_TRACKING[name]}/{preset}"], "max_tracking_error")) for name in ("one-way", "two-way")
        ]
        found = ", ".join(
            f"{ratio(alone, tip)} times better with {name} coupling"
            if tip is not None and alone is not None and tip < alone
            else f"not better with {name} coupling"
            for name, tip in pairs
        )
        sentences.append(f"with preset {preset} tracking is {found}{'.' if preset == PRESETS[-1] else ';'}")
    return " ".join(("Measured against the Macro's end point with the Mini held still:", *sentences))


def _together(runs: Mapping[str, Run]) -> Notice:
    tip = median(runs["figure_5_12/sound"], "max_tracking_error")
    alone = median(runs["macro_alone/sound"], "macro_max_tracking_error")
    times = {
        preset: (
            median(runs[f"figure_5_8/{preset}"], "settling_time"),
            median(runs[f"macro_alone_goal/{preset}"], "macro_settling_time"),
        )
        for preset in PRESETS
    }
    settling = "; ".join(
        f"{number(one)} against {number(other)} s ({preset}: {_faster(one, other)})"
        for preset, (one, other) in times.items()
    )
    best, other = fastest_speed(runs), fastest_method_3(runs)
    whole = (
        f" One law for the whole arm with a largest tip speed of {best[0]:g} m/s takes {quantity(best[1], 's')}, the "
        f"fastest variant of method 3 {quantity(other[1], 's')}."
        if best is not None and other is not None
        else ""
    )
    gain = tip is not None and alone is not None and tip < alone
    limited = median(runs["macro_alone/sound"], "saturation_fraction_q1")
    stuck = f", joint 1 being at its torque limit for {number(100 * limited, 2)} % of the run" if limited else ""
    return Notice(
        "finding",
        "6a. How good is the pair, compared with a Macro whose Mini holds still?",
        f"On a trajectory {f'{ratio(alone, tip)} times better' if gain else 'no better'}: the tip errs by "
        f"{quantity(tip, 'm')} where the Macro alone errs by {quantity(alone, 'm')}{stuck}. To a goal, one-way "
        f"against Macro alone: {settling}.{whole}",
    )


def _faster(one: float | None, other: float | None) -> str:
    if one is None or other is None:
        return "no comparison"
    return "faster" if one < 0.9 * other else "slower" if one > 1.1 * other else "alike"
