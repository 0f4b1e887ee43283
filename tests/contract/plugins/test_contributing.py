"""Robots and parts that a user adds from outside the package, as the pages on additions describe them."""

import sys
from xml.etree import ElementTree

import numpy as np
import pytest
import yaml
from support.pages import ROOT

import runner
from runner.base.errors import ConfigError
from runner.reporting.mathml import faulty
from runner.reporting.run_report import run_document

ROBOT_YAML = """\
# @package _global_
# A crane: joints z, x, x, and one more link than it looks
defaults:
  - override /controller: operational_space
  - override /trajectory: goal

robot:
  name: crane
  urdf: crane.urdf
  tip: hook
  home: [0.0, 0.3, -1.2]
  inertials: null
  masses: {jib: 12.0}
  armature: 0.0
  velocity_limits: {}
  start: null
  goal: [0.4, 1.1, 0.9]
  path_size: 0.1
  tool: null
  payload: {mass: 0.0, position: [0.0, 0.0, 0.0]}
  rated_payload: null
  natural_frequency: 10.0
  damping_ratio: 1.0
  period: 0.02
  joint_error_limit: 1.0e-4
  no_joint_error: 0.0
  torque_limit: [300.0, 400.0, 200.0]
  settling_band: 0.01
"""


def link(name: str, mass: float, length: float) -> str:
    across, along = mass * length**2 / 12, mass / 1000
    return (
        f'<link name="{name}"><inertial><origin xyz="0 0 {length / 2}"/><mass value="{mass}"/>'
        f'<inertia ixx="{across}" ixy="0" ixz="0" iyy="{across}" iyz="0" izz="{along}"/>'
        "</inertial></link>"
    )


def joint(name: str, parent: str, child: str, axis: str, height: float) -> str:
    return (
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0 0 {height}"/><axis xyz="{axis}"/>'
        '<limit lower="-10" upper="10" effort="1000" velocity="100"/></joint>'
    )


URDF = "\n".join(
    [
        '<robot name="crane">',
        link("base", 0.0, 0.0),
        link("mast", 20.0, 0.5),
        link("jib", 10.0, 1.0),
        link("arm", 5.0, 0.8),
        link("hook", 0.0, 0.0),
        joint("slew", "base", "mast", "0 0 1", 0.0),
        joint("luff", "mast", "jib", "1 0 0", 0.5),
        joint("fold", "jib", "arm", "1 0 0", 1.0),
        '<joint name="mount" type="fixed"><parent link="arm"/><child link="hook"/><origin xyz="0 0 0.8"/></joint>',
        "</robot>",
    ]
)

CONTROLLER = '''\
"""Jacobian-transpose control of the tip."""

from typing import Literal

import numpy as np
from pydantic import PositiveFloat

from runner.controllers import Loop
from runner.plugins.registry import StrictModel


class JacobianTransposeConfig(StrictModel):
    kind: Literal["jacobian_transpose"]
    period: PositiveFloat
    stiffness: PositiveFloat
    damping: PositiveFloat


class JacobianTranspose:
    def __init__(self, model, stiffness, damping):
        self._model, self._stiffness, self._damping = model, stiffness, damping

    def reset(self):
        pass

    def torque(self, time, q, dq, reference):
        pull = self._stiffness * (reference[0] - self._model.tip_position(q))
        J = self._model.tip_jacobian(q)[:3]
        return J.T @ pull - self._damping * dq + self._model.gravity_torque(q)


CONFIG = JacobianTransposeConfig


def build(config, robot):
    controller = JacobianTranspose(robot.model, config.stiffness, config.damping)
    return (Loop(robot.stages[-1].name, slice(0, robot.model.nq), config.period, controller),)
'''

TRAJECTORY = '''\
"""A level circle through the start, round and round."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import Field, PositiveFloat

from runner.plugins.registry import StrictModel


class SpinConfig(StrictModel):
    kind: Literal["spin"]
    start: list[float] | None = Field(min_length=3, max_length=3)
    radius: PositiveFloat
    duration: PositiveFloat


@dataclass(frozen=True)
class Spin:
    start: np.ndarray
    radius: float
    duration: float
    goal: None = None
    tracked: bool = True

    @property
    def run_duration(self):
        return self.duration

    def sample(self, times):
        rate = 2.0 * np.pi / self.duration
        c, s, zero = np.cos(rate * times), np.sin(rate * times), np.zeros_like(times)
        motion = np.empty((len(times), 3, 3))
        motion[:, 0] = self.start + self.radius * np.stack([s, c - 1.0, zero], axis=1)
        motion[:, 1] = self.radius * rate * np.stack([c, -s, zero], axis=1)
        motion[:, 2] = self.radius * rate**2 * np.stack([-s, -c, zero], axis=1)
        return motion

    def distance_to_path(self, points):
        offset = points - self.start + np.array([0.0, self.radius, 0.0])
        return np.hypot(np.hypot(offset[:, 0], offset[:, 1]) - self.radius, offset[:, 2])


CONFIG = SpinConfig


def build(config, start):
    return Spin(start, config.radius, config.duration)
'''

PLANT = '''\
"""Semi-implicit Euler on Pinocchio."""

from typing import Literal

import numpy as np
from pydantic import PositiveFloat

from runner.plugins.registry import StrictModel


class EulerConfig(StrictModel):
    kind: Literal["euler"]
    step: PositiveFloat | None


class Euler:
    def __init__(self, model, step, steps_per_tick):
        self._model, self._step, self._steps = model, step, steps_per_tick
        self.q, self.dq = np.zeros(model.nq), np.zeros(model.nq)

    def reset(self, q, dq):
        self.q[:], self.dq[:] = q, dq

    def set_gravity(self, gravity):
        raise NotImplementedError

    def advance(self, tau):
        for _ in range(self._steps):
            self.dq += self._step * self._model.forward_dynamics(self.q, self.dq, tau)
            self.q += self._step * self.dq

    def close(self):
        pass


CONFIG = EulerConfig


def build(config, robot, step, steps_per_tick):
    return Euler(robot.model, step, steps_per_tick)


def default_step(tick, stages):
    return tick / 20.0
'''

METRIC = '''\
"""How long the way of the tip is."""

import numpy as np

UNITS = {"path_length": "m"}


def evaluate(trace, context):
    """Return the way of the tip.

    - path_length: the tip's way, summed over the ticks.
    """
    return {"path_length": float(np.linalg.norm(np.diff(trace.tip, axis=0), axis=1).sum())}
'''

WATER = '''\
"""Water: a force against the tip's velocity, and lift."""

from typing import Literal

import numpy as np
from pydantic import NonNegativeFloat

from runner.plugins.registry import StrictModel


class WaterConfig(StrictModel):
    """Config of water.

    Attributes:
        kind: Name of the kind in the registry.
        drag: Force on the tip per speed, in N s/m.
        lift: Force on the tip upwards, in N.
    """

    kind: Literal["water"]
    drag: NonNegativeFloat
    lift: NonNegativeFloat


class Water:
    def __init__(self, config):
        self.drag, self.lift = config.drag, np.array([0.0, 0.0, config.lift])

    def reset(self, tip):
        pass

    def wrench(self, time, tip, velocity):
        return np.concatenate([self.lift - self.drag * velocity, np.zeros(3)])


CONFIG = WaterConfig


def build(config):
    return Water(config)
'''

ENTRY_POINTS = """\
[runner.controller]
jacobian_transpose = workshop.jacobian_transpose
[runner.trajectory]
spin = workshop.spin
[runner.plant]
euler = workshop.euler
[runner.metric]
path_length = workshop.path_length
"""

GROUPS = {
    "controller/jacobian_transpose": (
        "kind: jacobian_transpose\nperiod: ${robot.period}\nstiffness: 400.0\ndamping: 8.0\n"
    ),
    "trajectory/spin": "# Round and round\nkind: spin\nstart: [0.0, 1.0, 1.0]\nradius: 0.3\nduration: 4.0\n",
    "plant/euler": "kind: euler\nstep: null\n",
}


@pytest.fixture
def in_tmp(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def crane(in_tmp):
    """A user's config folder with a robot."""
    folder = in_tmp / "mine"
    for name, text in (("robot/crane.yaml", ROBOT_YAML), ("robots/crane.urdf", URDF)):
        (folder / name).parent.mkdir(parents=True)
        (folder / name).write_text(text)
    return folder


@pytest.fixture
def workshop(in_tmp, monkeypatch):
    """A user's installed distribution with a part of each kind, and a config folder that chooses them."""
    site = in_tmp / "site"
    for name, text in (
        ("workshop/__init__.py", ""),
        ("workshop/jacobian_transpose.py", CONTROLLER),
        ("workshop/spin.py", TRAJECTORY),
        ("workshop/euler.py", PLANT),
        ("workshop/path_length.py", METRIC),
        ("workshop-1.0.dist-info/METADATA", "Metadata-Version: 2.1\nName: workshop\nVersion: 1.0\n"),
        ("workshop-1.0.dist-info/entry_points.txt", ENTRY_POINTS),
    ):
        (site / name).parent.mkdir(parents=True, exist_ok=True)
        (site / name).write_text(text)
    monkeypatch.syspath_prepend(site)
    folder = in_tmp / "mine"
    for name, text in GROUPS.items():
        (folder / f"{name}.yaml").parent.mkdir(parents=True)
        (folder / f"{name}.yaml").write_text(text)
    yield folder
    for name in [name for name in sys.modules if name.partition(".")[0] == "workshop"]:
        del sys.modules[name]


def test_a_robot_of_ones_own_runs_from_the_command_line(crane, cli):
    ending = cli("--config-dir", "mine", "robot=crane")
    assert ending.code == 0
    run = runner.open_run(ending.folder)
    assert run.status == "ok"
    assert run.metrics["settling_time"].median < 4.0
    assert run.metrics["steady_state_error"].median < 1e-6
    assert yaml.safe_load((run.folder / "config.yaml").read_text())["robot"]["name"] == "crane"


def test_a_robot_of_ones_own_is_listed(crane, cli):
    ending = cli("list", "robots", "--config-dir", "mine")
    listed = {line.split(maxsplit=1)[0]: line.split(maxsplit=1)[1] for line in ending.out.splitlines()}
    assert listed["crane"].startswith("A crane: joints z, x, x")
    assert "macro" in listed


def test_a_robot_of_ones_own_takes_what_the_groups_offer(crane):
    run = runner.run("robot=crane", "trajectory=quintic", "noise=thesis", "torque_limits=thesis", config_dirs=[crane])
    assert run.config["torque_limits"]["max"] == [300.0, 400.0, 200.0]
    assert run.config["noise"]["position"] == 1e-4
    assert run.metrics["max_tracking_error"].median < 0.01
    document = run_document(run)
    assert faulty(document) == []
    assert document.title.startswith("Crane, ")


def test_the_mass_of_ones_own_robot_is_that_of_its_config(crane):
    run = runner.run("robot=crane", "duration=0.1", config_dirs=[crane])
    masses = {link.get("name"): link.find("inertial/mass") for link in ElementTree.fromstring(run.urdf).iter("link")}
    assert float(masses["jib"].get("value")) == 12.0


def test_parts_of_ones_own_run_together(workshop):
    overrides = ("robot=macro", "controller=jacobian_transpose", "trajectory=spin", "plant=euler")
    run = runner.run(*overrides, config_dirs=[workshop])
    assert run.status == "ok"
    assert run.provenance["plant_step"] == pytest.approx(0.0005)
    assert run.metrics["path_length"].unit == "m"
    assert run.metrics["path_length"].median > 0.1
    assert run.metrics["steady_state_error"].median is None  # it goes round and round
    assert run.metrics["max_tracking_error"].median < 0.3
    assert faulty(run_document(run)) == []


@pytest.mark.parametrize(
    "part", ["controller=jacobian_transpose", "trajectory=spin", "plant=euler"], ids=lambda part: part.split("=")[0]
)
def test_each_part_runs_beside_ours(workshop, part):
    run = runner.run("robot=macro", part, "duration=0.5", config_dirs=[workshop])
    assert run.status == "ok"
    assert "path_length" in run.metrics


def test_a_wrong_value_for_ones_own_part_is_told_as_for_ours(workshop):
    with pytest.raises(ConfigError) as caught:
        runner.run("controller=jacobian_transpose", "controller.stiffness=-1", config_dirs=[workshop])
    assert caught.value.problems == ("controller.stiffness: must be above 0; found -1",)


def test_ones_own_kinds_are_named_where_a_kind_is_unknown(workshop):
    with pytest.raises(
        ConfigError,
        match=r"did you mean jacobian_transpose\?.*jacobian_transpose, joint_pd, joint_pid, macro_mini, motor_pd, op",
    ):
        runner.run("controller.kind=jacobian_transposed", config_dirs=[workshop])


DOCS = ROOT / "docs"


def test_the_pages_name_the_groups_of_entry_points_and_the_folders():
    text = "".join(path.read_text() for path in DOCS.glob("*.md"))
    for line in ENTRY_POINTS.splitlines():
        if line.startswith("["):
            assert line.strip("[]") in text
    assert "--config-dir" in text


def test_an_environment_of_ones_own_acts_on_the_tip(own_part, cli):
    folder = own_part("environment", "water", WATER, "kind: water\ndrag: 20.0\nlift: 5.0\n")
    ending = cli("--config-dir", folder, "robot=macro", "trajectory=quintic", "environment=water", "duration=0.5")
    assert ending.code == 0, ending.err
    trace = runner.open_run(ending.folder).trace()
    drag = 5.0 - 20.0 * np.gradient(trace["tip_z"], trace["t"], edge_order=2)
    np.testing.assert_allclose(trace["external_force_z"], drag, atol=0.2)


def test_an_environment_of_ones_own_draws_for_each_repetition(own_part, cli):
    source = WATER.replace(
        "    def reset(self, tip):\n        pass\n",
        "    def begin(self, tick, generator):\n"
        "        self.lift = np.array([0.0, 0.0, tick * generator.uniform(50.0, 500.0)])\n\n"
        "    def reset(self, tip):\n        pass\n",
    )
    assert source != WATER
    folder = own_part(
        "environment", "waves", source.replace('"water"', '"waves"'), "kind: waves\ndrag: 0.0\nlift: 0.0\n"
    )
    ending = cli("--config-dir", folder, "robot=macro", "environment=waves", "duration=0.05", "repetitions=2")
    assert ending.code == 0, ending.err
    first, second = runner.open_run(ending.folder).values("peak_force")
    assert first != second
    assert min(first, second) >= 0.5
