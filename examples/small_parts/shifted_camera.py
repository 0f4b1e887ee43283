"""Camera with a constant error of the tip's position."""

import numpy as np

from runner.plugin import TipSensorConfig, units


class ShiftedCameraConfig(TipSensorConfig):
    shift: units.Metres[float]


class ShiftedCamera:
    def __init__(self, config, measurements, period, generator):
        self.shift = np.array([[config.shift], [0.0]])

    def measure(self, number, tip):
        return tip + self.shift


CONFIG, build = ShiftedCameraConfig, ShiftedCamera
