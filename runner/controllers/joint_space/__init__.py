"""Joint-space controllers: PD, PID, computed torque, passivity-based, adaptive, sliding mode, learning."""
