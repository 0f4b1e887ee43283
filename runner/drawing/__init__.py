"""Drawings made from a robot's model or a controller's graph; each returns SVG text."""

from runner.drawing.arm import arm_motion, top_view
from runner.drawing.block_diagram import block_diagram
from runner.drawing.control_steps import control_steps
from runner.drawing.frames import frame_assignment
from runner.drawing.workspace import workspace_sphere

__all__ = ["arm_motion", "block_diagram", "control_steps", "frame_assignment", "top_view", "workspace_sphere"]
