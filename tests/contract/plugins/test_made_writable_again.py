"""A part of the user that makes what it is handed writable again reaches neither record nor plant nor metrics."""

import os
import sys

import numpy as np
import pytest

from runner.plugins.discovery import use_plugins
from runner.store import open_calibration, open_run

LAW = """
    from typing import Literal
    import numpy as np
    from runner.controllers import Loop
    from runner.plugins.registry import StrictModel
    class CONFIG(StrictModel):
        kind: Literal["NAME"]
        period: float
    class Law:
        def __init__(self, robot):
            self.robot, self.home = robot, robot.home.copy()
        def reset(self):
            pass
        def torque(self, time, q, dq, reference):
            answer = 50.0 * (self.home - q) - 5.0 * dq
            spoil(q, dq, reference, self.robot.stages[0].home, self.robot.model.pin_model.inertias[1].lever)
            return answer
    def build(config, robot):
        law = Law(robot)
        if SPOILS:
            robot.model.pin_model.gravity.linear = np.zeros(3)
            robot.model._data.oMi[1].translation[:] = 9.0
            robot.stages[0].home[:] = 9.0
        return (Loop("arm", slice(0, 3), config.period, law),)
"""
WIND = """
    from typing import Literal
    import numpy as np
    from runner.plugins.registry import StrictModel
    class CONFIG(StrictModel):
        kind: Literal["NAME"]
    class Wind:
        def reset(self, tip):
            spoil(tip)
        def wrench(self, time, tip, velocity):
            answer = np.concatenate([-velocity, np.zeros(3)])
            spoil(tip, velocity)
            return answer
    def build(config):
        return Wind()
"""
CABLE = """
    from typing import Literal
    import numpy as np
    from runner.plugins.registry import StrictModel
    class CONFIG(StrictModel):
        kind: Literal["NAME"]
    class Cable:
        points = {"link2": [0.0, 0.0, 0.5]}
        def reset(self, tip):
            spoil(tip)
        def wrench(self, time, tip, velocity):
            return np.zeros(6)
        def link_forces(self, time, positions, velocities):
            answer = -5.0 * velocities
            spoil(positions, velocities)
            return answer
        def joint_torques(self, time, q, dq):
            answer = -0.5 * q
            spoil(q, dq)
            return answer
    def build(config):
        return Cable()
"""
NOISE = """
    from typing import Literal
    from runner.plugins.registry import StrictModel
    class CONFIG(StrictModel):
        kind: Literal["NAME"]
    class Encoders:
        def __init__(self, errors):
            self.errors = errors
        def measure(self, tick, q, dq):
            answer = (q + self.errors[tick], 0.9 * dq)
            spoil(q, dq)
            return answer
    def build(config, joints, ticks, period, generator):
        return Encoders(1e-4 * generator.normal(size=(ticks, len(joints))))
"""
WRIST = """
    from typing import Literal
    from runner.plugins.registry import StrictModel
    class CONFIG(StrictModel):
        kind: Literal["NAME"]
    class Sensor:
        def read(self, tick, wrench):
            answer = 0.9 * wrench
            spoil(wrench)
            return answer
    def build(config, ticks, period, generator):
        generator.normal(size=ticks)
        return Sensor()
"""
TORQUES = """
    from typing import Literal
    from runner.plugins.registry import StrictModel
    class CONFIG(StrictModel):
        kind: Literal["NAME"]
    class Sensors:
        def read(self, tick, torque):
            answer = 1.01 * torque
            spoil(torque)
            return answer
    def build(config, joints, ticks, generator):
        return Sensors()
"""
BELIEF = """
    import copy
    from typing import Literal
    import numpy as np
    from runner.plugins.registry import StrictModel
    from runner.robots.mismatch import scale_model
    from runner.robots.robot import with_models
    class CONFIG(StrictModel):
        kind: Literal["NAME"]
    def build(config, robot, generator):
        def change(model, joints, bears_payload):
            ones = np.ones(model.nq)
            return scale_model(model, 0.9 * ones, ones, np.ones(model.nq + 1))
        believed = copy.deepcopy(with_models(robot, change))
        if SPOILS:
            robot.model.pin_model.gravity.linear = np.zeros(3)
            robot.model._data.oMi[1].translation[:] = 9.0
            spoil(robot.stages[0].home)
        return believed
"""
PLANT = """
    from typing import Literal
    import numpy as np
    from runner.plants.rk4 import Rk4
    from runner.plugins.registry import StrictModel
    class CONFIG(StrictModel):
        kind: Literal["NAME"]
        step: None
    class Plant(Rk4):
        def reset(self, q, dq):
            super().reset(q, dq)
            spoil(q, dq)
        def advance(self, tau):
            super().advance(tau)
            spoil(tau)
    def build(config, robot, step, steps_per_tick):
        plant = Plant(robot.model, step, steps_per_tick)
        if SPOILS:
            robot.model.pin_model.gravity.linear = np.zeros(3)
        return plant
    def default_step(tick, stages):
        return tick
"""
PATH = """
    from typing import Literal
    import numpy as np
    from runner.plugins.registry import StrictModel
    class CONFIG(StrictModel):
        kind: Literal["NAME"]
    class Path:
        duration, run_duration, tracked, goal = 0.5, 0.5, True, None
        def __init__(self, start):
            self.start = start
        def sample(self, times):
            self.motion = np.zeros((len(times), 3, 3))
            waves = np.stack([np.sin(times), np.cos(times), -np.sin(times)], axis=1)
            self.motion[:, :, 2] = -0.1 * waves
            self.motion[:, 0] += self.start
            spoil(times)
            return self.motion
        def distance_to_path(self, points):
            distance = np.abs(points[:, 2])
            spoil(points, self.motion)
            return distance
    def build(config, start):
        return Path(np.array(start))
"""
METRIC = """
    UNITS = {"own": "m"}
    def evaluate(trace, context):
        own = float(trace.q[-1, 0])
        spoil(trace.t, trace.q, trace.desired, trace.end_points, trace.limits, trace.tick_seconds,
              context.trajectory.start)
        return {"own": own}
"""
CALIBRATION = """
    from typing import Literal
    import numpy as np
    from runner.calibration.procedure import Outcome
    from runner.plugins.registry import StrictModel
    class CONFIG(StrictModel):
        kind: Literal["NAME"]
    class Look:
        estimates, errors, measures, truth = {"x": "m"}, {"x": "m"}, {}, np.zeros(1)
        def __init__(self, bench):
            self.bench, self.postures = bench, bench.home[None].copy()
        def repeat(self, generator):
            error = self.bench.flange.tip_position(self.postures[0])[:1] + self.bench.tip[0] + generator.normal(size=1)
            return Outcome(error, error, np.eye(1), {})
    def build(config, bench):
        procedure = Look(bench)
        handed = np.array(bench.tip)
        spoil(handed, bench.home, bench.tool.centre_of_mass)
        return procedure
"""
OBSERVER = ["controller=computed_torque", "disturbance_observer=momentum", "disturbance_observer.torque=measured"]
SPOIL = """
import numpy as np
SPOILS = {spoils}
def spoil(*arrays):
    for array in arrays if SPOILS else ():
        array.setflags(write=True)
        array[...] = 9.0
"""


@pytest.fixture
def mine(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("RUNNER_PLUGINS", raising=False)
    monkeypatch.setattr(sys, "path", [*sys.path])
    yield tmp_path / "mine"
    os.environ.pop("RUNNER_PLUGINS", None)


def write_part(mine, group, name, module, spoils):
    """Write a part that spoils its arguments, or one that does not, and use only this part."""
    text = SPOIL.format(spoils=spoils) + "\n".join(line[4:] for line in module.replace("NAME", name).splitlines())
    (mine / group).mkdir(parents=True, exist_ok=True)
    (mine / f"{name}.py").write_text(text)
    values = {"controller": "period: 0.01\n", "plant": "step: null\n"}.get(group, "")
    (mine / group / f"{name}.yaml").write_text(f"kind: {name}\n{values}")
    os.environ.pop("RUNNER_PLUGINS", None)
    use_plugins([f"{group}={mine / name}.py"])


@pytest.mark.parametrize(
    ("group", "module"),
    [
        ("controller", LAW),
        ("environment", WIND),
        ("environment", CABLE),
        ("noise", NOISE),
        ("wrist_sensor", WRIST),
        ("joint_torque_sensor", TORQUES),
        ("mismatch", BELIEF),
        ("plant", PLANT),
        ("trajectory", PATH),
        ("metric", METRIC),
    ],
    ids=["law", "wind", "cable", "noise", "wrist", "torques", "belief", "plant", "path", "metric"],
)
def test_an_array_made_writable_again_reaches_nothing(mine, cli, group, module):
    found = {}
    for spoils in (False, True):
        name = f"{group}_{len(module)}_{'spoils' if spoils else 'honest'}"  # one module of a name in a process
        write_part(mine, group, name, module, spoils)
        choose = [] if group == "metric" else [f"{group}={name}"]
        path = [] if group == "trajectory" else ["trajectory=quintic"]
        plant = [] if group == "plant" else ["plant=rk4"]
        noise = [] if group == "noise" else ["noise=thesis"]
        read = {"wrist_sensor": ["environment=push"], "joint_torque_sensor": OBSERVER}.get(group, [])
        given = ("repetitions=2", "duration=0.2", *noise, *path, *plant, *read, *choose)
        ending = cli("--config-dir", mine, "robot=macro", *given)
        assert ending.code == 0, ending.err
        found[spoils] = open_run(ending.folder)
    assert found[True].metrics == found[False].metrics
    np.testing.assert_array_equal(found[True].trace().to_numpy(), found[False].trace().to_numpy())


def test_a_calibration_reaches_no_bench_but_its_own(mine, cli):
    truth = {}
    for spoils in (False, True):
        name = f"look_{'spoils' if spoils else 'honest'}"
        write_part(mine, "calibration", name, CALIBRATION, spoils)
        ending = cli("calibrate", "--config-dir", mine, f"calibration={name}", "repetitions=2")
        assert ending.code == 0, ending.err
        truth[spoils] = open_calibration(ending.folder)
    assert truth[True].record["errors"] == truth[False].record["errors"]
    assert truth[True].config["robot"] == truth[False].config["robot"]
