"""Flexible Macro: modes, stability limits and damping ratios from free vibration."""

from collections.abc import Callable
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.papers.studies.thesis_beyond.cantilever import frequency_errors
from runner.papers.studies.thesis_beyond.flexible_map import stable_and_not
from runner.papers.study.prose.plots import points
from runner.papers.study.prose.signals import moved, norm, vector
from runner.papers.study.results import Runs
from runner.reporting.document import Series
from runner.robots.vibration import Mode
from runner.store import Run
from runner.trajectories.shaped import zero_vibration

_MACRO = 3  # its joints
_STIFFNESSES = (200.0, 500.0, 1000.0, 2000.0, 5000.0, 10000.0)  # N m/rad
_KICK = 0.3  # s, after which the push of a run that rings is over
_PEAKS = 2
_GRID = 13  # points of a map
_MAP_STEP = 2.5e-3  # s, of the plant
_HEARD = 0.02  # of the largest peak, below which peaks are ignored
_SETTLED = 2e-3  # m
_STILL = 1e-9  # m/s, of a desired motion that has ended
_REST = 0.3  # s at the end of a run, over which the place is taken where the tip rests
_DISPLACED = norm(moved(vector("macro_tip")))  # m, of the Macro's end point from where it began
_PARTS = (1, 2, 3, 4, 8, 16)


def modes(runs: Runs, run: str, law: float) -> list[Series]:
    """Return the Macro's modes at home in Hz against the stiffness of its joints, and a law's frequency in rad/s."""
    stiffness = np.array(_STIFFNESSES)
    rates = [np.sqrt(stiffness / mass) / (2.0 * np.pi) for mass in np.linalg.eigvalsh(_mass(runs[run]))[::-1]]
    lines = [Series(f"mode {mode}", stiffness, rate, "line", color=mode) for mode, rate in enumerate(rates, 1)]
    return [*lines, Series("law", stiffness, np.full(len(stiffness), law / (2.0 * np.pi)), "dotted", color=0)]


def lowest_mode(run: Run) -> float:
    """Return the frequency of the Macro's lowest mode at home, with the joints mounted on it held, in Hz."""
    stiffness = float(run.config["plant"]["flexible_joints"]["stiffness"]["macro"])
    return float(np.sqrt(stiffness / np.linalg.eigvalsh(_mass(run))[-1]) / (2.0 * np.pi))


def grows(run: Run) -> bool:
    """Return True if the motion at the end is faster than half-way, which an unstable law causes."""
    if run.status == "failed":
        return True
    speed = np.abs(run.joints("dq")).max(axis=1)
    tenth = max(1, len(speed) // 10)
    return bool(speed[-tenth:].max() > speed[5 * tenth : 6 * tenth].max())


def motors_bear(runs: Runs, run: str) -> Callable[[float], float]:
    """Return the natural frequency in rad/s up to which the sampled law is stable by motors of an inertia in kg m^2."""
    heaviest, period = float(np.linalg.eigvalsh(_mass(runs[run]))[-1]), float(runs[run].config["controller"]["period"])
    return lambda inertia: 1.0 / (period * (1.0 + heaviest / inertia))


def links_bear(runs: Runs, run: str) -> Callable[[float], float]:
    """Return the largest stable natural frequency in rad/s of a first joint by encoders at links, by its resonance."""
    joints = runs[run].config["plant"]["flexible_joints"]
    link, motor = float(_mass(runs[run])[0, 0]), float(joints["motor_inertia"][0])
    share = float(joints["damping_ratio"]) * float(np.sqrt((link + motor) / motor))
    return lambda resonance: share * resonance


def map_of_motors(runs: Runs, run: str) -> list[Series]:
    """Return the stability map of a run's law by encoders at the motors, over their inertia in kg m^2."""
    inertias, frequencies = np.geomspace(0.4, 10.0, _GRID), np.geomspace(8.0, 100.0, _GRID)
    return stable_and_not(
        runs[run],
        inertias,
        frequencies,
        lambda B: {"plant.flexible_joints.motor_inertia": B, "gravity": 0.0, "plant.step": _MAP_STEP},
    )


def map_of_links(runs: Runs, run: str) -> list[Series]:
    """Return the stability map of a run's law by encoders at the links, over the resonance of joint 1 in rad/s."""
    resonances, frequencies = np.geomspace(12.0, 120.0, _GRID), np.geomspace(0.5, 12.0, _GRID)
    motor = float(runs[run].config["plant"]["flexible_joints"]["motor_inertia"][0])
    link = float(_mass(runs[run])[0, 0])
    both = link * motor / (link + motor)
    return stable_and_not(
        runs[run],
        resonances,
        frequencies,
        lambda resonance: {
            "plant.flexible_joints.stiffness": [both * resonance**2, None, None],
            "plant.step": _MAP_STEP,
        },
    )


def most(of: Callable[[Run], FloatArray], after: bool) -> Callable[[Run], float]:
    """Return the largest distance while the desired motion lasts, or after it, in m; NaN of a run that ends before."""

    def worst(run: Run) -> float:
        moving = run.t <= float(run.config["trajectory"]["duration"]) + 1e-9
        return float(np.max(of(run)[~moving if after else moving], initial=np.nan if moving.all() and after else 0.0))

    return worst


def rings_until(run: Run) -> float:
    """Return when the Macro's end point is last 2 mm away from where it began, in s; NaN where it rings on."""
    t, away = run.t, _DISPLACED(run) > _SETTLED
    last = np.flatnonzero(away)
    return float("nan") if away[t > 0.9 * t[-1]].any() or not len(last) else float(t[last[-1]])


def damping_ratio(run: Run, bare: Run) -> float:
    """Return the damping ratio of the first mode of the bare Macro as its peaks rise or fall; NaN of fewer than two."""
    phi, t, q = _shape(bare), run.t, run.joints("q")[:, :_MACRO]
    y = (q - q[0]) @ _mass(bare) @ phi
    peaks = 1 + np.flatnonzero((y[1:-1] > y[:-2]) & (y[1:-1] >= y[2:]))
    peaks = peaks[t[peaks] > _KICK]
    if len(peaks) < _PEAKS:
        return float("nan")
    period = float(np.diff(t[peaks]).mean())
    heard = peaks[y[peaks] > _HEARD * y[peaks].max()]
    return float(-np.polyfit(t[heard], np.log(y[heard]), 1)[0] * period / (2.0 * np.pi))


def closed_damping(run: Run, bare: Run) -> float:
    """Return the damping ratio by closed forms: for goals without velocities, or for inertial damping; else 0."""
    law = run.config["controller"]
    if law["coupling"] == "inertial_damping":
        return damping_by_gain(run, bare)(float(law["damping_gain"]))
    if law["mini_reference_velocity"] == "zero":
        omega, share = _first_mode(run, bare)
        return -share * omega / float(law["natural_frequency"]["mini"])
    return 0.0


def damping_by_gain(run: Run, bare: Run) -> Callable[[float], float]:
    """Return the damping ratio of the first mode that inertial damping adds, against its gain in 1/s."""
    omega, share = _first_mode(run, bare)
    soft = float(run.config["controller"]["natural_frequency"]["mini"])
    return lambda gain: share * (gain + 2.0 * soft) / (2.0 * omega)


def left_of_vibration(run: Run, unshaped: Run) -> float:
    """Return the vibration of joint 1 after a shaped move, over that after the same unshaped move."""
    return _rings(run) / _rings(unshaped)


def shaped_line(kind: Literal["zv", "zvd"]) -> Callable[[float], float]:
    """Return the closed form of it, without damping, against that share."""
    return lambda share: zero_vibration(kind, share, 0.0).residual(1.0)


def off_the_line(runs: Runs, pattern: str, unshaped: str, kind: Literal["zv", "zvd"]) -> float:
    """Return by how much what runs leave of the vibration differs from the closed form, at most."""
    (left,) = points(runs, pattern, "share", left_of_vibration, "", unshaped)
    exact = np.array([shaped_line(kind)(float(share)) for share in left.x])
    return float(np.abs(left.y - exact).max())


def rings_after(run: Run) -> float:
    """Return the tip's largest distance from its rest, once its desired motion has ended, in m; NaN before."""
    error, t, ended = run.vector("error"), run.t, _first_at_rest(run)
    if ended is None:
        return float("nan")
    away = error[ended:] - error[t > t[-1] - _REST].mean(axis=0)
    return float(np.linalg.norm(away, axis=1).max())


def beam_errors(tip_ratio: float, mode: int, name: str, color: int) -> list[Series]:
    """Return by how much chains of this many springs ring faster than the beam they stand for, as points."""
    parts = np.array(_PARTS)
    errors = np.array([frequency_errors(tip_ratio, int(n), mode)[mode - 1] for n in parts if n >= mode])
    return [Series(name, parts[parts >= mode].astype(float), errors, "points_line", color=color)]


def order_of_chains(tip_ratio: float) -> float:
    """Return the order in 1/n by which a chain's first mode goes to that of its beam, from 8 to 16 springs."""
    few, many = (frequency_errors(tip_ratio, n, 1)[0] for n in (8, 16))
    return float(np.log2(few / many))


def _rings(run: Run) -> float:
    """Return the amplitude of joint 1's vibration once its desired motion has ended, in rad; NaN before."""
    stiffness = float(run.config["plant"]["flexible_joints"]["stiffness"])
    mode, t = Mode(float(np.sqrt(stiffness / _mass(run)[0, 0]) / (2.0 * np.pi)), 0.0), run.t
    ended = _first_at_rest(run)
    return float("nan") if ended is None else mode.amplitude(t, run.joints("q")[:, 0], float(t[ended]))


def _first_at_rest(run: Run) -> int | None:
    """Return the first row after the desired motion; None of a run that ends before."""
    moving = np.flatnonzero(np.abs(run.vector("desired_velocity")).max(axis=1) > _STILL)
    return int(moving[-1]) + 1 if len(moving) and moving[-1] + 1 < len(run.t) else None


def _first_mode(run: Run, bare: Run) -> tuple[float, float]:
    r"""Return the first mode's frequency in rad/s, and the Mini's mass along it over the modal mass at its base, m/m_1.

    An acceleration a asked of the Mini's tip loads the Macro's joints with -M_Mm J_m^-1 a, where M_Mm is the part of
    the mass matrix that couples Macro and Mini. Along the mode phi, whose base moves by J_M phi,

    .. math:: m / m_1 = \phi^T M_{Mm} J_m^{-1} J_M \phi / (\phi^T M \phi)
    """
    phi, M, model, q = _shape(bare), _mass(bare), run.model, run.joints("q")[0]
    whole, moves = model.tip_jacobian(q)[:3], bare.model.tip_jacobian(np.zeros(_MACRO))[:3] @ phi
    couples = model.mass_matrix(q)[:_MACRO, _MACRO:]
    stiffness = float(run.config["plant"]["flexible_joints"]["stiffness"]["macro"])
    weight = float(phi @ M @ phi)
    light = float(phi @ couples @ np.linalg.solve(whole[:, _MACRO:], moves))
    return float(np.sqrt(stiffness * (phi @ phi) / weight)), light / weight


def _shape(bare: Run) -> FloatArray:
    """Return the joints' part in the first mode of the bare Macro at home, all stiffnesses equal, shape (3,)."""
    return np.asarray(np.linalg.eigh(_mass(bare))[1][:, -1])


def _mass(run: Run) -> NDArray[np.float64]:
    """Return the mass matrix of the Macro's joints at home, with the joints mounted on it held, shape (3, 3)."""
    model = run.model
    return model.mass_matrix(np.zeros(model.nq))[:_MACRO, :_MACRO]
