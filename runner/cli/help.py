"""Help of the command line, and the names of the commands."""

from collections.abc import Mapping, Sequence

HELP = """\
runner: config-driven experiments for robot-arm control, with reports

  runner [run] robot=macro trajectory=goal       one run; its key metrics, and as the last line its folder
  runner -m robot=macro,mini noise.position=1e-4,1e-3
                                                 a sweep over every combination, also `runner sweep ...`; again, it
                                                 makes what is missing
  runner status DIR                              how far a sweep is
  runner tune OVERRIDES --minimize METRIC        choose numbers, as in controller.period="interval(0.005,0.05)"
  runner reproduce [thesis|xarm7|meca500|audit|all|FOLDER]
                                                 run what is missing and write the report of a study
  runner report DIR... [--html] [--pdf]          a report from stored runs or sweeps
  runner table DIR [--format latex|markdown|csv|parquet] [--metrics A,B] [--by KEY,KEY]
                                                 a sweep as one table, or a table for a paper
  runner figures DIR [--width single|double|MM]  each figure of a report as SVG, PDF and CSV
  runner verify [DIR]                            is all in an outputs folder as it was written?
  runner check DIR [--baseline FILE]             compare every metric with a baseline; --save-baseline FILE writes that
                                                 of a sweep
  runner compare A B...                          runs or sweeps side by side: what differs, every metric in pairs;
                                                 compare SWEEP --by controller: the levels of an axis
  runner sensitivity RUN [--metrics A,B] [--parameters gains,masses,...] [--finite-differences]
                                                 which parameter a run's metrics depend on most, by exact derivatives
  runner study new FOLDER                        write a first study of your own, to reproduce another paper;
                                                 check FOLDER looks through it, diff OLD NEW compares two versions
  runner benchmark check LAW.py [--profile P]    does a law of yours fit in the benchmark, and how long will it take?
  runner calibrate [OVERRIDES]                   calibrate tool or sensor against the truth: calibration=gravity
  runner audit URDF --tip FRAME --jacobian FILE  your own formulas against a robot; also --position, --mass-matrix,
                                                 --gravity
  runner doctor FILE [--tip FRAME] [--name NAME] [-o DIR] [--format config,html]
                                                 does a robot of yours fit, what to mend, and a config to start from
  runner example DIR                             copy the examples: an arm, a controller, a paper, a notebook
  latest                                         in place of a DIR: the run, sweep, tuning or report made or found last
  runner list [robots|controllers|trajectories|experiments|plants|environments|wrist_sensors|mismatch|noise|presets|
               torque_limits|calibrations|metrics|claims|baselines|studies]

  runner --cfg job [OVERRIDES]                   show the composed config without running it
  runner --config-dir DIR OVERRIDES              take YAML and URDFs from your own folder, too
  runner --plugin controller=FILE.py OVERRIDES   take a controller, trajectory, plant, environment or metric from your
                                                 own module; again for the next one
  runner --hydra-help                            all flags of Hydra
  eval "$(runner -sc install=bash)"              tab completion (also fish, zsh)

Groups: robot, controller, trajectory, plant, environment, wrist_sensor, mismatch, noise, torque_limits, preset,
experiment. A value is set by its dotted key, as in controller.period=0.005; `runner --cfg job` shows all keys. Exit
codes: 0 good, 1 a run failed or a check fell short, 2 bad input.
"""
GUIDE = """\
runner: experiments on the control of robot arms; a line of text makes a run, a sweep or a report

  runner robot=macro trajectory=quintic          one run; its key metrics and its folder are told
  runner report latest                           a report on it, HTML and PDF
  runner -m robot=macro controller.period=5ms,10ms
                                                 a sweep over every combination
  runner list                                    robots, controllers, trajectories, metrics and studies there are
  runner doctor FILE                             does a URDF or MJCF of yours fit?

All commands: runner --help. All keys of a run: runner --cfg job. The pages are in docs/ of the source, docs/tutorial.md
first.
"""
COMMANDS = (
    "reproduce", "report", "table", "figures", "status", "tune", "verify", "check", "compare", "sensitivity",
    "calibrate", "audit", "benchmark",
    "doctor", "list", "study", "example",
)  # fmt: skip
SPELLED_OUT: Mapping[str, Sequence[str]] = {"run": (), "sweep": ("-m",)}
"""Words before overrides that name what overrides make, with the flags that each stands for."""
