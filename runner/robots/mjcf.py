"""MJCF import: an arm in MuJoCo's format, converted to a URDF, with notes on unsupported elements."""

import threading
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from runner.base.errors import ConfigError
from runner.base.sanitize import few
from runner.robots.mjcf_files import asset_files, follow_includes
from runner.robots.mjcf_motors import MotorLimits, motor_limits
from runner.robots.mjcf_urdf import (
    HOME,
    ON_JOINTS,
    actuator_name,
    dynamics_of,
    efforts_of,
    free_joints,
    home_of,
    is_motor,
    joint_name,
    other_ties,
    take_out_ties,
    write_urdf,
)
from runner.robots.model import STANDARD_GRAVITY
from runner.robots.tree import parse_xml

_LOCK = threading.Lock()  # MuJoCo has one global warning handler
_KEPT = 8
_read: dict[Path, tuple[list[tuple[int, int]], "Mjcf"]] = {}


@dataclass(frozen=True)
class LeftOut:
    """Omitted content of an MJCF.

    Attributes:
        motion: Messages about content that would change the motion, each with an equivalent value of the key `gravity`,
            or "" if there is none.
        rest: Messages about other content.
    """

    motion: Mapping[str, str]
    rest: tuple[str, ...]


@dataclass(frozen=True)
class Mjcf:
    """Converted MJCF.

    Attributes:
        urdf: URDF of the bodies, joints and sites.
        ties: Constrained joints with their constraints; see UrdfTree.
        home: Joint positions of the keyframe `home`, in rad or m; empty without this keyframe.
        left_out: Omitted content.
        files: The MJCF itself, its included files, and its existing meshes.
    """

    urdf: str
    ties: Mapping[str, str]
    home: Mapping[str, float]
    left_out: LeftOut
    files: tuple[Path, ...]


def read_mjcf(path: Path) -> Mjcf:
    """Read an MJCF as compiled by MuJoCo, with its defaults, includes, frames, angles, and inertias from shapes.

    Recent results are cached until their files change.

    Raises:
        ConfigError: if the file is not an MJCF, MuJoCo rejects it, it refers to files outside its folder, a mesh with
            mass is missing, or it has unsupported elements.
    """
    if path in _read and _read[path][0] == _stamps(_read[path][1].files):
        return _read[path][1]
    if len(_read) >= _KEPT:
        _read.clear()
    mjcf = _convert(path)
    _read[path] = _stamps(mjcf.files), mjcf
    return mjcf


def _stamps(files: Iterable[Path]) -> list[tuple[int, int]]:
    """Return the modification time and the size of each file; zeros for a missing file."""
    stats = [file.stat() if file.exists() else None for file in files]
    return [(0, 0) if stat is None else (stat.st_mtime_ns, stat.st_size) for stat in stats]


def _convert(path: Path) -> Mjcf:
    texts = follow_includes(path)
    with _caught_warnings() as said:
        try:
            spec = mujoco.MjSpec.from_file(str(path.resolve()))
        except (ValueError, RuntimeError, mujoco.FatalError) as error:
            raise _refused(path, error) from error
        _refuse(path, refused_parts(spec))
        slim = spec.copy()
        ties = take_out_ties(slim)
        _leave_shapes_that_weigh(slim)
        _refuse(
            path, _listed("height fields that weigh", slim.hfields, "give their body an <inertial>, or take them out")
        )
        meshes, missing = asset_files(path, spec.meshdir, _asset_names(spec), _asset_names(slim))
        try:
            model = slim.compile()
        except (ValueError, RuntimeError, mujoco.FatalError) as error:
            raise _refused(path, error) from error
    _refuse(path, refused_model(model))
    motors = motor_limits(model, [parse_xml(text, "robot.mjcf") for text in texts])
    efforts, of_efforts = efforts_of(model, motors)
    lost = {**_of_gravity(spec), **dict.fromkeys((*_of_motion(spec, model), *_of_motors(model, motors)), "")}
    urdf, renamed = write_urdf(spec.modelname, model, efforts, dynamics_of(model), lost)
    warned = (f"MuJoCo's warning: {text.strip()}" for text in dict.fromkeys(said))
    rest = (*of_efforts, *renamed, *_of_rest(spec, model), *missing, *warned)
    tied = dict((*other_ties(model), *((joint.id, text) for joint, text in ties)))
    named = {joint_name(model, joint): text for joint, text in tied.items()}
    return Mjcf(urdf, named, home_of(spec, model), LeftOut(lost, rest), (*texts, *meshes))


def _asset_names(spec: Any) -> list[str]:
    """Return the file names of the meshes and height fields of a specification."""
    names = [asset.file for asset in (*spec.meshes, *spec.hfields)]
    return [Path(name).name for name in names] if spec.strippath else names


def _refuse(path: Path, problems: Iterator[str]) -> None:
    told = [f"robot.mjcf: {path} {problem}" for problem in problems]
    if told:
        raise ConfigError(told)


def _refused(path: Path, error: Exception) -> ConfigError:
    return ConfigError(f"robot.mjcf: {path}: MuJoCo does not take it: {' '.join(str(error).split())}")


def _leave_shapes_that_weigh(spec: Any) -> None:
    """Remove from a specification everything without effect on bodies and joints, so that its files are not read."""
    spec.compiler.fusestatic = False
    lowest, highest = spec.compiler.inertiagrouprange
    by_shape = spec.compiler.inertiafromgeom == mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE
    for geom in spec.geoms:
        geom.material = ""
        body, weighs = geom.parent, lowest <= geom.group <= highest
        if not weighs or body.name == "world" or (body.explicitinertial and not by_shape):
            spec.delete(geom)
    for site in spec.sites:
        site.material = ""
    lists = (spec.sensors, spec.pairs, spec.excludes, spec.keys, spec.skins, spec.materials, spec.textures,
             spec.cameras, spec.lights, spec.tuples)  # fmt: skip
    for element in [element for elements in lists for element in elements]:
        spec.delete(element)
    used = {name for geom in spec.geoms for name in (geom.meshname, geom.hfieldname)}
    for mesh in (*spec.meshes, *spec.hfields):
        if (mesh.name or Path(mesh.file).stem) not in used:
            spec.delete(mesh)
    spec.memory = spec.nstack = spec.njmax = spec.nconmax = -1  # sizes of memory
    spec.nkey = spec.nuserdata = 0
    for name in ("body", "jnt", "geom", "site", "cam", "tendon", "actuator", "sensor"):
        setattr(spec, f"nuser_{name}", -1)
    for element in (*spec.bodies, *spec.joints, *spec.geoms, *spec.sites, *spec.actuators):
        element.userdata = []


@contextmanager
def _caught_warnings() -> Iterator[list[str]]:
    """Capture MuJoCo's warnings within the context; otherwise it would write them to a file in the working folder."""
    said: list[str] = []
    with _LOCK:
        before = mujoco.get_mju_user_warning()
        mujoco.set_mju_user_warning(said.append)
        try:
            with warnings.catch_warnings(record=True) as of_python:
                warnings.simplefilter("always")
                yield said
            said += [str(warning.message) for warning in of_python]
        finally:
            mujoco.set_mju_user_warning(before)


def refused_parts(spec: Any) -> Iterator[str]:
    """Yield a message about each kind of unsupported element in a specification, with names and a remedy."""
    yield from _listed("mocap bodies", [b for b in spec.bodies if b.mocap], "take them out")
    balls = [joint for joint in spec.joints if joint.type == mujoco.mjtJoint.mjJNT_BALL]
    yield from _listed("ball joints", balls, "the joints of an arm are hinges and slides")


def refused_model(model: Any) -> Iterator[str]:
    """Yield a message about each unsupported property of a compiled model, with names and a remedy."""
    if not model.njnt:
        yield "has no joint: it is not an arm"
    yield from _joints(model, ~np.isfinite(model.qpos0), "a ref that is not finite:", "give a number")


def _of_gravity(spec: Any) -> dict[str, str]:
    x, y, z = spec.option.gravity.tolist()
    if spec.option.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY:
        return {"gravity switched off by a flag (gravity=0)": repr(0.0)}
    key = "" if x or y or z > 0.0 else repr(-z)
    return {} if key == repr(STANDARD_GRAVITY) else {f"gravity of {x:g}, {y:g}, {z:g} m/s^2 (gravity, along -z)": key}


def _of_motion(spec: Any, model: Any) -> Iterator[str]:
    for curve, text, name in (
        (model.dof_dampingpoly, "damping that grows with the speed", partial(joint_name, model)),
        (model.actuator_dampingpoly, "damping of actuators that grows with the speed", partial(actuator_name, model)),
    ):
        if curve.any():
            yield f"{text}: {few([name(index) for index in np.flatnonzero(curve.any(axis=1)).tolist()])}"
    afloat = [body.name or "one without a name" for body in spec.bodies if body.gravcomp]
    if afloat:
        yield f"gravity compensation (gravcomp) of the bodies {few(afloat)}, which weigh here"
    free = [joint.parent.name or "one without a name" for joint in free_joints(spec)]
    if free:
        yield f"free joints of the bodies {few(free)}, which stand still here"
    option = spec.option
    for text, value in (("density", option.density), ("viscosity", option.viscosity)):
        if value:
            yield f"{text} of the air of {value:g} in SI units"
    if np.any(option.wind):
        yield f"wind of {', '.join(f'{value:g}' for value in option.wind)} m/s"


def _of_motors(model: Any, motors: Mapping[int, MotorLimits]) -> Iterator[str]:
    """Yield a message about the back-EMF of direct-current motors, which bounds the speed of their joints."""
    speeds: dict[str, list[str]] = {}
    for actuator, limits in motors.items():
        value = "not given" if limits.no_load_speed is None else f"{limits.no_load_speed:.6g}"
        speeds.setdefault(value, []).append(actuator_name(model, actuator))
    for value, names in speeds.items():
        unit = "its voltage is" if value == "not given" else "no-load speed of the joint in SI units"
        yield f"back-EMF of the dc motors {few(names)} (torque_limits.no_load_speed): {unit} {value}"


def _of_rest(spec: Any, model: Any) -> Iterator[str]:
    servos = [actuator_name(model, actuator) for actuator in range(model.nactuator) if not is_motor(model, actuator)]
    servos += [
        actuator.name or "one without a name" for actuator in spec.actuators if actuator.trntype not in ON_JOINTS
    ]
    if servos:
        names = few(servos)
        yield f"gains, dynamics and transmissions of the actuators {names}: controllers command the joints"
    shapes = len(spec.geoms)
    if shapes:
        yield f"shapes ({shapes}): no wall touches them, and the arm is drawn by its joints"
    for text, elements in (
        ("sensor", spec.sensors), ("camera", spec.cameras), ("light", spec.lights),
        ("contact pair", spec.pairs), ("contact exclusion", spec.excludes),
        ("other keyframe", [key for key in spec.keys if key.name != HOME]),
    ):  # fmt: skip
        if len(elements):
            yield f"{len(elements)} {text}{'s' if len(elements) > 1 else ''}"
    if spec.option.disableflags or spec.option.enableflags:
        yield "flags of <option>"
    usual = mujoco.MjSpec().option
    if (spec.option.timestep, spec.option.integrator) != (usual.timestep, usual.integrator):
        yield "time step and integrator (plant.step, plant.integrator)"


def _listed(text: str, elements: Sequence[Any], remedy: str) -> Iterator[str]:
    if len(elements):
        yield f"holds {text}: {few([_called(element) for element in elements])}; {remedy}"


def _called(element: Any) -> str:
    if element.name:
        return f"'{element.name}'"
    on = getattr(getattr(element, "parent", None), "name", "")
    return f"one of the body '{on}'" if on else "one without a name"


def _joints(model: Any, which: NDArray[np.bool_], text: str, remedy: str) -> Iterator[str]:
    if which.any():
        names = [f"'{joint_name(model, joint)}'" for joint in np.flatnonzero(which).tolist()]
        yield f"holds {text} {few(names)}; {remedy}"
