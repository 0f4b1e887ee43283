"""What explains the thesis' errors: the missing gravity term, and the missing feedforward."""

from collections.abc import Mapping, Sequence

import numpy as np

from runner.claims import load_claims
from runner.reporting.document import Block, Curves, Formula, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, joint_columns, model_of, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.job import PRESETS
from runner.reporting.measured import Condition, Measured
from runner.reporting.run_values import measured
from runner.reporting.words import PRESET
from runner.store import Run
from runner.works.thesis.lag_by_axis import lag_by_axis
from runner.works.thesis.plan import ARMS, LAG_DURATIONS


def gravity_section(runs: Mapping[str, Run]) -> Section:
    """Return the sag of a controller without gravity term, closed form against simulation."""
    rows, sags = [], {}
    for arm in ARMS:
        run = runs[f"gravity_term/{arm}"]
        simulated = float(np.linalg.norm(columns(run.trace, "error")[-1]))
        predicted = float(np.linalg.norm(_sag(run)))
        sags[arm] = (
            Measured(f"sag of the {arm}, simulated", simulated, "m"),
            Measured(f"sag of the {arm}, closed form", predicted, "m"),
        )
        rows.append([arm, f"{1e3 * predicted:#.4g}", f"{1e3 * simulated:#.4g}", _more(simulated, predicted)])
    blocks: list[Block] = [
        Text(
            "A proportional-derivative law in operational space that lacks the term $hat(p)(x)$ comes to rest where "
            "its proportional part carries the weight:"
        ),
        Formula("x_d - x = 1 / omega_n^2 J M^(-1) G", "the error at rest equals J M inverse G over omega n squared"),
        Table(
            "Norm of the tip's sag at the end of a noise-free quintic, without gravity term; the closed form at the "
            "run's final true $q$.",
            ["arm", "closed form (mm)", "simulated (mm)", "difference"],
            rows,
            (1, 2, 3),
            origin(runs["gravity_term/macro"]),
        ),
        _gravity(runs, sags),
    ]
    return Section("The gravity term", blocks)


def _gravity(runs: Mapping[str, Run], sags: Mapping[str, tuple[Measured, Measured]]) -> Finding:
    """Return what the thesis' errors at rest look like; why they do is an inference, and said to be one."""
    claims = {claim.number: claim for claim in load_claims("thesis")}
    printed = {
        arm: Measured(f"steady error of the {arm}, printed", claims[claim].printed[-1], "m")
        for arm, claim in zip(ARMS, (2, 7), strict=True)
    }
    left_out, kept = (
        {
            arm: measured(
                runs[f"{figure}/{preset}"], "steady_state_error", f"steady error of the {arm} ({PRESET[preset]})"
            )
            for arm, figure in zip(ARMS, ("figure_3_5", "figure_4_2"), strict=True)
        }
        for preset in PRESETS
    )
    gravity, noise, ratio = (errors["macro"] / errors["mini"] for errors in (left_out, kept, printed))
    return finding(
        "The thesis' steady-state errors are those of a law without gravity term",
        f"The goal run of figure 3.5 without gravity term rests at {left_out['macro']}, with it at {kept['macro']}; "
        f"the thesis prints up to {printed['macro']}. The Macro's error is {noise} times the Mini's where encoder "
        f"noise sets it, {gravity} times where gravity does; the thesis prints {ratio} times. That its controller left "
        "out the gravity term which its equation (3.32) contains is an inference: another constant acceleration of "
        "that size would leave the same error.",
        *(simulated.near(predicted, 0.01) for simulated, predicted in sags.values()),
        left_out["macro"].near(printed["macro"], 0.15),
        kept["macro"] < 0.2 * left_out["macro"],
        gravity.near(100.0, 0.1),
        noise > 2.0 * ratio,
        ratio < 2.0 * gravity,
    )


def _more(simulated: float, predicted: float) -> str:
    """Return by how much a value is larger than predicted, in per cent."""
    difference = 100.0 * (simulated / predicted - 1.0) if predicted else float("nan")
    return "below 0.01 %" if abs(difference) < 0.01 else f"{difference:+.2f} %"


def _sag(run: Run) -> np.ndarray:
    """Return J M^-1 G / omega_n^2 at the run's final true joint positions, shape (3,), in m."""
    model = model_of(run)
    q = joint_columns(run.trace, "q")[-1]
    wn = run.config["controller"]["natural_frequency"]
    sag: np.ndarray = model.tip_jacobian(q)[:3] @ np.linalg.solve(model.mass_matrix(q), model.gravity_torque(q)) / wn**2
    return sag


def lag_section(runs: Mapping[str, Run]) -> Section:
    """Return the lag of a controller without feedforward, closed form against simulation."""
    rows, series, lags = [], [], []
    for index, arm in enumerate(ARMS):
        pairs = []
        for t_f in LAG_DURATIONS:
            run = runs[f"lag/{arm}/{t_f}"]
            simulated = float(np.linalg.norm(columns(run.trace, "error"), axis=1).max())
            predicted = _lag(run, t_f)
            pairs.append((simulated, predicted))
            name = f"lag of the {arm}, {t_f:g} s"
            lags.append(
                Measured(f"{name}, simulated", simulated, "m").near(
                    Measured(f"{name}, closed form", predicted, "m"), 0.03
                )
            )
            rows.append(
                [
                    arm,
                    f"{t_f:g}",
                    f"{1e3 * predicted:#.4g}",
                    f"{1e3 * simulated:#.4g}",
                    _more(simulated, predicted),
                ]
            )
        t = np.array(LAG_DURATIONS)
        series.append(Series(f"{arm}, closed form", t, np.array([p for _, p in pairs]), "dashed", color=index))
        series.append(Series(f"{arm}, simulated", t, np.array([m for m, _ in pairs]), "points", color=index))
    run = runs[f"lag/macro/{LAG_DURATIONS[2]}"]
    blocks: list[Block] = [
        Text(
            "Without desired velocity and acceleration the goal law chases a moving goal. Its tip lags by the "
            "velocity times $2 xi slash omega_n$; the quintic's largest velocity is $1.875 D slash t_f$:"
        ),
        Formula(
            "max |x_d - x| = (2 xi) / omega_n (1.875 |D|) / t_f",
            "largest lag equals 2 xi over omega n times 1.875 D over t f",
        ),
        Table(
            "Largest norm of the tip error, noise-free, gravity compensated, no torque limit, without feedforward.",
            ["arm", "$t_f$ (s)", "closed form (mm)", "simulated (mm)", "difference"],
            rows,
            (1, 2, 3, 4),
            origin(run),
        ),
        Curves(
            "Lag against duration: the closed form and the simulation.",
            (Panel("", "duration (s)", "largest error norm (m)", series, y_log=True),),
            1,
            origin(run),
        ),
        _no_feedforward(runs, lags),
        lag_by_axis(runs),
    ]
    return Section("The lag", blocks)


def _no_feedforward(runs: Mapping[str, Run], lags: Sequence[Condition]) -> Finding:
    claim = next(claim for claim in load_claims("thesis") if claim.number == 6)
    low, high = (
        Measured(f"{end} printed error of the Mini", value, claim.unit)
        for end, value in zip(("smallest", "largest"), claim.printed, strict=True)
    )
    t_f = LAG_DURATIONS[2]
    lag = measured(runs[f"lag/mini/{t_f}"], "max_tracking_error", "lag of the Mini on its worst axis")
    fed = measured(runs["figure_4_4/sound"], "max_tracking_error", "tracking error of the Mini with feedforward")
    return finding(
        "The Mini's printed tracking errors are those of a law without feedforward",
        f"The thesis prints {low} to {high}. At $t_f$ = {t_f:g} s the lag without feedforward is {lag} on the worst "
        f"axis; with the feedforward of equation (3.40) the error is {fed}. That the thesis' tracking law was the goal "
        "law with a moving goal is an inference from this.",
        *lags,
        lag > low,
        lag < high,
        fed < 0.1 * low,
    )


def _lag(run: Run, t_f: float) -> float:
    controller = run.config["controller"]
    desired = columns(run.trace, "desired")
    distance = float(np.linalg.norm(desired[-1] - desired[0]))
    rate = float(controller["natural_frequency"])
    return 2.0 * float(controller["damping_ratio"]) / rate * 1.875 * distance / t_f
