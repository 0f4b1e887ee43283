"""What is wrong with a stranger's URDF, what can be fixed, and a config folder to start from."""
