"""The arms and torque laws whose ticks are measured, with noise and torque limits."""

from dataclasses import dataclass

from runner.assembly.assemble import assemble
from runner.assembly.closed_loop import ClosedLoop
from runner.assembly.run_config import RunConfig
from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from tools.laws import ARM_LAWS, LAWS

_SCENE = ("trajectory=quintic", "noise=thesis", "torque_limits=thesis")
# A robot in stages has a natural frequency for each; computed_torque takes one number for all joints.
_ONE_FOR_ALL = ("controller.natural_frequency=30", "controller.damping_ratio=1", "controller.null_space_frequency=30")


@dataclass(frozen=True)
class Arm:
    """An arm with the laws that it takes.

    Attributes:
        name: What the table calls it.
        scene: Overrides of its runs.
        tick: Time between two ticks, in s.
        laws: Overrides by the law's name; the first leads the tip in operational space, like L and the peers.
        substeps: Of PyBullet in a tick.
        most_bullet: Most that bullet may take, in F, one for each of `substeps`.
        most_rk4: Most that one run on rk4 may take, in L.
        compiles: Longest time to compile a law, in s.
    """

    name: str
    scene: tuple[str, ...]
    tick: float
    laws: dict[str, tuple[str, ...]]
    substeps: tuple[int, ...]
    most_bullet: tuple[float, ...]
    most_rk4: float
    compiles: float


def _laws(
    period: float, *names: str, one_for_all: tuple[str, ...] = (), armature: str | None = None
) -> dict[str, tuple[str, ...]]:
    """Return the overrides of laws at a period; `armature` is for gains of diag M, under which light joints chatter."""
    found = {name: (f"controller={name}", f"controller.period={period}") for name in names}
    more = one_for_all if armature is None else (*one_for_all, armature)
    return {name: (*law, *more) if LAWS[name].follows_joints else law for name, law in found.items()}


_COUPLINGS = {
    f"macro_mini {coupling}": ("controller=macro_mini", f"controller.coupling={coupling}")
    for coupling in ("one_way", "two_way")
}
ARMS = (
    Arm(
        "3 joints",
        ("robot=macro", "trajectory.duration=19"),
        0.01,
        _laws(0.01, *ARM_LAWS),
        (10, 1),
        (1.3, 2.0),
        1.6,
        0.5,
    ),
    Arm(
        "6 joints",
        # A goal near by, so that no torque limit is reached and the tip follows the path whatever the null space does.
        ("robot=combined", "trajectory.duration=1", "trajectory.goal=[0.05,0.95,1.05]"),
        0.001,
        {**_laws(0.001, "whole_body", "computed_torque", one_for_all=_ONE_FOR_ALL), **_COUPLINGS},
        (1,),
        (2.0,),
        1.3,
        4.0,
    ),
    Arm(
        "7 joints",
        ("robot=xarm7", "trajectory.duration=19"),
        0.01,
        _laws(0.01, *ARM_LAWS, armature="robot.armature=assumed"),
        (1,),
        (2.0,),
        1.3,
        4.0,
    ),
)


def assembled(arm: Arm, law: str, plant: str, substeps: int, ticks: int, *more: str) -> tuple[RunConfig, ClosedLoop]:
    """Return the closed loop of an arm under a law, and its config.

    Args:
        arm: The arm.
        law: One of its laws.
        plant: "bullet", "mujoco" or "rk4".
        substeps: Integration steps in a tick.
        ticks: Number of ticks.
        more: Further overrides.
    """
    timing = (f"plant={plant}", f"plant.step={arm.tick / substeps:.12g}", f"duration={ticks * arm.tick:.12g}")
    config = validate(compose([*_SCENE, *arm.scene, *arm.laws[law], *timing, *more]))
    loop = assemble(config)
    assert loop.ticks == ticks, f"{arm.name}: {loop.ticks} ticks"
    return config, loop
