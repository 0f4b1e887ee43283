"""Trajectory: straight upwards from rest to rest."""

import numpy as np

from runner.plugin import OfTip, StrictModel, quintic_blend, units


class RiseConfig(StrictModel):
    kind: str
    start: list[float] | None
    height: units.Metres[float]


class Rise(OfTip):
    duration, run_duration, tracked = 1.0, 1.5, True

    def __init__(self, config, start):
        self.start, self.way = start, np.array([0.0, 0.0, config.height])
        self.goal = start + self.way

    def sample(self, times):
        motion = np.stack(quintic_blend(times / self.duration), axis=1)[:, :, None] * self.way
        motion[:, 0] += self.start
        return motion

    def distance_to_path(self, points):
        along = np.clip((points - self.start) @ self.way / (self.way @ self.way), 0.0, 1.0)
        return np.linalg.norm(points - self.start - along[..., None] * self.way, axis=-1)


CONFIG, build = RiseConfig, Rise
