"""Short answers to the thesis' research questions, section 1.3, items 3 to 6."""

from collections.abc import Mapping

from runner.reporting.document import Block, Section, Table, Text
from runner.reporting.figures import origin
from runner.reporting.findings import Finding, finding
from runner.reporting.job import PRESETS
from runner.reporting.measured import Measured
from runner.reporting.run_values import cell, measured, median
from runner.reporting.words import PRESET, in_words
from runner.store import Run
from runner.works.thesis.mass_ratio import breaking_masses
from runner.works.thesis.mini_accuracy import mini_accuracy
from runner.works.thesis.plan import NOMINAL_MASS
from runner.works.thesis.whole_body import fastest_method_3, fastest_speed


def questions_section(runs: Mapping[str, Run]) -> Section:
    """Return the answers, every number from the runs."""
    return Section(
        "The thesis' research questions",
        (
            Text(
                "Section 1.3 of the thesis sets itself six tasks. The first two are those of chapters 3 and 4; here "
                "are answers to the others. Medians over the repetitions, thesis noise and limits, the full "
                "equations unless said."
            ),
            _strategy(runs),
            _independent(runs),
            *_effectiveness(runs),
            _together(runs),
            mini_accuracy(runs),
        ),
    )


def _strategy(runs: Mapping[str, Run]) -> Finding:
    one, two = (_tracking(runs, name) for name in ("one-way", "two-way"))
    turning, fixed, alone = _tracking(runs, _TURNING), _tracking(runs, _FIXED), _alone(runs)
    works, broken = breaking_masses(runs, "unknown")
    heaviest = Measured("heaviest Mini with which one-way control works, without noise", works, "kg")
    first_broken = Measured("lightest Mini tried with which it breaks", broken, "kg")
    return finding(
        "3. An overall strategy from the dynamics of two separate arms? Yes: one-way",
        f"Largest tracking error of the tip: one-way {one}, two-way {two}; independent {turning} with the offset "
        f"turning with the wrist, {fixed} with it fixed in the base frame; the Macro alone {alone}. Each arm needs its "
        "own dynamics alone, as long as the Macro's target leaves the Mini room ($x_d - r_0$) and the Mini knows its "
        "target's velocity, and gravity in its turning base. In single runs "
        f"without noise one-way control works up to a Mini of {heaviest} and breaks with {first_broken}; the thesis' "
        f"weighs {NOMINAL_MASS:g} kg.",
        one < 0.1 * alone,
        one < two,
        one < 0.1 * turning,
        one < 0.1 * fixed,
        heaviest > NOMINAL_MASS,
        first_broken > heaviest,
    )


def _tracking(runs: Mapping[str, Run], coupling: str, preset: str = "sound") -> Measured:
    return measured(runs[f"{_TRACKING[coupling]}/{preset}"], "max_tracking_error", f"{coupling} ({PRESET[preset]})")


def _alone(runs: Mapping[str, Run], preset: str = "sound") -> Measured:
    return measured(runs[f"macro_alone/{preset}"], "macro_max_tracking_error", f"the Macro alone ({PRESET[preset]})")


_TURNING, _FIXED = in_words("independent"), in_words("independent_base")
_TRACKING = {
    "one-way": "figure_5_12",
    "two-way": "figure_5_13",
    _TURNING: "figure_5_3",
    _FIXED: "independent_base",
}


def _independent(runs: Mapping[str, Run]) -> Finding:
    turning, fixed, coupled = (_tracking(runs, name) for name in (_TURNING, _FIXED, "one-way"))
    turned, kept = (_at_rest(runs, name) for name in (_TURNING, _FIXED))
    carried = runs["independent_base/sound"]
    macro = measured(carried, "macro_max_tracking_error", "the Macro's end point, independent")
    macro_rests = measured(carried, "macro_steady_state_error", "the Macro's end point, independent, at rest")
    fitted_turning, fitted_fixed, fitted = (
        _tracking(runs, name, "as_reported") for name in (_TURNING, _FIXED, "one-way")
    )
    return finding(
        "4. Independent or coupled controllers? Coupled, however the independent Mini holds its offset",
        "Independent, the Macro goes to $x_d - r_0$ and the Mini keeps its offset $r_0$; the thesis' words allow two "
        f"frames for it. Fixed in the base frame, the tip misses by {fixed} at most and by {kept} at rest, where the "
        f"Macro's end point misses by {macro} and {macro_rests}: the Macro alone. Turning with the wrist, in the "
        f"Mini's own frame, it misses by {turning} and at rest by {turned}, as $r_0$ turns away from where it is to "
        f"point. One-way coupling misses by {coupled}, {fixed / coupled} and {turning / coupled} times less. As "
        f"reported, where the wrist does not turn, both are one: {fitted_turning}, {fitted_turning / fitted} times "
        "that of one-way coupling.",
        fixed > 10.0 * coupled,
        turning > 10.0 * coupled,
        fixed.near(macro, 0.1),
        kept.near(macro_rests, 0.3),
        turned > 10.0 * kept,
        turning > 1.2 * fixed,
        fitted_fixed.near(fitted_turning, 0.01),
        fitted_turning > 2.0 * fitted,
    )


def _at_rest(runs: Mapping[str, Run], coupling: str) -> Measured:
    return measured(runs[f"{_TRACKING[coupling]}/sound"], "steady_state_error", f"{coupling}, at rest")


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
                    PRESET[preset],
                    name,
                    cell(runs[f"{goal}/{preset}"], f"{prefix}settling_time"),
                    cell(runs[f"{goal}/{preset}"], f"{prefix}steady_state_error"),
                    cell(runs[f"{track}/{preset}"], f"{prefix}max_tracking_error"),
                    cell(runs[f"{track}/{preset}"], f"{prefix}steady_state_error"),
                ]
            )
    return [
        _effect(runs),
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


def _effect(runs: Mapping[str, Run]) -> Finding:
    ratios = {
        (preset, name): _alone(runs, preset) / _tracking(runs, name, preset)
        for preset in PRESETS
        for name in ("one-way", "two-way")
    }
    fitted, sound = ([ratios[preset, name] for name in ("one-way", "two-way")] for preset in PRESETS)
    return finding(
        "5. How effective is the overall controller in simulation?",
        "Measured against the Macro's end point with the Mini held still, tracking is "
        f"{sound[0]} times better with one-way and {sound[1]} times with two-way coupling with the "
        f"full equations. As reported it is {fitted[0]} times better with one-way coupling and {fitted[1]} times with "
        "two-way.",
        sound[0] > 10.0,
        sound[1] > 2.0,
        fitted[0] > 2.0,
        fitted[1] > 0.5,
    )


def _together(runs: Mapping[str, Run]) -> Finding:
    tip, alone = _tracking(runs, "one-way"), _alone(runs)
    share = median(runs["macro_alone/sound"], "saturation_fraction_q1")
    limited = Measured("share of ticks with joint 1 at its limit", None if share is None else 100.0 * share, "%")
    best, other = fastest_speed(runs), fastest_method_3(runs)
    whole = Measured("whole body with a limited tip speed", None if best is None else best[1], "s")
    tried = Measured("fastest of the variants of method 3 that were tried", None if other is None else other[1], "s")
    pairs = [
        (
            measured(runs[f"figure_5_8/{preset}"], "settling_time", f"one-way ({PRESET[preset]})"),
            measured(runs[f"macro_alone_goal/{preset}"], "macro_settling_time", f"the Macro alone ({PRESET[preset]})"),
        )
        for preset in PRESETS
    ]
    settling = "; ".join(
        f"{one} against {macro} ({PRESET[preset]})" for preset, (one, macro) in zip(PRESETS, pairs, strict=True)
    )
    return finding(
        "6a. How good is the pair, compared with a Macro whose Mini holds still? Far better on a trajectory",
        f"The tip errs by {tip} where the Macro alone errs by {alone}, joint 1 being at its torque limit for "
        f"{limited} of the run. To a goal, one-way against Macro alone: {settling}. One law for the whole arm with "
        f"a limited tip speed takes {whole}, the fastest of the variants of method 3 that were tried {tried}.",
        tip < 0.1 * alone,
        limited > 1.0,
        whole < 0.9 * tried,
        *(one / macro > 0.0 for one, macro in pairs),
    )
