"""Environment: drag of water on the tip."""

import numpy as np

from runner.plugin import Environment, StrictModel, units


class WaterConfig(StrictModel):
    kind: str
    drag: units.Damping[float]


class Water(Environment):
    def __init__(self, config):
        self.drag = config.drag

    def wrench(self, time, tip, velocity):
        return np.concatenate([-self.drag * velocity, np.zeros(3)])


CONFIG, build = WaterConfig, Water
