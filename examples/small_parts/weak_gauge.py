"""Force/torque sensor in the wrist with a wrong gain."""

from runner.plugin import StrictModel


class WeakGaugeConfig(StrictModel):
    kind: str
    gain: float


class WeakGauge:
    def __init__(self, config, ticks, period, generator):
        self.gain = config.gain

    def read(self, tick, wrench):
        return self.gain * wrench


CONFIG, build = WeakGaugeConfig, WeakGauge
