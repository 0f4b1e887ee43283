"""Rotor inertias of a UR arm from a log of its controller: `python rotor_inertias.py LOG.csv URDF [PAYLOAD]`.

The log is one of ur-rtde's recorder with all variables, of a motion of every joint. The controller's target_moment
holds the torques of a rigid model with rotors, and neither friction nor noise. PAYLOAD is in kg, at the flange.
"""

import sys

import numpy as np
import pandas as pd
import pinocchio as pin

log, model = pd.read_csv(sys.argv[1]), pin.buildModelFromUrdf(sys.argv[2])
model.inertias[model.njoints - 1] += pin.Inertia(
    float(sys.argv[3]) if sys.argv[3:] else 0.0, np.zeros(3), np.zeros((3, 3))
)
q, dq, ddq, tau = (log[[f"target_{name}_{j}" for j in range(6)]].to_numpy() for name in ("q", "qd", "qdd", "moment"))
data = model.createData()
rest = tau - np.array([pin.rnea(model, data, *row) for row in zip(q, dq, ddq, strict=True)])
for j, name in enumerate(list(model.names)[1:]):
    columns = np.column_stack([ddq[:, j], dq[:, j], np.sign(dq[:, j]), np.ones(len(q))])
    found = np.linalg.lstsq(columns, rest[:, j], rcond=None)[0][0]
    print(name, f"{found:.4g} kg m^2" if np.ptp(ddq[:, j]) > 0.1 else "undetermined: it hardly accelerates")
