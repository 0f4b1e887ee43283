"""A physics server that another run has used gives what a fresh one gives, bit for bit; none is lost."""

import subprocess
import sys

import numpy as np
import pytest

from runner.assembly.assemble import assemble
from runner.base.errors import ConfigError
from runner.plants import decoupled

pybullet = pytest.importorskip("pybullet", reason="PyBullet is not installed")

from runner.plants import bullet  # noqa: E402
from runner.plants.bullet_servers import SERVERS, PhysicsServers  # noqa: E402

RUN = """
from runner.config.compose.compose import compose
from runner.assembly.validation import validate
from runner.assembly.assemble import assemble
from runner.simulation.sensors import make_encoders
from runner.simulation.loop import simulate
config = validate(compose(["robot=macro", "noise=thesis", "torque_limits=thesis", "duration=0.5"]))
loop = assemble(config)
print(simulate(loop, make_encoders(loop, config.noise, config.settings.seed, 0)).q[-1].tobytes().hex())
"""


@pytest.mark.costs(2)
def test_a_used_server_gives_what_a_fresh_one_gives(simulated):
    fresh = subprocess.run([sys.executable, "-c", RUN], capture_output=True, text=True, check=True).stdout.strip()
    for other in ("robot=mini", "robot=combined", "robot=macro"):
        simulated(other, "duration=0.1", "gravity=3.7", "plant.step=0.00025")
        trace = simulated("robot=macro", "noise=thesis", "torque_limits=thesis", "duration=0.5")
        assert trace.q[-1].tobytes().hex() == fresh


def connected():
    """Return the number of physics servers of this process."""
    return sum(pybullet.isConnected(client) for client in range(1000))


@pytest.fixture
def servers_before():
    """Close all idle servers; a test ends with the lent and connected servers of its start."""
    SERVERS.close()
    before = list(SERVERS.lent), connected()
    yield before[1]
    SERVERS.close()
    assert (SERVERS.lent, connected()) == before


def test_servers_are_lent_and_given_back(servers_before, macro_urdf):
    servers = PhysicsServers()
    first, second = servers.open(macro_urdf), servers.open(macro_urdf)
    assert (len(servers.lent), connected()) == (2, servers_before + 2)
    servers.give_back(first, reusable=True)
    servers.give_back(first, reusable=True)  # again does no harm
    servers.give_back(second, reusable=True)  # one of an arm is enough
    assert (servers.lent, connected()) == ([], servers_before + 1)
    again = servers.open(macro_urdf)
    assert (again.client, again.body, again.used) == (first.client, first.body, True)
    servers.give_back(first, reusable=False)  # it is another plant's by now
    assert pybullet.isConnected(again.client)
    servers.give_back(again, reusable=False)
    assert connected() == servers_before


def test_few_are_kept(servers_before, macro_urdf):
    servers = PhysicsServers()
    lent = [servers.open(macro_urdf.replace('name="', f'name="{number}', 1)) for number in range(7)]
    for server in lent:
        servers.give_back(server, reusable=True)
    assert connected() == servers_before + 4
    servers.close()
    assert connected() == servers_before


def test_a_urdf_that_bullet_refuses_leaves_none(servers_before, macro_urdf):
    with pytest.raises(ConfigError, match="PyBullet does not accept it"):
        SERVERS.open(macro_urdf.replace("<mass", "<mess"))
    assert connected() == servers_before


def test_a_plant_that_raises_while_it_is_set_up_leaves_none(servers_before, monkeypatch, checked_config):
    def broken(*_):
        raise RuntimeError("no sensor")

    monkeypatch.setattr(bullet, "find_step", lambda *_: None)
    monkeypatch.setattr(bullet.Bullet, "_enable_tool_sensor", broken)
    with pytest.raises(RuntimeError, match="no sensor"):
        assemble(checked_config("robot=macro"))


@pytest.mark.parametrize(
    ("overrides", "part"),
    [
        (("robot=meca500", "plant=bullet"), "runner.assembly.assemble.JointServo"),
        (("robot=meca500", "plant=bullet"), "runner.assembly.assemble.Interaction"),
        (("robot=macro", "plant.friction.coulomb=1"), "runner.plants.friction.Frictional"),
        (("robot=combined", "plant.dynamics=decoupled"), "runner.plants.decoupled.StageBase"),
    ],
)
def test_what_raises_around_a_plant_leaves_none(servers_before, monkeypatch, checked_config, overrides, part):
    config = checked_config(*overrides)

    def broken(*_):
        raise RuntimeError("a part broke")

    monkeypatch.setattr(part, broken)
    with pytest.raises(RuntimeError, match="a part broke"):
        assemble(config)


def test_a_second_stage_that_raises_leaves_none(servers_before, monkeypatch, checked_config):
    config = checked_config("robot=combined", "plant.dynamics=decoupled")
    with_friction, made = decoupled.with_friction, []

    def breaks_on_the_second(*args):
        made.append(args)
        if len(made) == 2:
            args[0].close()
            raise RuntimeError("a part broke")
        return with_friction(*args)

    monkeypatch.setattr(decoupled, "with_friction", breaks_on_the_second)
    with pytest.raises(RuntimeError, match="a part broke"):
        assemble(config)
    assert len(made) == 2


def test_a_run_that_fails_leaves_none(servers_before, simulated):
    trace = simulated("robot=macro", "controller.natural_frequency=1e9", "trajectory=quintic", "duration=0.2")
    assert trace.failure is not None
    assert not np.isfinite(trace.q[-1]).all() or np.abs(trace.dq[-1]).max() > 1e5
