"""Calibration: position of the flange at home, as the mean of several readings."""

import numpy as np

from runner.plugin import Outcome, StrictModel, units


class FlangePositionConfig(StrictModel):
    kind: str
    readings: int
    repeatability: units.Metres[float]


class FlangePosition:
    estimates = errors = {"x": "m", "y": "m", "z": "m"}
    measures = {}

    def __init__(self, config, bench):
        self.bench, self.repeatability = bench, config.repeatability
        self.postures = np.tile(bench.home, (config.readings, 1))
        self.truth = bench.poses(self.postures)[0, :3, 3]

    def repeat(self, generator):
        poses, covariances = self.bench.read_poses(self.postures, self.repeatability, generator)
        mean, covariance = poses[:, :3, 3].mean(axis=0), covariances[:, :3, :3].mean(axis=0) / len(poses)
        return Outcome(mean, mean - self.truth, covariance, {})


CONFIG, build = FlangePositionConfig, FlangePosition
