"""Which runs the thesis report needs: a name for each, and the overrides that make it."""

from collections.abc import Mapping

PRESETS = ("as_reported", "sound")
FIGURES = (
    "figure_3_5",
    "figure_3_6",
    "figure_3_8",
    "figure_3_9",
    "figure_3_10",
    "figure_4_2",
    "figure_4_3",
    "figure_4_4",
)
TRACKED = ("figure_3_9", "figure_3_10")
COMPARED = ("figure_3_5", "figure_3_9", "figure_3_10", "figure_4_2", "figure_4_4")
DURATIONS = (1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 8.0)  # s, t_f
TORQUE_DURATIONS = (2.0, 2.5, 3.0, 3.5, 3.86, 4.0, 5.0, 6.0, 8.0)  # s, t_f
LAG_DURATIONS = (1.0, 2.0, 3.0, 4.0, 6.0)  # s, t_f
STEPS = (1e-3, 5e-4, 2.5e-4, 1.25e-4)  # s, of PyBullet
SAMPLING = (0.5, 0.8, 0.95, 1.05)  # omega_n h on the Runge-Kutta plant
ARMS = ("macro", "mini")


def plan() -> dict[str, tuple[str, ...]]:
    """Return the overrides of every run by name, the longest runs first."""
    jobs: dict[str, tuple[str, ...]] = {}
    for figure in sorted(FIGURES, reverse=True):  # chapter 4 runs at 1 ms and takes longest
        for preset in PRESETS:
            jobs[f"{figure}/{preset}"] = (f"experiment=thesis/{figure}", f"preset={preset}")
    for figure in COMPARED:
        for preset in PRESETS:
            jobs[f"{figure}/{preset}/rk4"] = (*jobs[f"{figure}/{preset}"], "plant=rk4", "repetitions=1")
    for figure in TRACKED:
        for preset in PRESETS:
            for t_f in DURATIONS:
                jobs[f"{figure}/{preset}/{t_f}"] = (
                    *jobs[f"{figure}/{preset}"],
                    f"trajectory.duration={t_f}",
                    "repetitions=5",
                )
    for arm in ARMS:
        jobs[f"gravity_term/{arm}"] = ("experiment=thesis/gravity_term", f"robot={arm}")
        jobs[f"similarity/{arm}"] = ("experiment=thesis/similarity", f"robot={arm}")
        for t_f in LAG_DURATIONS:
            jobs[f"lag/{arm}/{t_f}"] = ("experiment=thesis/lag", f"robot={arm}", f"trajectory.duration={t_f}")
    jobs["base_axis"] = ("experiment=thesis/base_axis",)
    for t_f in TORQUE_DURATIONS:
        jobs[f"base_axis/{t_f}"] = (*jobs["base_axis"], "torque_limits=none", f"trajectory.duration={t_f}")
    jobs["plants/rk4"] = ("experiment=thesis/plants", "plant=rk4")
    for step in STEPS:
        jobs[f"plants/{step}"] = ("experiment=thesis/plants", f"plant.step={step}")
    for w in SAMPLING:
        jobs[f"sampling/{w}"] = ("experiment=thesis/sampling", f"controller.period={w / 30.0!r}")
    jobs["singular"] = ("experiment=thesis/singular",)
    return jobs


def command(overrides: Mapping[str, tuple[str, ...]], name: str) -> str:
    """Return the command that makes a run of the plan."""
    return " ".join(("runner", *overrides[name]))
