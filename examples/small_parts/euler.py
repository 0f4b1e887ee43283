"""Plant: semi-implicit Euler steps of a rigid arm."""

import numpy as np

from runner.plugin import Plant, StrictModel, units


class EulerConfig(StrictModel):
    kind: str
    step: units.Seconds[float | None]


class Euler(Plant):
    def __init__(self, config, robot, step, steps_per_tick):
        self.model, self.step, self.steps = robot.model, step, steps_per_tick
        self.q, self.dq = np.zeros((2, robot.model.nq))

    def reset(self, q, dq):
        self.q[:], self.dq[:] = q, dq

    def advance(self, tau):
        for _ in range(self.steps):
            self.dq += self.step * self.model.forward_dynamics(self.q, self.dq, tau)
            self.q += self.step * self.dq


CONFIG, build = EulerConfig, Euler
