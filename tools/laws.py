"""The built-in control laws by their properties, with overrides of a run of each: for tests, tables and timings.

Each list of laws is a choice from LAWS by a property, so that a new law of the registry is in all lists that it fits.
"""

from dataclasses import dataclass
from typing import Any, get_args

import yaml

from runner.base.paths import conf_dir
from runner.controllers import CONTROLLERS
from runner.controllers.joint_space.joint_law import JointLawConfig


@dataclass(frozen=True)
class Law:
    """A built-in control law.

    Attributes:
        name: Its kind.
        keys: Keys of its config.
        follows_joints: True if it follows a desired joint motion.
        takes_drawn: True if it takes nominal models that are drawn as arrays.
        commands_torques: True if it commands torques; False if joint positions.
    """

    name: str
    keys: frozenset[str]
    follows_joints: bool
    takes_drawn: bool
    commands_torques: bool

    @property
    def periodic(self) -> bool:
        """True if it needs a motion that repeats."""
        return "repeats_every" in self.keys

    @property
    def flexible(self) -> bool:
        """True if it needs flexible joints."""
        return "joint_stiffness" in self.keys

    @property
    def in_stages(self) -> bool:
        """True if it needs an arm mounted on another one."""
        return "macro_target" in self.keys

    @property
    def moves_the_whole_arm(self) -> bool:
        """True if it moves all joints of any arm along the desired motion, those of the null space to a posture."""
        return "null_space_frequency" in self.keys and "actuated_stages" not in self.keys

    @property
    def overrides(self) -> tuple[str, ...]:
        """Overrides of a run, without its plant."""
        robot = "combined" if self.in_stages else "macro" if self.commands_torques else "xarm7"
        motion = ("trajectory=circle", "trajectory.easing=none", "duration=14") if self.periodic else ()
        joints = ("plant.flexible_joints.static_deflection=unknown",) if self.flexible else ()
        return (f"robot={robot}", f"controller={self.name}", *motion, *joints)

    def plant(self, engine: str) -> str:
        """Return the plant of an engine, such as "rk4", that the law needs."""
        return f"{engine}_flexible" if self.flexible else engine


def _laws() -> dict[str, Law]:
    found = {}
    for name in CONTROLLERS.names():
        if CONTROLLERS.module(name).__name__.startswith("runner.controllers."):
            features = CONTROLLERS.features(name)
            keys = frozenset(CONTROLLERS.config_model(name).model_fields)
            torques = features.COMMANDS == "torque"
            found[name] = Law(name, keys, features.FOLLOWS_JOINTS, features.TAKES_DRAWN, torques)
    return found


LAWS = _laws()
"""All built-in laws, by name."""
ARM_LAWS = tuple(
    sorted(
        (law.name for law in LAWS.values() if law.moves_the_whole_arm and not (law.periodic or law.flexible)),
        key=lambda name: (LAWS[name].follows_joints, name),
    )
)
"""Laws of any arm with rigid joints and of any motion: first those that lead the tip, then those of the joints."""
JOINT_LAWS = tuple(name for name in ARM_LAWS if LAWS[name].follows_joints)
"""Those of them that follow a joint motion."""


def own_options(law: str) -> list[str]:
    """Return overrides of the keys that a law of JOINT_LAWS has and the others lack, away from their defaults."""
    defaults = yaml.safe_load((conf_dir() / "controller" / f"{law}.yaml").read_text(encoding="utf-8"))
    fields = CONTROLLERS.config_model(law).model_fields
    own = [key for key in fields if key not in JointLawConfig.model_fields and key != "kind"]
    return [f"{key}={_other(defaults[key], fields[key].annotation)}" for key in own]


def _other(value: Any, annotation: Any) -> str:
    """Return another value of a key: the other word, truth value, or twice the number."""
    if isinstance(value, str):
        return next(str(word) for word in get_args(annotation) if word != value)
    return str(not value).lower() if isinstance(value, bool) else str(2.0 * value or 1.0)
