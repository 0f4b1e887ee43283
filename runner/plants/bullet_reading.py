"""How PyBullet reads a URDF file when nothing is said to it, against what the file says."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from runner.engine_output import caught_output, quiet_stderr
from runner.errors import ConfigError

with quiet_stderr():  # PyBullet announces its build time
    import pybullet


@dataclass(frozen=True)
class LinkReading:
    """One link in PyBullet.

    Attributes:
        mass: In kg.
        moments: Principal moments of inertia, in kg m^2, ascending.
    """

    mass: float
    moments: tuple[float, ...]


@dataclass(frozen=True)
class BulletReading:
    """An arm in PyBullet.

    Attributes:
        joints: Names of the joints that move, in PyBullet's order.
        links: Links by name, the base left out.
        said: What PyBullet printed while it loaded the file.
    """

    joints: tuple[str, ...]
    links: Mapping[str, LinkReading]
    said: tuple[str, ...]


def words(said: Sequence[str]) -> list[str]:
    """Return what PyBullet printed without the places in its own source."""
    parts = re.split(r"b3\w+\[[^\]]*\]:", " ".join(said))
    return list(dict.fromkeys(part.strip() for part in parts if part.strip()))


def read_as_bullet(urdf: Path, inertia_from_file: bool) -> BulletReading:
    """Return a URDF as PyBullet makes an arm of it.

    Args:
        urdf: The file; its meshes are read.
        inertia_from_file: Whether PyBullet is told to take the file's inertia. It makes one from the shapes if not.

    Raises:
        ConfigError: if PyBullet cannot load it.
    """
    client = pybullet.connect(pybullet.DIRECT)
    try:
        with caught_output(1) as said:
            flags = pybullet.URDF_USE_INERTIA_FROM_FILE if inertia_from_file else 0
            body = pybullet.loadURDF(str(urdf), useFixedBase=True, flags=flags, physicsClientId=client)
        joints, links = [], {}
        for joint in range(pybullet.getNumJoints(body, physicsClientId=client)):
            info = pybullet.getJointInfo(body, joint, physicsClientId=client)
            values = pybullet.getDynamicsInfo(body, joint, physicsClientId=client)
            links[info[12].decode()] = LinkReading(values[0], tuple(sorted(values[2])))
            joints += [] if info[2] == pybullet.JOINT_FIXED else [info[1].decode()]
        return BulletReading(tuple(joints), links, tuple(words(said)))
    except pybullet.error as error:
        raise ConfigError([f"robot.urdf: PyBullet cannot load {urdf}: {error}"]) from error
    finally:
        pybullet.disconnect(client)
