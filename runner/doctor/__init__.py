"""What is wrong with a stranger's URDF, what can be mended, and a config folder to start from."""
