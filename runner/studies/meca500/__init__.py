"""The report on the Meca500's kinematics and force control."""
