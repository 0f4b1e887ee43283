"""Encoders whose zero is wrong."""

from runner.plugin import StrictModel, units


class ZeroOffsetConfig(StrictModel):
    kind: str
    offset: units.Radians[float]


class ZeroOffset:
    def __init__(self, config, joints, ticks, period, generator):
        self.offset = config.offset

    def measure(self, tick, q, dq):
        return q + self.offset, dq


CONFIG, build = ZeroOffsetConfig, ZeroOffset
