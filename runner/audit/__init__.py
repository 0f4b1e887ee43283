"""The audit of printed equations: transcribed as data, tried against the arms' true kinematics and dynamics."""
