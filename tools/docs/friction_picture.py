"""Picture of joint friction for docs/realism.md: laws, stick-slip, and asymmetric rest, against closed forms."""

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from runner.base.arrays import FloatArray
from runner.plants.friction import Frictional
from runner.plants.friction_law import JointFriction, joint_friction
from runner.plants.rk4 import Rk4
from runner.reporting.charts import palette
from runner.reporting.charts.canvas import GREY, INK, drawing
from runner.robots.model import RobotModel
from runner.schema.values import FrictionConfig, SigmoidConfig
from runner.symbolic.maths import NUMPY

_INERTIA, _STIFFNESS, _SPEED, _TICK = 0.68, 50.0, 0.1, 1e-3  # kg m^2, N m/rad, rad/s, s
_OMEGA = np.sqrt(_STIFFNESS / _INERTIA)
_WHEEL = f"""<robot name="wheel"><link name="base"/><link name="wheel"><inertial><mass value="1"/>
<inertia ixx="{_INERTIA}" iyy="{_INERTIA}" izz="{_INERTIA}" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="q1" type="revolute"><parent link="base"/><child link="wheel"/><axis xyz="0 0 1"/>
<limit lower="-9" upper="9" effort="1e9" velocity="1e9"/></joint></robot>"""
_OURS, _EXACT = {"color": palette.LIGHT[0], "lw": 3.5, "alpha": 0.4}, {"color": INK, "lw": 0.9, "ls": "--"}


@drawing
def friction() -> Figure:
    """Draw the three parts; angles in mrad."""
    figure = Figure(figsize=(9.0, 2.6))
    laws, pulled, swinging = figure.subplots(1, 3)
    _draw_laws(laws)
    _draw_stick_slip(pulled)
    _draw_rest(swinging)
    figure.tight_layout()
    return figure


def _law(coulomb: float = 0.0, asymmetry: float = 0.0, **more: float) -> JointFriction:
    sigmoid = SigmoidConfig(level=more.pop("level", 0.0), steepness=15.0, shift=0.0)
    static, speed = more.get("static"), more.get("stribeck_speed")
    config = FrictionConfig(
        viscous=0.0,
        coulomb=coulomb,
        asymmetry=asymmetry,
        static=static,
        stribeck_speed=speed,
        stribeck_curve="gauss",
        sigmoid=sigmoid,
    )
    return joint_friction("plant.friction", config, ["q1"])


def _draw_laws(axes: Axes) -> None:
    kinds = {
        "coulomb": _law(1.0),
        "static, stribeck_speed": _law(1.0, static=2.0, stribeck_speed=0.1),
        "asymmetry": _law(1.0, 0.5),
        "sigmoid": _law(level=2.0),
    }
    v = np.linspace(-0.4, 0.4, 402)  # not 0
    for (name, law), color in zip(kinds.items(), palette.LIGHT, strict=False):
        torque = [law.at(NUMPY, [float(w)], [False]) for w in v]
        y = [b[0] * w + c[0] * np.sign(w) + law.asymmetry[0] for w, (b, c) in zip(v, torque, strict=True)]
        axes.plot(v, y, color=color, lw=1.4, label=name)
    axes.set(xlabel="speed (rad/s)", ylabel="friction (N m)", title="kinds", ylim=(-2.2, 3.9))
    axes.legend(frameon=False, fontsize=7, loc="upper left")


def _draw_stick_slip(axes: Axes) -> None:
    coulomb, static = 1.0, 2.0  # N m
    t, q = _simulated(_law(coulomb, static=static), 0.0, 2.6, lambda t: _SPEED * t)
    axes.plot(t, 1e3 * q, **_OURS, label="plant")
    axes.plot(t, 1e3 * _stick_slip(t, coulomb, static), **_EXACT, label="exact")
    axes.plot(t, 1e3 * _SPEED * t, color=GREY, lw=0.8, label="end of the spring")
    axes.set(xlabel="t (s)", ylabel="angle (mrad)", title="stick-slip on a pulled spring")
    axes.legend(frameon=False, fontsize=7)


def _draw_rest(axes: Axes) -> None:
    up, down = 1.5, 0.5  # N m
    for start in (0.19, -0.19):
        t, q = _simulated(_law(1.0, 0.5), start, 2.0, lambda t: 0.0)
        axes.plot(t, 1e3 * q, **_OURS, label="plant" if start > 0.0 else None)
        axes.plot(t, 1e3 * _swings(t, start, up, down), **_EXACT, label="exact" if start > 0.0 else None)
    axes.axhspan(-1e3 * up / _STIFFNESS, 1e3 * down / _STIFFNESS, color=GREY, alpha=0.25, lw=0, label="rest")
    axes.set(xlabel="t (s)", ylabel="angle (mrad)", title="rest with asymmetric levels")
    axes.legend(frameon=False, fontsize=7)


def _simulated(
    law: JointFriction, start: float, duration: float, end: Callable[[float], float]
) -> tuple[FloatArray, FloatArray]:
    """Return times and angles of a wheel on a spring whose other end moves, in s and rad."""
    model = RobotModel(_WHEEL, "wheel")
    plant = Frictional(Rk4(model, _TICK, 1), model, law, _TICK)
    plant.reset(np.array([start]), np.zeros(1))
    t = _TICK * np.arange(round(duration / _TICK))
    q = np.empty(len(t))
    for k, now in enumerate(t):
        q[k] = plant.q[0]
        plant.advance(np.array([_STIFFNESS * (end(now + _TICK / 2) - plant.q[0] - _TICK / 2 * plant.dq[0])]))
    return t, q


def _stick_slip(t: FloatArray, coulomb: float, static: float) -> FloatArray:
    """Return the angle at times from rest with a loose spring: it sticks, and slips on a cosine about even motion."""
    drop = (static - coulomb) / (_STIFFNESS * _SPEED)  # s
    slip = 2.0 * (np.pi - np.arctan(_OMEGA * drop)) / _OMEGA
    period = 2.0 * drop + slip
    since = t - static / (_STIFFNESS * _SPEED)
    cycle = np.floor(since / period)
    s = np.minimum(since - cycle * period, slip)
    moved = _SPEED * s + _SPEED * (drop * (1.0 - np.cos(_OMEGA * s)) - np.sin(_OMEGA * s) / _OMEGA)
    return np.where(since < 0.0, 0.0, cycle * _SPEED * period + moved)


def _swings(t: FloatArray, start: float, up: float, down: float) -> FloatArray:
    """Return the angle at times of a mass on a spring from rest: each swing is a cosine about its own middle."""
    q, angle = np.full(len(t), start), start
    for swing in range(len(t)):
        if -down <= -_STIFFNESS * angle <= up:
            break
        middle = (down if angle > 0.0 else -up) / _STIFFNESS
        s = _OMEGA * t - np.pi * swing
        q = np.where(s >= 0.0, middle + (angle - middle) * np.cos(np.minimum(s, np.pi)), q)
        angle = 2.0 * middle - angle
    return q
