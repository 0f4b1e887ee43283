"""Control law: a spring from the tip to its desired position, damped joints, gravity compensation."""

from runner.plugin import Controller, Loop, StrictModel, units


class TipSpringConfig(StrictModel):
    kind: str
    period: units.Seconds[float]
    stiffness: units.Stiffness[float]
    damping: float


class TipSpring(Controller):
    def __init__(self, config, model):
        self.config, self.model = config, model

    def torque(self, time, q, dq, reference):
        force = self.config.stiffness * (reference[0] - self.model.tip_position(q))
        pull = self.model.tip_jacobian(q)[:3].T @ force
        return pull - self.config.damping * dq + self.model.gravity_torque(q)


CONFIG = TipSpringConfig


def build(config, robot):
    return (Loop("arm", slice(0, robot.model.nq), config.period, TipSpring(config, robot.model)),)
