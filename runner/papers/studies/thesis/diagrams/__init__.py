"""Block diagrams of the control laws and drawings of coordinate frames."""
