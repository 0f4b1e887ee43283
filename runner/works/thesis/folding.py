"""The Macro target x_d, under which the Mini folds onto its base, against x_d - r_0."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Curves, Formula, Panel, Section, Series, Table, Text
from runner.reporting.figures import origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import cell, clock, failures, measured
from runner.reporting.words import in_words
from runner.store import Run
from runner.works.thesis.left_out_gravity import missing_acceleration
from runner.works.thesis.plan import FOLDING, MOTIONS, TARGETS
from runner.works.thesis.studies import extension, mini_dexterity

_CASES = ("sound", "as_reported")
_MOTION = {"goal": "goal", "quintic": "tracking"}


def folding_section(runs: Mapping[str, Run]) -> Section:
    """Return how close to a singular posture the Mini comes under both readings of the Macro's target."""
    ours = {name: run for name, run in runs.items() if name.startswith("folding/")}
    dexterity = {name: mini_dexterity(run) for name, run in ours.items()}
    rows = []
    for case in FOLDING:
        for motion in MOTIONS:
            for target in TARGETS:
                name = f"folding/{case}/{target}/{motion}"
                run, measures = ours[name], dexterity[name]
                row = _closest(measures[:, 0])
                rows.append(
                    [
                        in_words(case),
                        _MOTION[motion],
                        in_words(target),
                        number(float(measures[row, 0])) if np.isfinite(measures[row, 0]) else "–",
                        number(float(measures[row, 1])) if np.isfinite(measures[row, 1]) else "–",
                        f"{clock(run)[row]:.2f}",
                        number(float(extension(run)[row])),
                        cell(run, "steady_state_error"),
                    ]
                )
    home = float(dexterity["folding/sound/minus_home/quintic"][0, 0])
    blocks: list[Block] = [
        Text(
            "The thesis lets the Macro's end point go to the goal position itself. Taken at its word "
            "(macro_target=tip_goal), the Mini has nothing left to reach for and folds onto its base. Its remark "
            "that the Macro with a Mini held still moves as it does alone asks for $x_d - r_0$ "
            "(macro_target=minus_home). Folded, the Mini's Jacobian is singular; at home its smallest singular value "
            f"is {quantity(home, 'm')}:"
        ),
        Formula("|det J| = L^3 |c_3 (c_2 - s_23)|, quad |p| = 2 L |cos((pi / 2 + q_3) / 2)|", "folded, p is zero"),
        Table(
            "Where the Mini comes closest to a singular posture: smallest singular value of its Jacobian, "
            "manipulability and distance $|p|$ from its base to the tip at that time; no noise, the law as printed.",
            [
                "case",
                "motion",
                "Macro target",
                "singular value (m)",
                "$|det J|$ (m³)",
                "at t (s)",
                "$|p|$ (m)",
                "steady error (m)",
            ],
            rows,
            (3, 4, 5, 6, 7),
            origin(runs["folding/sound/tip_goal/quintic"]),
        ),
        _curves(runs, dexterity),
        _finding(runs, dexterity),
        *failures(ours),
    ]
    return Section("Folding the Mini", blocks)


def _closest(singular: np.ndarray) -> int:
    return int(np.nanargmin(singular)) if np.isfinite(singular).any() else 0


def _curves(runs: Mapping[str, Run], dexterity: Mapping[str, np.ndarray]) -> Curves:
    singular, volume, folded = [], [], []
    for index, case in enumerate(_CASES):
        for target in TARGETS:
            name = f"folding/{case}/{target}/quintic"
            t = clock(runs[name])
            style, label = "line" if target == "tip_goal" else "dashed", f"{in_words(case)}, {in_words(target)}"
            singular.append(_series(label, t, dexterity[name][:, 0], style, index))
            volume.append(_series(label, t, dexterity[name][:, 1], style, index))
            folded.append(_series(label, t, extension(runs[name]), style, index))
    return Curves(
        "Tracking: how close the Mini is to a singular posture, and how far it is unfolded.",
        (
            Panel(
                "Smallest singular value", "time (s)", "singular value (m)", singular, y_log=True, y_range=(1e-6, 1.0)
            ),
            Panel("Manipulability", "time (s)", "|det J| (m³)", volume, y_log=True, y_range=(1e-9, 1e-2)),
            Panel("Distance from its base to the tip", "time (s)", "|p| (m)", folded),
        ),
        2,
        origin(runs["folding/sound/tip_goal/quintic"]),
    )


def _series(name: str, t: np.ndarray, y: np.ndarray, style: str, color: int) -> Series:
    return Series(name, t, np.where(y > 0.0, y, np.nan), "dashed" if style == "dashed" else "line", color=color)


def _finding(runs: Mapping[str, Run], dexterity: Mapping[str, np.ndarray]) -> Finding:
    tips = {
        (case, target, motion): measured(
            runs[f"folding/{case}/{target}/{motion}"],
            "steady_state_error",
            f"tip at rest ({in_words(case)}, {in_words(target)}, {_MOTION[motion]})",
        )
        for case in _CASES
        for target in TARGETS
        for motion in MOTIONS
    }
    sound, reported = (runs[f"folding/{case}/tip_goal/quintic"] for case in _CASES)
    folded, kept = (Measured(f"|p| at the end ({in_words(case)})", float(extension(run)[-1]), "m")
                    for case, run in zip(_CASES, (sound, reported), strict=True))  # fmt: skip
    singular = {
        case: Measured(
            f"singular value at the end ({in_words(case)})",
            float(dexterity[f"folding/{case}/tip_goal/quintic"][-1, 0]),
            "m",
        )
        for case in _CASES
    }
    sag = Measured("sag of the Macro (as reported), closed form", _sag(reported), "m")
    lost, spared = (tips[case, "tip_goal", "quintic"] for case in _CASES)
    return finding(
        "Folding costs the control with the full equations, not as reported",
        f"On the trajectory with the full equations the Mini ends {folded} from its base, with a smallest singular "
        f"value of {singular['sound']} and a tip error of {lost}; on the goal move the error is "
        f"{tips['sound', 'tip_goal', 'goal']}. As reported the Mini ends {kept} from its base, with a smallest "
        f"singular value of {singular['as_reported']} and a tip error of {spared}. What spares it then is an error: "
        f"without gravity term the Macro sags, by {sag} in closed form, and that sag keeps the Mini unfolded.",
        *(tips["sound", "tip_goal", motion] > 10.0 * tips["sound", "minus_home", motion] for motion in MOTIONS),
        *(tips["sound", "tip_goal", motion] > 2e-3 for motion in MOTIONS),
        *(tips["as_reported", "tip_goal", m].near(tips["as_reported", "minus_home", m], 0.2) for m in MOTIONS),
        folded < 0.1 * kept,
        singular["sound"] < 0.5 * singular["as_reported"],
        kept.near(sag, 0.1),
    )


def _sag(run: Run) -> float:
    """Return the closed form of the Macro's sag at the end of a run, in m."""
    rate = float(run.config["controller"]["natural_frequency"]["macro"])
    return missing_acceleration(run, len(run.trace) - 1) / rate**2
