"""The example that finds rotor inertias in a log of a UR arm: made-up target_moment of another set."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pinocchio as pin
import pytest
from support.arms import model_of

ROOT = Path(__file__).parents[3]


@pytest.mark.costs(3)
@pytest.mark.parametrize("payload", [0.0, 1.3])
def test_the_rotor_inertias_of_a_controller_come_back(tmp_path, payload):
    generator = np.random.default_rng(4)
    rotors, t = generator.uniform(0.1, 2.0, 6), np.arange(0.0, 8.0, 0.008)
    speeds, swings = generator.uniform(0.5, 3.0, 6), generator.uniform(0.2, 0.6, 6)
    swings[4] = 0.0  # wrist 2 rests
    angles = t[:, None] * speeds
    home = np.array([0.0, -1.5, 1.5, -1.5, -1.5, 0.0])
    rows = (home + swings * np.sin(angles), swings * speeds * np.cos(angles), -swings * speeds**2 * np.sin(angles))
    model = model_of("ur5e", "tool0").pin_model.copy()
    model.armature = rotors
    model.appendBodyToJoint(6, pin.Inertia(payload, np.zeros(3), np.zeros((3, 3))), pin.SE3.Identity())
    data = model.createData()
    moments = np.array([pin.rnea(model, data, *row) for row in zip(*rows, strict=True)])
    log = {
        f"target_{name}_{j}": values[:, j]
        for name, values in zip(("q", "qd", "qdd", "moment"), (*rows, moments), strict=True)
        for j in range(6)
    }
    pd.DataFrame(log).to_csv(tmp_path / "log.csv", index=False, float_format="%.6f")  # as the recorder rounds
    script = [
        sys.executable,
        ROOT / "examples" / "rotor_inertias.py",
        tmp_path / "log.csv",
        ROOT / "robots" / "ur5e.urdf",
    ]
    told = subprocess.run([*script, str(payload)], capture_output=True, text=True, check=True).stdout.splitlines()
    for joint, line in enumerate(told):
        if joint == 4:
            assert line == "wrist_2_joint undetermined: it hardly accelerates"
        else:
            assert float(line.split()[1]) == pytest.approx(rotors[joint], rel=1e-3)
    assert len(told) == 6
