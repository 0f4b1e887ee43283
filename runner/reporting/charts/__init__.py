"""SVG drawings of a robot model or of a controller's graph."""

from runner.reporting.charts.arm import arm_motion, top_view
from runner.reporting.charts.block_diagram import block_diagram
from runner.reporting.charts.control_steps import control_steps
from runner.reporting.charts.frames import frame_assignment
from runner.reporting.charts.workspace import workspace_sphere

__all__ = ["arm_motion", "block_diagram", "control_steps", "frame_assignment", "top_view", "workspace_sphere"]
