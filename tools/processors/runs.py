"""The table of runs that are made under each processor: three engines, three arms, eleven kinds; and a few others."""

from collections.abc import Mapping

ENGINES = ("bullet", "mujoco", "rk4")

_ARMS: Mapping[str, tuple[str, ...]] = {
    "macro": ("robot=macro", "trajectory=quintic"),
    "combined": ("robot=combined", "trajectory=quintic"),
    "panda": ("robot=panda", "trajectory=quintic"),
}
_SEEDS = "repetitions=3"
_KINDS: Mapping[str, tuple[str, ...]] = {
    "quiet": ("duration=2",),
    "noise": ("duration=2", "noise=thesis", "mismatch=sampled", _SEEDS),
    "saturated": ("duration=2", "trajectory.duration=0.8", "torque_limits.max=30"),
    "wall": ("duration=2", "controller=impedance", "environment=wall"),
    "fall": ("duration=5", "controller=held_torques", "controller.torques=0"),
    "limit_cycle": ("duration=6", "torque_limits.max=40", "noise=thesis"),
    "encoder": ("duration=2", "noise.resolution=1e-4", "noise.velocity=finite_difference"),
    "dry_friction": ("duration=2", "plant.friction.coulomb=0.5"),
    "sliding_mode": ("duration=2", "controller=sliding_mode"),
    "circle": ("duration=2", "trajectory=circle"),
    "push": ("duration=2", "environment=push"),
}
_OF_ONE_ARM: Mapping[tuple[str, str], tuple[str, ...]] = {
    ("macro", "limit_cycle"): ("controller.period=0.04",),
    ("panda", "limit_cycle"): ("controller.period=0.04", "torque_limits.max=12"),
    ("panda", "wall"): ("robot.armature=0",),  # PyBullet's contacts know none
    ("combined", "saturated"): ("torque_limits.max={macro:30,mini:3}",),
    ("combined", "limit_cycle"): ("controller.period={macro:0.04,mini:0.004}", "torque_limits.max={macro:40,mini:1}"),
    ("combined", "encoder"): ("noise.resolution={macro:1e-4,mini:1e-4}",),
}
_OTHERS: Mapping[str, tuple[str, ...]] = {
    "bullet/xarm7/servo": ("robot=xarm7", "plant=bullet", "controller=differential_inverse_kinematics", "duration=1"),
    "mujoco/xarm7/servo": ("robot=xarm7", "plant=mujoco", "controller=differential_inverse_kinematics", "duration=1"),
    "bullet/meca500/admittance": ("robot=meca500", "plant=bullet", "environment=wall", "duration=1"),
    "rk4/panda/joint_torques": ("robot=panda", "plant=rk4", "controller=hybrid_force", "joint_torque_sensor=ideal",
                                "controller.force_source=joint_torque", "environment=wall", "duration=1"),
    "rk4/panda/sinusoids": ("robot=panda", "plant=rk4", "trajectory=joint_sinusoids", "duration=2"),
    "rk4/planar/adaptive": ("robot=planar", "plant=rk4", "controller=adaptive", "duration=2"),
}  # fmt: skip
_WITHOUT = {("combined", "fall"), ("combined", "sliding_mode"), ("combined", "wall")}  # laws of one stage


def matrix() -> dict[str, tuple[str, ...]]:
    """Return the overrides of each run by its name, ENGINE/ARM/KIND."""
    return {
        f"{engine}/{arm}/{kind}": _overrides(engine, arm, kind)
        for engine in ENGINES
        for arm in _ARMS
        for kind in _KINDS
        if (arm, kind) not in _WITHOUT
    } | dict(_OTHERS)


def _overrides(engine: str, arm: str, kind: str) -> tuple[str, ...]:
    words = (*_ARMS[arm], f"plant={engine}", *_KINDS[kind], *_OF_ONE_ARM.get((arm, kind), ()))
    return tuple({word.partition("=")[0]: word for word in words}.values())  # the last one of a key counts
