"""Kinematic controllers: joint position commands from the tip motion."""
