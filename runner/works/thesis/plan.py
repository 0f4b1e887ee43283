"""Which runs the thesis report needs: a name for each, and the overrides that make it."""

from runner.reporting.job import PRESETS, Job, Jobs
from runner.works.thesis.combined_plan import combined_jobs

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
COMBINED = (
    "figure_5_3",
    "figure_5_8",
    "figure_5_10",
    "figure_5_11",
    "figure_5_12",
    "figure_5_13",
    "macro_alone",
    "macro_alone_goal",
)
TRACKED = ("figure_3_9", "figure_3_10")
COMPARED = ("figure_3_5", "figure_3_9", "figure_3_10", "figure_4_2", "figure_4_4")
DURATIONS = (1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 8.0)  # s, t_f
TORQUE_DURATIONS = (2.0, 2.5, 3.0, 3.5, 3.86, 4.0, 5.0, 6.0, 8.0)  # s, t_f
LAG_DURATIONS = (1.0, 2.0, 3.0, 4.0, 6.0)  # s, t_f
STEPS = (1e-3, 5e-4, 2.5e-4, 1.25e-4)  # s, of PyBullet
SAMPLING = (0.5, 0.8, 0.95, 1.05)  # omega_n h on the Runge-Kutta plant
ARMS = ("macro", "mini")


def plan() -> Jobs:
    """Return every run by name."""
    jobs: Jobs = {}

    def add(name: str, *overrides: str) -> None:
        jobs[name] = Job(overrides)

    for figure in FIGURES:
        for preset in PRESETS:
            base = (f"experiment=thesis/{figure}", f"preset={preset}")
            add(f"{figure}/{preset}", *base)
            if figure in COMPARED:
                add(f"{figure}/{preset}/rk4", *base, "plant=rk4", "repetitions=1")
            for t_f in DURATIONS if figure in TRACKED else ():
                add(f"{figure}/{preset}/{t_f}", *base, f"trajectory.duration={t_f}", "repetitions=5")
    for name in COMBINED:
        for preset in PRESETS:
            base = (f"experiment=thesis/{name}", f"preset={preset}")
            add(f"{name}/{preset}", *base)
            if name in ("figure_5_8", "figure_5_10", "figure_5_12", "figure_5_13"):
                add(f"{name}/{preset}/rk4", *base, "plant=rk4", "repetitions=1")
    jobs |= combined_jobs()
    for arm in ARMS:
        add(f"gravity_term/{arm}", "experiment=thesis/gravity_term", f"robot={arm}")
        add(f"similarity/{arm}", "experiment=thesis/similarity", f"robot={arm}")
        for t_f in LAG_DURATIONS:
            add(f"lag/{arm}/{t_f}", "experiment=thesis/lag", f"robot={arm}", f"trajectory.duration={t_f}")
    add("base_axis", "experiment=thesis/base_axis")
    for t_f in TORQUE_DURATIONS:
        add(f"base_axis/{t_f}", "experiment=thesis/base_axis", "torque_limits=none", f"trajectory.duration={t_f}")
    add("plants/rk4", "experiment=thesis/plants", "plant=rk4")
    for step in STEPS:
        add(f"plants/{step}", "experiment=thesis/plants", f"plant.step={step}")
    for w in SAMPLING:
        add(f"sampling/{w}", "experiment=thesis/sampling", f"controller.period={w / 30.0:.6g}")
    add("singular", "experiment=thesis/singular")
    return jobs
