"""Controllers from outside the package: each part that they may offer, and refusals."""

import numpy as np
import pytest

from runner.store import open_run

POSITIONS = """
    from typing import Literal
    import numpy as np
    from pydantic import PositiveFloat
    from runner.controllers import Loop
    from runner.plugins.registry import StrictModel
    COMMANDS = "position"
    {more}
    class CONFIG(StrictModel):
        kind: Literal["{name}"]
        period: PositiveFloat
    class Law:
        def reset(self, q):
            self.q = q.copy()
        def joint_positions(self, time, q, dq, reference):
            self.q[0] = self.q[0] + 0.001
            return self.q
    def build(config, robot):
        return (Loop("arm", slice(0, robot.model.nq), config.period, Law()),)
"""
TORQUES = """
    from typing import Literal
    import numpy as np
    from pydantic import PositiveFloat
    from runner.controllers import Loop
    from runner.plugins.registry import StrictModel
    class CONFIG(StrictModel):
        kind: Literal["{name}"]
        period: PositiveFloat
        {field}
    class Law:
        def __init__(self, robot):
            self.robot = robot
        def reset(self):
            pass
        def torque(self, time, q, dq, reference):
            return self.robot.model.gravity_torque(q)
    {more}
    def build(config, robot):
        return (Loop("arm", slice(0, robot.model.nq), config.period, Law(robot)),)
"""
QUINTIC = ("trajectory=quintic", "duration=0.1", "plant.step=null")


def law(own_part, name, module, keys="", **parts):
    for key, text in {"more": "", "field": "", **parts}.items():
        module = module.replace(f"{{{key}}}", text)
    return own_part("controller", name, module.replace("{name}", name), f"kind: {name}\nperiod: 0.01\n{keys}")


def test_a_module_says_that_its_laws_command_positions(own_part, cli):
    own = law(own_part, "turning", POSITIONS)
    given = ("--config-dir", own, "robot=macro", "controller=turning", "plant=kinematic", *QUINTIC)
    run = open_run(cli(*given).folder)
    np.testing.assert_allclose(np.diff(run.trace()["q1"]), 0.001, atol=1e-12)


def test_a_module_that_says_its_laws_follow_paths_has_its_path_checked(own_part, cli):
    own = law(own_part, "leaving", POSITIONS, more="FOLLOWS_PATHS = True")
    given = ("--config-dir", own, "robot=macro", "controller=leaving", "plant=kinematic", *QUINTIC)
    assert cli(*given).code == 0  # the run ends before the tip is too far off
    ending = cli(*given, "duration=3")
    assert ending.code == 2
    assert "the tip leaves the path" in ending.err


START = "def start_posture(config, robot, start): return "


def test_a_module_may_choose_the_posture_at_the_start(own_part, cli):
    own = law(own_part, "choosing", TORQUES, more=START + "robot.home + 0.1")
    run = open_run(cli("--config-dir", own, "robot=macro", "controller=choosing", *QUINTIC).folder)
    home = run.config["robot"]["home"]
    np.testing.assert_allclose(run.trace()[["q1", "q2", "q3"]].to_numpy()[0], np.array(home) + 0.1)


@pytest.mark.parametrize(
    ("posture", "why"),
    [
        ("np.zeros(2)", "start_posture of 'odd' gave an array of shape (2,); it must be an array of shape (3,)"),
        ("np.nan * robot.home", "gave nan at index [0]"),
        ("1 / 0", "ZeroDivisionError"),
    ],
)
def test_a_posture_at_the_start_that_is_none_is_refused(own_part, cli, posture, why):
    own = law(own_part, "odd", TORQUES, more=START + posture)
    ending = cli("--config-dir", own, "robot=macro", "controller=odd", *QUINTIC)
    assert ending.code == 2
    assert why in ending.err


def test_a_config_with_a_reach_has_the_share_of_time_beyond_it_told(own_part, cli):
    own = law(own_part, "riding", TORQUES, "reach: 1.0\n", field="reach: float")
    for reach, share in ((1e-6, 1.0), (1e3, 0.0)):
        given = ("robot=combined", "controller=riding", f"controller.reach={reach}", *QUINTIC)
        run = open_run(cli("--config-dir", own, *given).folder)
        assert run.metrics["reach_loss_fraction"].values == (share,)
    own = law(own_part, "without", TORQUES)
    run = open_run(cli("--config-dir", own, "robot=combined", "controller=without", *QUINTIC).folder)
    assert "reach_loss_fraction" not in run.metrics


YIELDING = POSITIONS.replace(
    """        period: PositiveFloat
""",
    """        period: PositiveFloat
        check_stability: bool
        @property
        def law(self):
            from runner.controllers.force.admittance_filter import Admittance
            return Admittance(np.full(6, 1e-3), np.full(6, 0.1), np.full(6, 1.0))
""",
)


@pytest.mark.bullet  # for servos against a wall
def test_a_config_with_a_law_has_walls_refused_that_it_would_bounce_on(own_part, cli):
    own = law(own_part, "yielding", YIELDING, "check_stability: true\n")
    given = (
        "--config-dir",
        own,
        "robot=meca500",
        "controller=yielding",
        "environment=wall",
        "duration=0.05",
        "plant=kinematic",
    )
    ending = cli(*given)
    assert ending.code == 2
    assert "is unstable against a wall of 10000 N/m" in ending.err
    assert cli(*given, "controller.check_stability=false").code == 0
    assert cli(*given, "plant=default").code == 0  # with servos the law decides nothing


LIMITED = TORQUES.replace(
    """            return self.robot.model.gravity_torque(q)
""",
    """            return self.limits
        def with_limits(self, limits):
            law = Law(self.robot)
            law.limits = limits
            return law
""",
)


def test_a_law_that_wants_its_torque_limits_is_told_them(own_part, cli):
    own = law(own_part, "limit_taker", LIMITED)
    given = ("robot=macro", "controller=limit_taker", "torque_limits.max=[3,2,1]", *QUINTIC)
    run = open_run(cli("--config-dir", own, *given).folder)
    np.testing.assert_array_equal(run.trace()[["tau1", "tau2", "tau3"]].to_numpy()[0], [3.0, 2.0, 1.0])


def test_a_law_that_raises_at_its_torque_limits_is_refused(own_part, cli):
    own = law(own_part, "limit_refuser", LIMITED.replace("law.limits = limits", "1 / 0"))
    ending = cli("--config-dir", own, "robot=macro", "controller=limit_refuser", *QUINTIC)
    assert ending.code == 2
    assert "ZeroDivisionError" in ending.err
