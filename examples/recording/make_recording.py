"""Create recording.csv: the log of an arm that differs from the run, here simulated.

    python examples/recording/make_recording.py recording.csv

The arm moves as in experiment/swing.yaml. Its joints have friction, its links other masses, its encoders noise. The
logger starts 0.7313 s before the motion, writes 250 rows a second, the first joint in degrees, and the current of the
third motor instead of its torque.
"""

import sys

import numpy as np

import runner

START = 0.7313  # s, from the logger's start to that of the motion
RATE = 250.0  # Hz
CONSTANT = 1.6  # N m/A
ERROR = 1e-4  # rad, half-width of the encoders' noise
ARM = (
    "plant.friction.viscous=[1.2,0.8,0.5]",  # N m s/rad
    "plant.friction.coulomb=[1.5,1.0,0.6]",  # N m
    "robot.masses={link2:1.15,link3:0.9}",  # kg; the robot's file says 1 kg each
    "mismatch.mass=0.95",
    "noise.position=1e-5",
    "noise.velocity=low_pass",
)


def record(config_dir, outputs):
    """Return the rows of the recording, shape (N, 7): ms, deg, rad, rad, N m, N m, A."""
    run = runner.run("experiment=swing", *ARM, config_dirs=config_dir, outputs=str(outputs))
    signals = run.trace()
    t = signals["t"].to_numpy()
    q, tau = (signals[[f"{stem}{joint}" for joint in (1, 2, 3)]].to_numpy() for stem in ("q", "tau"))
    clock = np.arange(int((START + t[-1]) * RATE)) / RATE
    positions = np.column_stack([np.interp(clock - START, t, joint) for joint in q.T])
    positions += ERROR * np.random.default_rng(0).uniform(-1.0, 1.0, positions.shape)
    # The logger measures mean torques between its rows; before the motion the first one holds the arm.
    impulse = np.vstack([np.zeros(3), np.cumsum(tau[:-1] * np.diff(t)[:, None], axis=0)])
    edges = np.concatenate([[-0.5], np.arange(len(clock)) + 0.5]) / RATE - START
    upto = np.column_stack([np.interp(edges, t, own) for own in impulse.T]) + np.minimum(edges, 0.0)[:, None] * tau[0]
    torques = np.diff(upto, axis=0) * RATE
    columns = [1e3 * clock, np.degrees(positions[:, 0]), positions[:, 1:], torques[:, :2], torques[:, 2] / CONSTANT]
    return np.column_stack(columns)


def write(path, rows):
    """Write the rows as CSV."""
    names = "time_ms,shoulder_deg,elbow,wrist,shoulder_torque,elbow_torque,wrist_current"
    digits = ["%.0f", "%.4f", "%.6f", "%.6f", "%.4f", "%.4f", "%.4f"]
    np.savetxt(path, rows, fmt=digits, delimiter=",", header=names, comments="")


if __name__ == "__main__":
    write(sys.argv[1], record("examples/recording", "outputs"))
