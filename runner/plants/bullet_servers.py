"""PyBullet physics servers: ownership, and reuse by the next plant of the same arm."""

import re
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass

from runner.base.engine_output import caught_output
from runner.base.errors import ConfigError
from runner.base.lazy_modules import pybullet
from runner.plants.bullet_links import bullet_text

_KEPT = 4
_MOST_JOINTS = 127


@dataclass(frozen=True, eq=False)
class Server:
    """A physics server with one arm in it.

    Attributes:
        client: Index of the server in PyBullet.
        body: Index of the arm in PyBullet.
        urdf: URDF of the arm, as a string.
        used: True if an earlier plant has used the server.
    """

    client: int
    body: int
    urdf: str
    used: bool


class PhysicsServers:
    """The owner of all physics servers of a process.

    Starting a server takes 15 ms of CPU time, and loading an arm 3 ms. A few idle servers are therefore kept for later
    plants.

    Attributes:
        lent: Servers in use by plants.
    """

    def __init__(self) -> None:
        self.lent: list[Server] = []
        self._idle: dict[str, Server] = {}

    def open(self, urdf: str) -> Server:
        """Return a server that contains only an arm: a new one, or a used one in the state that its last plant left.

        Args:
            urdf: URDF of the arm, as a string.

        Raises:
            ConfigError: if PyBullet cannot load the URDF, or prints anything while loading it.
        """
        server = self._idle.pop(urdf, None) or self._load(urdf)
        self.lent.append(server)
        return server

    def give_back(self, server: Server, reusable: bool) -> None:
        """Take a server back from its plant.

        Args:
            server: The server.
            reusable: True if another plant of the same arm can use the server; otherwise it is closed.
        """
        if server not in self.lent:
            return
        self.lent.remove(server)
        if reusable and server.urdf not in self._idle and len(self._idle) < _KEPT:
            self._idle[server.urdf] = Server(server.client, server.body, server.urdf, used=True)
        else:
            pybullet.disconnect(server.client)

    def close(self) -> None:
        """Close the servers that are not in use."""
        while self._idle:
            pybullet.disconnect(self._idle.popitem()[1].client)

    def _load(self, urdf: str) -> Server:
        client = self._empty()
        said: list[str] = []
        # Bullet caches URDFs by file name within a process, so each arm gets a separate file name.
        with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
            file.write(bullet_text(urdf))
            file.flush()
            flags = pybullet.URDF_USE_INERTIA_FROM_FILE | pybullet.URDF_USE_SELF_COLLISION_EXCLUDE_ALL_PARENTS
            try:
                with caught_output(1) as said:
                    body = pybullet.loadURDF(file.name, useFixedBase=True, flags=flags, physicsClientId=client)
                joints = pybullet.getNumJoints(body, physicsClientId=client)
                if joints > _MOST_JOINTS:
                    said.append(f"it has {joints} joints, fixed ones included; PyBullet takes up to {_MOST_JOINTS}")
            except pybullet.error as error:
                said.insert(0, str(error))
        if said:
            pybullet.disconnect(client)
            raise ConfigError(f"robot.urdf: PyBullet does not accept it: {'; '.join(_words(said))}")
        return Server(client, body, urdf, used=False)

    def _empty(self) -> int:
        """Return an empty server: a new one, or the longest idle one after a reset if the pool is full."""
        if len(self._idle) < _KEPT:
            return int(pybullet.connect(pybullet.DIRECT))
        client = self._idle.pop(next(iter(self._idle))).client
        pybullet.resetSimulation(physicsClientId=client)
        return client


SERVERS = PhysicsServers()
"""The physics servers of this process; they end with it."""


def _words(said: Sequence[str]) -> list[str]:
    """Return the messages that PyBullet printed, without the positions in its source."""
    parts = re.split(r"b3\w+\[[^\]]*\]:", " ".join(said))
    return list(dict.fromkeys(part.strip() for part in parts if part.strip()))
