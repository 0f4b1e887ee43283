"""Config folder to start from: a robot's YAML file and its repaired URDF, or its MJCF."""

import json
from pathlib import Path

import yaml

from runner.base.arrays import FloatArray
from runner.base.atomic import write_atomically
from runner.base.errors import RunnerError, StoreError
from runner.config.json_schema import json_schema
from runner.doctor.examination import Examination
from runner.robots.joint_dynamics import FileDynamics

_ROBOT = """\
# @package _global_
# yaml-language-server: $schema=../schema.json
# {name}, {joints} joints, from {source} by runner doctor
defaults:
  - override /controller: {controller}
  - override /trajectory: quintic

robot:
  name: {name}
  {format}: {file}
  tip: {tip}  # the frame that is controlled
  home: {home}  # {units}
{dynamics}  goal: {goal}  # m, tip position where quintic, line and goal go
  path_size: {path_size}  # m, of a circle and the like
  natural_frequency: {natural_frequency}  # rad/s, of its controller
  settling_band: {settling_band}  # m, on each axis
"""


def write_folder(examination: Examination, folder: Path) -> list[Path]:
    """Write `robot/NAME.yaml` and `robots/NAME.urdf`, or an unchanged MJCF, with its files, if nothing is fixed.

    It also writes `schema.json`, with which an editor completes the keys of the YAML file.

    Raises:
        RunnerError: if the arm is refused, one of the files exists already, or they cannot be written.
    """
    if examination.arm is None:
        raise RunnerError("--output: nothing was written: first correct what is refused above")
    model, start = examination.arm.model, examination.arm.start
    name = examination.name
    format, arm = _arm_files(examination, name)
    text = _ROBOT.format(
        name=name,
        format=format,
        file=next(iter(arm)),
        joints=model.nq,
        controller="operational_space" if examination.arm.has_mass else "differential_inverse_kinematics",
        source=" ".join(examination.source.name.split()),
        tip=yaml.safe_dump(examination.tip).removesuffix("...\n").strip(),
        home=_list(start.home),
        units=" ".join(dict.fromkeys(model.joint_units)) if len(set(model.joint_units)) == 1 else
        ", ".join(model.joint_units),
        dynamics=_dynamics(examination.arm.dynamics),
        goal=_list(start.goal),
        path_size=_digits(0.05 * model.reach),
        natural_frequency=start.natural_frequency,
        settling_band=_digits(0.002 * model.reach),
    )  # fmt: skip
    files = {folder / "robot" / f"{name}.yaml": text.encode()}
    files |= {folder / "robots" / file: content for file, content in arm.items()}
    there = [str(path) for path in files if path.exists()]
    if there:
        raise RunnerError(f"--output: {', '.join(there)} exists already; choose another folder, or remove it")
    try:
        for path, content in files.items():
            write_atomically(path, content)
        write_atomically(folder / "schema.json", f"{json.dumps(json_schema(), indent=1)}\n".encode())
    except StoreError as error:
        for path in filter(Path.is_file, files):
            path.unlink()
        raise RunnerError(f"--output: {error}; nothing was written") from error
    return list(files)


def _arm_files(examination: Examination, name: str) -> tuple[str, dict[str, bytes]]:
    """Return the key that names the arm's file, and its files by their place in `robots/`, the one named first."""
    mjcf = examination.mjcf
    if mjcf is None or any(finding.grade == "fixed" for finding in examination.findings):
        return "urdf", {f"{name}.urdf": f"{examination.urdf}\n".encode()}
    folder = examination.source.resolve().parent
    files = [file.resolve() for file in mjcf.files]
    return "mjcf", {file.relative_to(folder).as_posix(): file.read_bytes() for file in files}


def _dynamics(given: FileDynamics) -> str:
    """Return the lines of armature and friction that the file gives the joints."""
    lines = []
    if given.armature.any():
        lines.append(f"  armature: {_list(given.armature)}  # kg m^2, of the file\n")
    if given.damping.any() or given.friction.any():
        lines.append("  friction:  # of the file\n")
        lines.append(f"    viscous: {_list(given.damping)}  # N m s/rad, its damping\n")
        lines.append(f"    coulomb: {_list(given.friction)}  # N m\n")
    return "".join(lines)


def _list(values: FloatArray) -> str:
    return f"[{', '.join(repr(float(value)) for value in values)}]"


def _digits(value: float) -> float:
    return float(f"{value:.2g}")
