"""Torque sensors in the joints with white noise."""

from runner.plugin import StrictModel, units


class NoisyTorqueConfig(StrictModel):
    kind: str
    noise: units.NewtonMetres[float]


class NoisyTorque:
    def __init__(self, config, joints, ticks, generator):
        self.errors = config.noise * generator.standard_normal((ticks, len(joints)))

    def read(self, tick, torque):
        return torque + self.errors[tick]


CONFIG, build = NoisyTorqueConfig, NoisyTorque
