"""Plants from outside the package: each part that they may offer, and its use by the loop."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

from runner.plants import GUARD
from runner.store import open_run

TORQUE_PLANT = """
    from typing import Literal
    import numpy as np
    from runner.plants.decoupled import TorquePlantConfig, assemble_plant
    from runner.plants.rk4 import Rk4

    class CONFIG(TorquePlantConfig):
        kind: Literal["{name}"]

    class Own(Rk4):
    {body}
    def build(config, robot, step, steps_per_tick):
        return assemble_plant(
            config, robot, step * steps_per_tick, lambda urdf, model: Own(model, step, steps_per_tick))

    def default_step(tick, stages):
        return tick
"""
KEYS = """
    defaults: [rk4, _self_]
    kind: {name}
"""
CONTACT = """
        wall = None
        def add_wall(self, point, normal, stiffness, damping):
            self.wall = point, normal, stiffness, damping
        def contact_wrench(self):
            point, normal, stiffness, damping = self.wall
            return np.concatenate([1e-3 * stiffness * normal, [point[0], damping, 0.0]])
"""
REACTION = """
        def tool_reaction(self):
            return np.array([0.0, 0.0, -3.0, 0.0, 0.0, 0.0])
"""
WALL = ("robot=meca500", "controller=admittance", "environment=wall", "duration=0.2")


def torque_plant(own_part, name, body):
    module = TORQUE_PLANT.replace("{name}", name).replace("    {body}", body)
    return own_part("plant", name, module, KEYS.format(name=name))


@pytest.mark.parametrize("friction", ["0.0", "0.01"])
def test_contact_plant_gets_the_wall_and_its_wrench_is_what_the_tip_feels(own_part, cli, friction):
    own = torque_plant(own_part, "touching", CONTACT)
    ending = cli("--config-dir", own, *WALL, "plant=touching", f"plant.friction.viscous={friction}")
    assert ending.code == 0, ending.err
    run = open_run(ending.folder)
    assert run.status == "ok", run.failure
    # the wall's normal is -x, its stiffness 1e4 N/m: the loop adds no wall force to the plant's
    np.testing.assert_allclose(run.trace()["external_force_x"], -10.0, rtol=1e-12)
    about_tip = run.trace()[["external_moment_x", "external_moment_y", "external_moment_z"]].to_numpy()
    point = run.trace()["tip_x"].iloc[0] + 0.005 + run.config["robot"]["tool"]["tip_radius"]
    force = np.array([-10.0, 0.0, 0.0])
    tips = run.trace()[["tip_x", "tip_y", "tip_z"]].to_numpy()
    np.testing.assert_allclose(about_tip, [point, 20.0, 0.0] - np.cross(tips, force), atol=1e-12)


def test_contact_plant_that_goes_wrong_is_told_with_its_place(own_part, cli):
    own = torque_plant(own_part, "short", CONTACT.replace("damping, 0.0]", "damping]"))
    ending = cli("--config-dir", own, *WALL, "plant=short")
    assert ending.code == 1
    failure = open_run(ending.folder).failure
    assert re.search(r"Own.contact_wrench \(short.py, line \d+\) gave an array of shape \(5,\)", failure)
    own = torque_plant(own_part, "refusing", CONTACT.replace("self.wall = point", "self.wall = 1 / 0, point"))
    ending = cli("--config-dir", own, *WALL, "plant=refusing")
    assert ending.code == 2
    assert "plant.kind: its add_wall: ZeroDivisionError" in ending.err
    assert "refusing.py, line" in ending.err


def test_tool_reaction_plant_has_its_reading_in_the_trace(own_part, cli):
    own = torque_plant(own_part, "reading", REACTION)
    run = open_run(cli("--config-dir", own, *WALL, "plant=reading").folder)
    reaction = run.trace()[["reaction_force_x", "reaction_force_y", "reaction_force_z"]].to_numpy()
    np.testing.assert_allclose(np.linalg.norm(reaction, axis=1), 3.0, rtol=1e-12)
    np.testing.assert_allclose(reaction[0], [0.0, 0.0, -3.0] @ flange_rotation(run, 0), atol=1e-9)


def flange_rotation(run, row):
    from runner.robots.model import RobotModel

    arm = RobotModel(run.urdf, "tool_flange" if "tool_flange" in run.urdf else run.provenance["tip_frame"])
    q = run.trace()[[f"q{joint + 1}" for joint in range(arm.nq)]].to_numpy()[row]
    return arm.tip_pose(q)[:3, :3]


def test_a_delay_in_its_config_is_heeded(own_part, cli):
    module = """
        from typing import Literal
        from runner.plants.rk4 import Rk4
        from runner.plants.computation import ComputationConfig
        from runner.plugins.registry import StrictModel
        class CONFIG(StrictModel):
            kind: Literal["late"]
            step: None
            computation: ComputationConfig
        def build(config, robot, step, steps_per_tick):
            return Rk4(robot.model, step, steps_per_tick)
        def default_step(tick, stages):
            return tick
    """
    own = own_part("plant", "late", module, "step: null\ncomputation: {delay: 0, jitter: null, miss: null}\n")
    given = ("--config-dir", own, "robot=macro", "trajectory=quintic", "duration=0.2", "plant=late")
    taus = {
        delay: open_run(cli(*given, f"plant.computation.delay={delay}").folder).trace()["tau2"].to_numpy()
        for delay in (0, 3)
    }
    assert len(np.unique(taus[0][:5])) == 5
    assert len(np.unique(taus[3][:4])) == 1


FOLLOWING = """
    from typing import Literal
    import numpy as np
    from runner.plugins.registry import StrictModel
    COMMANDS = "position"
    class CONFIG(StrictModel):
        kind: Literal["following"]
        step: None
    class Following:
        def __init__(self, size, tick):
            self.q, self.dq, self.tau, self.load = (np.zeros(size) for _ in range(4))
            self.tick = tick
        def reset(self, q, dq):
            self.q[:], self.dq[:] = q, dq
        def set_gravity(self, gravity):
            pass
        def advance(self, command):
            self.dq[:] = (command - self.q) / self.tick
            self.q[:] = command
            self.tau[:] = 7.0 - self.load
        def close(self):
            pass
    def build(config, robot, tick, ticks_per_command):
        return Following(robot.model.nq, tick)
    def default_step(tick, stages):
        return tick
"""


def test_position_plant_gets_commands_and_the_worlds_load_and_tells_its_torques(own_part, cli):
    own = own_part("plant", "following", FOLLOWING, "step: null\n")
    given = ("--config-dir", own, "robot=meca500", "plant=following", "controller=admittance", "duration=0.2")
    free = open_run(cli(*given).folder).trace()
    np.testing.assert_array_equal(free["q3"].to_numpy()[1:], free["q3_command"].to_numpy()[:-1])
    np.testing.assert_array_equal(free["tau3"].to_numpy(), 7.0)
    pushed = open_run(cli(*given, "environment=push", "environment.start_time=0.1").folder).trace()
    assert pushed["tau2"].nunique() > 1


def test_a_law_of_torques_on_it_is_refused(own_part, cli):
    own = own_part("plant", "following", FOLLOWING, "step: null\n")
    ending = cli("--config-dir", own, "robot=macro", "plant=following")
    assert ending.code == 2
    assert "plant.kind: following follows joint positions, and operational_space gives torques" in ending.err


def test_a_plant_of_torques_without_a_servo_takes_no_law_of_positions(own_part, cli):
    module = FOLLOWING.replace('COMMANDS = "position"', "").replace("following", "plain")
    own = own_part("plant", "plain", module, "step: null\n")
    ending = cli("--config-dir", own, "robot=meca500", "plant=plain", "controller=admittance")
    assert ending.code == 2
    assert "plant.kind: plain takes torques and has no servo, and admittance commands joint positions" in ending.err


TURNING = """
    from typing import Literal
    from runner.plants.rk4 import Rk4
    from runner.plugins.registry import StrictModel
    class CONFIG(StrictModel):
        kind: Literal["{name}"]
        step: None
        {field}
    def build(config, robot, step, steps_per_tick):
        return Rk4(robot.model, step, steps_per_tick)
    def default_step(tick, stages):
        return tick
"""


def test_a_config_says_whether_bases_turn_and_where_it_does_not_they_do(own_part, cli):
    given = ("robot=combined", "trajectory=quintic", "trajectory.start=[0.5,0.9,0.9]", "duration=0.02")
    field = 'wrist_rotation: Literal["real", "parallel"]'
    own_part("plant", "silent", TURNING.format(name="silent", field=""), "step: null\n")
    keys = "step: null\nwrist_rotation: real\n"
    own = own_part("plant", "turning", TURNING.format(name="turning", field=field), keys)
    tips = {}
    for plant in (["plant=silent"], ["plant=turning"], ["plant=turning", "plant.wrist_rotation=parallel"]):
        ending = cli("--config-dir", own, *given, *plant)
        assert ending.code == 0, ending.err
        tips[plant[-1]] = open_run(ending.folder).trace()["tip_x"].to_numpy()
    np.testing.assert_array_equal(tips["plant=silent"], tips["plant=turning"])
    assert np.abs(tips["plant.wrist_rotation=parallel"] - tips["plant=turning"]).max() > 1e-4


def test_walls_reach_the_plant_inside_a_wrapper_without_a_base_class():
    walls = []
    inside = SimpleNamespace(q=np.zeros(1), dq=np.zeros(1), add_wall=lambda *given: walls.append(given))
    guarded = GUARD(SimpleNamespace(plant=inside, q=inside.q, dq=inside.dq))
    assert guarded.add_wall(np.zeros(3), np.ones(3), 1.0, 2.0) is True
    assert len(walls) == 1
