"""Names for plug-ins: what a controller, plant, sensor, metric or section of a report is made from.

These names are stable: a change of one is in the changelog. Other modules of `runner` may change in any release.

- Configs: `StrictModel` is the base of each `CONFIG`; `units` has the types of keys with a unit, such as
  `units.Seconds[PositiveFloat]`.
- Robots: `Robot` is a chain of arms, `RobotModel` its kinematics and dynamics.
- Controllers: `build` returns `Loop`s, each with a law. A law derives from `Controller`, from `PositionController`, or
  from `TorqueLaw`, which is compiled. `delay_limit` and `force_loop_limit` are bounds of gains.
- Plants derive from `Plant` or `PositionPlant`. `TorquePlantConfig` and `assemble_plant` add friction and stages.
- Sensors have the methods of `Encoders`, `TorqueSensors`, `WristSensor` or `TipSensor`; the config of the last one
  derives from `TipSensorConfig`.
- Trajectories have the methods of `Trajectory`; `OfTip` has the default of its optional one. `quintic_blend` and
  `distance_to_curve` help.
- Environments derive from `Environment`.
- Model errors: `with_models` replaces the models of a robot, `scale_model` scales a model.
- Calibrations: `build` receives a `Bench`; the procedure has the methods of `Procedure` and returns an `Outcome`.
- Metrics: `evaluate` receives a `Trace` and a `MetricContext`.
- Sections of reports: a function of a `RunSubject` or a `SweepSubject` returns a `Section` of blocks: `Text`, `Items`,
  `Code`, `Notice`, `Formula`, `Table` with `Column`s, `Curves` with `Panel`s of `Series`, and `Maps` of `Map`s.
"""

from runner.base.trace import Trace
from runner.calibration.procedure import Bench, Outcome, Procedure
from runner.controllers.controller import Controller, Loop, PositionController
from runner.controllers.stability import delay_limit, force_loop_limit
from runner.controllers.torque_law import TorqueLaw
from runner.environments import Environment
from runner.metrics.family import MetricContext
from runner.plants.decoupled import TorquePlantConfig, assemble_plant
from runner.plants.plant import Plant, PositionPlant
from runner.reporting.document import (
    Code,
    Curves,
    Formula,
    Items,
    Map,
    Maps,
    Notice,
    Panel,
    Section,
    Series,
    Table,
    Text,
)
from runner.reporting.sections import RunSubject
from runner.reporting.sweep.subject import SweepSubject
from runner.reporting.table import Column
from runner.robots.mismatch import scale_model
from runner.robots.model import RobotModel
from runner.robots.robot import Robot, with_models
from runner.schema import units
from runner.schema.model import StrictModel
from runner.sensing import Encoders, TipSensor, TorqueSensors, WristSensor
from runner.sensing.endpoint import TipSensorConfig
from runner.trajectories.geometry import distance_to_curve
from runner.trajectories.motion import quintic_blend
from runner.trajectories.trajectory import OfTip, Trajectory

__all__ = [
    "Bench",
    "Code",
    "Column",
    "Controller",
    "Curves",
    "Encoders",
    "Environment",
    "Formula",
    "Items",
    "Loop",
    "Map",
    "Maps",
    "MetricContext",
    "Notice",
    "OfTip",
    "Outcome",
    "Panel",
    "Plant",
    "PositionController",
    "PositionPlant",
    "Procedure",
    "Robot",
    "RobotModel",
    "RunSubject",
    "Section",
    "Series",
    "StrictModel",
    "SweepSubject",
    "Table",
    "Text",
    "TipSensor",
    "TipSensorConfig",
    "TorqueLaw",
    "TorquePlantConfig",
    "TorqueSensors",
    "Trace",
    "Trajectory",
    "WristSensor",
    "assemble_plant",
    "delay_limit",
    "distance_to_curve",
    "force_loop_limit",
    "quintic_blend",
    "scale_model",
    "units",
    "with_models",
]
