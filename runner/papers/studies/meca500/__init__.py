"""Meca500 study: kinematics, calibration and force control."""
