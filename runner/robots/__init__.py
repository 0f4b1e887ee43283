"""Robot arms: URDF and MJCF files, rigid-body models, kinematics and model mismatch."""
