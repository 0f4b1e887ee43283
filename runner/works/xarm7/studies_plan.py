"""The runs behind why the xArm7 report's second part failed, and what its seven joints can do."""

from runner.reporting.job import PRESETS, Job, Jobs

TASKS = ("position", "pose")
# The report's errors, each of which can be put right: which of them a case keeps.
ERRORS = {
    "as printed": ("columns", "angles", "inverse"),
    "inverse alone": ("inverse",),
    "columns and angles": ("columns", "angles"),
    "columns alone": ("columns",),
    "angles alone": ("angles",),
    "none": (),
}
GAIN = 20.0  # 1/s, of the tip's error, where it is fed back
RULES = ("euler", "midpoint", "rk4")
SPEEDS = (0.1, 0.3, 1.0)  # rad/s, of the null-space motion
FASTEST_RATE = 250  # Hz, the most that the maker allows
NULL_SPACE_TASKS = ("none", "posture", "joint_limits", "manipulability")
PATHS = ("line", "circle")
CYCLES = 5
CYCLE = 4.0  # s
SOUGHT = ("posture", "manipulability")
CLIMB_CYCLES = 3  # of the line with either
CLIMB_CYCLE = 5.0  # s
RATES = (25, 50, 100, 250)  # Hz
PLANTS = ("kinematic", "bullet")
STIFFNESSES = (300.0, 1500.0, 7500.0)  # N m/rad
GRAVITY_COMPENSATION = ("true", "false")
FEEDBACKS = ("measured", "commanded")
XS = (0.643, 0.6043)  # m, as printed, and of the round posture
ASKED_PAYLOADS = (0.0, 5.0)  # kg, on joints that go where they are told
PAYLOADS = (0.0, 3.0, 3.5, 5.0)  # kg
LAWS = ("operational_space", "computed_torque")
TORQUE_PAYLOADS = (0.0, 3.0, 3.05, 3.1, 3.5)  # kg
_ROBOT = "robot=xarm7"
_SERVO = ("plant=bullet", "plant.step=0.001")
_HALF = "duration=5"  # s, half a period: from A to B
_ELBOW_ASIDE = "controller.null_space.posture=[0.8,0.75,-0.8,1.5,0.5,0.75,1]"  # rad
_MIDDLE = "[0.643,0,0.1508]"  # m, half way between A and B


def studies_jobs() -> Jobs:
    """Return every run by name."""
    return {
        **_printed(),
        **_null_space(),
        **_cycles(),
        **_rates(),
        **_stiffness(),
        **_payload(),
        **_torque(),
    }


def _printed() -> Jobs:
    jobs: Jobs = {}
    for task in TASKS:
        for case, errors in ERRORS.items():
            law = (_ROBOT, "controller=xarm7_as_printed", f"controller.task={task}", "controller.feedforward=true")
            values = [f"controller.{key}={'printed' if key in errors else 'right'}" for key in ERRORS["as printed"]]
            jobs[f"printed/{task}/{case}"] = Job((*law, *values))
            if "inverse" not in errors:
                jobs[f"printed/{task}/{case}/fed back"] = Job((*law, *values, f"controller.gain={GAIN:g}"))
        jobs[f"printed/{task}/working"] = Job((_ROBOT, f"controller.task={task}"))
    return jobs


def _null_space() -> Jobs:
    jobs: Jobs = {}
    standing = (
        _ROBOT,
        "trajectory=goal",
        f"trajectory.start={_MIDDLE}",
        f"trajectory.goal={_MIDDLE}",
        "controller.null_space.gain=20",
        _ELBOW_ASIDE,
        "duration=2",
    )
    for rule in RULES:
        for speed in SPEEDS:
            own = (f"controller.integration={rule}", f"controller.null_space.max_speed={speed:g}")
            jobs[f"null_space/{rule}/{speed}"] = Job((*standing, *own))
    fastest = (*standing, "controller.integration=rk4", f"controller.null_space.max_speed={SPEEDS[-1]:g}")
    jobs["null_space/fastest rate"] = Job((*fastest, f"controller.period={1.0 / FASTEST_RATE:g}"))
    jobs["null_space/servo"] = Job((*fastest, *_SERVO))
    return jobs


def _cycles() -> Jobs:
    jobs: Jobs = {}
    paths = {"line": ("trajectory=line",), "circle": ("trajectory=circle", "trajectory.easing=none")}
    for path, overrides in paths.items():
        for task in NULL_SPACE_TASKS:
            own = (f"controller.null_space.task={task}", "controller.null_space.gain=5")
            times = (f"trajectory.duration={CYCLE:g}", f"duration={CYCLES * CYCLE:g}")
            jobs[f"cycles/{path}/{task}"] = Job((_ROBOT, *overrides, *own, *times))
    climb = (f"trajectory.duration={CLIMB_CYCLE:g}", f"duration={CLIMB_CYCLES * CLIMB_CYCLE:g}")
    for task in TASKS:
        for sought in SOUGHT:
            law = (f"controller.task={task}", f"controller.null_space.task={sought}", "controller.null_space.gain=20")
            jobs[f"climb/{task}/{sought}"] = Job((_ROBOT, *law, *climb))
    return jobs


def _rates() -> Jobs:
    plants = {"kinematic": ((), 12), "bullet": (_SERVO, 3)}
    return {
        f"rates/{plant}/{preset}/{rate}": Job(
            (_ROBOT, *overrides, f"preset={preset}", f"controller.period={1.0 / rate:g}", _HALF),
        )
        for plant, (overrides, cost) in plants.items()
        for preset in PRESETS
        for rate in RATES
    }


def _stiffness() -> Jobs:
    return {
        f"stiffness/{stiffness:g}/{compensation}/{feedback}": Job(
            (
                _ROBOT,
                *_SERVO,
                f"plant.servo.stiffness={stiffness:g}",
                f"plant.servo.gravity_compensation={compensation}",
                f"controller.feedback={feedback}",
                "trajectory.duration=5",
                "duration=2.5",
            ),
        )
        for stiffness in STIFFNESSES
        for compensation in GRAVITY_COMPENSATION
        for feedback in FEEDBACKS
    }


def _payload() -> Jobs:
    jobs: Jobs = {}
    for x in XS:
        line = (_ROBOT, f"robot.start=[{x},-0.2,0.1508]", f"robot.goal=[{x},0.2,0.1508]", _HALF)
        for mass in ASKED_PAYLOADS:
            jobs[f"payload/{x}/asked/{mass:g}"] = Job((*line, f"robot.payload.mass={mass:g}"))
        for mass in PAYLOADS:
            jobs[f"payload/{x}/{mass:g}"] = Job((*line, *_SERVO, f"robot.payload.mass={mass:g}"))
    return jobs


def _torque() -> Jobs:
    jobs: Jobs = {}
    for law in LAWS:
        base = (_ROBOT, f"controller={law}", "plant=bullet")
        for mass in TORQUE_PAYLOADS:
            jobs[f"torque/{law}/{mass:g}"] = Job((*base, f"robot.payload.mass={mass:g}"))
        jobs[f"torque/{law}/pose"] = Job((*base, "controller.task=pose"))
    return jobs
