"""Joint-space PD with gravity compensation."""

from typing import Literal

import numpy as np
from pydantic import PositiveFloat

from runner.plugin import Loop, StrictModel


class GravityPDConfig(StrictModel):
    """Keys of controller/gravity_pd.yaml: period in s, natural_frequency in rad/s, approach in 1/s."""

    kind: Literal["gravity_pd"]
    period: PositiveFloat
    natural_frequency: PositiveFloat
    damping_ratio: PositiveFloat
    approach: PositiveFloat


class GravityPD:
    """tau = K (q_d - q) + D (dq_d - dq) + G(q), where q_d brings the tip along: dq_d = J^+ (v_d + k (x_d - x(q_d)))."""

    def __init__(self, model, home, config):
        self.model, self.config = model, config
        inertia = np.diag(model.mass_matrix(home))  # of each joint with the others held
        self.K = config.natural_frequency**2 * inertia
        self.D = 2.0 * config.damping_ratio * config.natural_frequency * inertia

    def reset(self):
        self.q_d = None

    def torque(self, time, q, dq, reference):
        if self.q_d is None:
            self.q_d = q.copy()
        x_d, v_d, _ = reference
        missing = x_d - self.model.tip_position(self.q_d)
        dq_d = np.linalg.pinv(self.model.tip_jacobian(self.q_d)[:3], 0.05) @ (v_d + self.config.approach * missing)
        torque = self.K * (self.q_d - q) + self.D * (dq_d - dq) + self.model.gravity_torque(q)
        self.q_d = self.q_d + self.config.period * dq_d
        return torque


CONFIG = GravityPDConfig


def build(config, robot):
    return (Loop("arm", slice(0, robot.model.nq), config.period, GravityPD(robot.model, robot.home, config)),)
