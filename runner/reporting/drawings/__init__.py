"""Drawings for a report, made from a robot's model or a controller's graph; each returns SVG text."""

from runner.reporting.drawings.arm import arm_motion, top_view
from runner.reporting.drawings.block_diagram import block_diagram
from runner.reporting.drawings.control_steps import control_steps
from runner.reporting.drawings.frames import frame_assignment
from runner.reporting.drawings.workspace import workspace_sphere

__all__ = ["arm_motion", "block_diagram", "control_steps", "frame_assignment", "top_view", "workspace_sphere"]
