"""The runs behind what the thesis could not show of the combined arm."""

from runner.reporting.job import PRESETS, Job, Jobs

METHODS = ("one_way", "two_way", "independent", "independent_base", "mini_held", "whole_body")
MOTIONS = ("goal", "quintic")
DYNAMICS = ("coupled", "decoupled")
VANISHING = (0.1, 0.01, 0.001)  # kg, each of the Mini's two point masses
NOMINAL_MASS = 0.2  # kg, the thesis' Mini
MASSES = (0.01, 0.05, NOMINAL_MASS, 0.5, 1.0, 1.5, 1.75, 2.0, 2.5, 3.0)  # kg, the whole Mini
PAYLOADS = ("unknown", "known")
NOISY_MASSES = (1.5, 1.75)  # kg, with the thesis' noise, near the mass at which one-way control breaks without
MACRO_PERIODS = (0.01, 0.02, 0.03, 0.032, 0.033, 0.034, 0.036)  # s
MINI_PERIODS = (0.001, 0.002, 0.003, 0.0032, 0.0033, 0.0034, 0.0036)  # s
EULER_PERIODS = {1: (0.0026, 0.0027, 0.0028, 0.0029), 4: (0.003, 0.0031, 0.0032, 0.0033)}  # s, by steps in a period
FOLDING = {
    "sound": ("preset=sound",),
    "sound, no torque limit": ("preset=sound", "torque_limits=none"),
    "as_reported": ("preset=as_reported",),
    "as_reported, no torque limit": ("preset=as_reported", "torque_limits=none"),
}
TARGETS = ("tip_goal", "minus_home")
STRETCHING = {
    "sound": ("preset=sound",),
    "sound, decoupled": ("preset=sound", "plant.dynamics=decoupled"),
    "sound, payload known": ("preset=sound", "controller.payload=known"),
    "as_reported": ("preset=as_reported",),
    "as_reported with gravity term": ("preset=as_reported", "controller.gravity_compensation=true"),
}
REFERENCE_DURATIONS = (1.5, 2.0, 3.0, 4.0, 6.0)  # s, t_f
NOISES = ("none", "thesis")
VELOCITIES = ("zero", "full")
SCHEDULES = ("both", "turns")
TURN_DURATIONS = (3.0, 6.0, 12.0)  # s, t_f
SLOW_DURATION = 6.0  # s, t_f, of whole-body control at 10 ms
BANDWIDTHS = (300.0, 100.0, 60.0, 30.0)  # rad/s, of the Mini; the first is that of the thesis
BIASED = (300.0, 30.0)  # rad/s, of the Mini under a bias of the Macro's encoders
MACRO_BIAS = 1e-3  # rad, as large as the half-width of the thesis' encoder noise
TIP_SPEEDS = (1.0, 1.5, 2.0, 3.0, 4.0)  # m/s, of whole-body control
# Natural frequencies keep omega_n h at 0.3 or below, as the thesis does.
COMPARED_RATES = {
    "whole body, 1 ms": ("experiment=thesis/whole_body", "controller.period=0.001"),
    "whole body, 10 ms": ("experiment=thesis/whole_body", "controller.period=0.01"),
    "one_way, 10 ms and 1 ms": ("controller.coupling=one_way",),
    "one_way, both 1 ms": ("controller.coupling=one_way", "controller.period.macro=0.001"),
    "one_way, both 10 ms": (
        "controller.coupling=one_way",
        "controller.period.mini=0.01",
        "controller.natural_frequency.mini=30",
    ),
    "two_way, 10 ms and 1 ms": ("controller.coupling=two_way",),
    "two_way, both 1 ms": ("controller.coupling=two_way", "controller.period.macro=0.001"),
}
_STAGED = {"goal": "experiment=thesis/figure_5_8", "quintic": "experiment=thesis/figure_5_12"}
_ONCE = ("repetitions=1", "noise=none")
_SEVEN, _EIGHT = "repetitions=7", "repetitions=8"
_BULLET_STEP = "plant.step=0.00025"


def combined_jobs() -> Jobs:
    """Return every run by name."""
    return {
        **_coupling(),
        **_masses(),
        **_sampling(),
        **_shapes(),
        **_references(),
        **_turns(),
        **_whole_body(),
        **_bandwidths(),
        **_independent(),
    }


def _coupling() -> Jobs:
    jobs = {
        f"coupling/{motion}/{method}/{dynamics}": Job(
            (*_method(motion, method), *_ONCE, f"plant.dynamics={dynamics}"),
        )
        for motion in MOTIONS
        for method in METHODS
        for dynamics in DYNAMICS
    }
    for motion in MOTIONS:
        jobs[f"coupling/{motion}/noise"] = Job((_STAGED[motion], "repetitions=3"))
    for mass in VANISHING:
        for dynamics in DYNAMICS:
            overrides = (_STAGED["quintic"], *_ONCE, "plant=rk4", f"plant.dynamics={dynamics}", *_mini_mass(2 * mass))
            jobs[f"vanishing/{mass}/{dynamics}"] = Job(overrides)
    return jobs


def _method(motion: str, method: str) -> tuple[str, ...]:
    if method == "whole_body":
        return ("experiment=thesis/whole_body", f"trajectory={motion}")
    return (_STAGED[motion], f"controller.coupling={method}")


def _mini_mass(mass: float) -> tuple[str, ...]:
    return tuple(f"robot.stages.mini.masses.{link}={mass / 2:g}" for link in ("link2", "link3"))


def _masses() -> Jobs:
    jobs = {
        f"mass/{mass}/{payload}": Job(
            (_STAGED["quintic"], *_ONCE, *_mini_mass(mass), f"controller.payload={payload}"),
        )
        for mass in MASSES
        for payload in PAYLOADS
    }
    for mass in NOISY_MASSES:
        jobs[f"mass_noise/{mass}"] = Job((_STAGED["quintic"], _EIGHT, *_mini_mass(mass)))
    return jobs


def _sampling() -> Jobs:
    step = (_STAGED["goal"], *_ONCE, "torque_limits=none", "trajectory.goal=[0.001,1.099,1.1]", "duration=2")
    jobs: Jobs = {}
    for dynamics in DYNAMICS:
        for h in MACRO_PERIODS:
            own: tuple[str, ...] = ("plant=rk4", f"controller.period.macro={h:g}")
            jobs[f"stage_sampling/macro/{dynamics}/{h}"] = Job((*step, *own, f"plant.dynamics={dynamics}"))
        for h in MINI_PERIODS:
            own = ("plant=rk4", *_mini_period(h))
            jobs[f"stage_sampling/mini/{dynamics}/{h}"] = Job((*step, *own, f"plant.dynamics={dynamics}"))
        for steps, periods in EULER_PERIODS.items():
            for h in periods:
                own = (f"plant.step={h / steps:.9g}", *_mini_period(h))
                jobs[f"stage_sampling/euler{steps}/{dynamics}/{h}"] = Job(
                    (*step, *own, f"plant.dynamics={dynamics}"),
                )
    return jobs


def _mini_period(h: float) -> tuple[str, ...]:
    """Return a Mini period, and the Macro period nearest to 10 ms that is a multiple of it."""
    return (f"controller.period.mini={h:g}", f"controller.period.macro={round(0.01 / h) * h:.9g}")


def _shapes() -> Jobs:
    jobs: Jobs = {}
    for case, overrides in FOLDING.items():
        for target in TARGETS:
            for motion in MOTIONS:
                own = (_STAGED[motion], *_ONCE, *overrides, f"controller.macro_target={target}")
                jobs[f"folding/{case}/{target}/{motion}"] = Job(own)
    for case, overrides in STRETCHING.items():
        two_way = (_STAGED["goal"], *_ONCE, *overrides, "controller.coupling=two_way", "duration=8")
        jobs[f"stretch/{case}"] = Job(two_way)
    for preset in PRESETS:
        overrides = (_STAGED["quintic"], *_ONCE, f"preset={preset}", "controller.coupling=two_way")
        jobs[f"stretch/quintic/{preset}"] = Job(overrides)
    return jobs


def _references() -> Jobs:
    return {
        f"reference/{noise}/{velocity}/{t_f}": Job(
            (
                _STAGED["quintic"],
                "repetitions=1",
                "torque_limits=none",
                f"noise={noise}",
                f"controller.mini_reference_velocity={velocity}",
                f"trajectory.duration={t_f}",
            ),
        )
        for noise in NOISES
        for velocity in VELOCITIES
        for t_f in REFERENCE_DURATIONS
    }


def _turns() -> Jobs:
    jobs: Jobs = {}
    for schedule in SCHEDULES:
        own = (*_ONCE, f"controller.schedule={schedule}")
        for preset in PRESETS:
            for motion in MOTIONS:
                jobs[f"turns/{preset}/{motion}/{schedule}"] = Job((_STAGED[motion], *own, f"preset={preset}"))
        for t_f in TURN_DURATIONS:
            overrides = (_STAGED["quintic"], *own, f"trajectory.duration={t_f}")
            jobs[f"turns/{t_f}/{schedule}"] = Job(overrides)
    return jobs


def _whole_body() -> Jobs:
    jobs: Jobs = {}
    for rate, overrides in COMPARED_RATES.items():
        for motion in MOTIONS:
            base = (f"trajectory={motion}",) if "experiment=thesis/whole_body" in overrides else (_STAGED[motion],)
            jobs[f"whole_body/{motion}/{rate}"] = Job((*base, *overrides, _SEVEN, _BULLET_STEP))
    for speed in TIP_SPEEDS:
        overrides = ("experiment=thesis/whole_body", "trajectory=goal", f"controller.max_tip_speed={speed:g}")
        jobs[f"whole_body/speed/{speed}"] = Job((*overrides, _SEVEN))
    slow = ("experiment=thesis/whole_body", "controller.period=0.01", f"trajectory.duration={SLOW_DURATION:g}")
    jobs["whole_body/slow"] = Job((*slow, "repetitions=1", _BULLET_STEP))
    return jobs


def _bandwidths() -> Jobs:
    base = (_STAGED["quintic"], "controller.payload=known", _SEVEN)
    rates = {rate: f"controller.natural_frequency.mini={rate:g}" for rate in BANDWIDTHS}
    jobs = {f"bandwidth/{rate}": Job((*base, own)) for rate, own in rates.items()}
    for rate in BIASED:
        jobs[f"bandwidth/bias/{rate}"] = Job((*base, rates[rate], f"noise.bias.macro={MACRO_BIAS:g}"))
    jobs["bandwidth/held"] = Job((*base, "controller.coupling=mini_held"))
    return jobs


def _independent() -> Jobs:
    """Return figure 5.3 with the Mini's offset kept in the base frame."""
    base = ("experiment=thesis/figure_5_3", "controller.coupling=independent_base")
    return {f"independent_base/{preset}": Job((*base, f"preset={preset}")) for preset in PRESETS}
