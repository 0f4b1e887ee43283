"""Drawings made from a robot's model or a controller's graph; each returns SVG text."""

from runner.report.charts.arm import arm_motion, top_view
from runner.report.charts.block_diagram import block_diagram
from runner.report.charts.control_steps import control_steps
from runner.report.charts.frames import frame_assignment
from runner.report.charts.workspace import workspace_sphere

__all__ = ["arm_motion", "block_diagram", "control_steps", "frame_assignment", "top_view", "workspace_sphere"]
