"""Model error: the controller's model has wrong masses."""

import numpy as np

from runner.plugin import StrictModel, scale_model, with_models


class HeavyConfig(StrictModel):
    kind: str
    factor: float


CONFIG = HeavyConfig


def build(config, robot, generator):
    def change(model, joints, bears_payload):
        masses, ones = np.full(model.nq, config.factor), np.ones(model.nq)
        return scale_model(model, masses, ones, np.ones(model.nq + 1))

    return with_models(robot, change)
