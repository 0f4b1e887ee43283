"""MJCF import: an arm in MuJoCo's format, converted to a URDF."""

import threading
import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco

from runner.base.errors import ConfigError
from runner.robots.mjcf_files import asset_files, follow_includes
from runner.robots.mjcf_joints import dynamics_of, efforts_of, home_of, other_ties, take_out_ties
from runner.robots.mjcf_losses import LeftOut, left_out, refused_model, refused_parts, refused_shapes
from runner.robots.mjcf_urdf import joint_name, write_urdf

_LOCK = threading.Lock()  # MuJoCo has one global warning handler
_KEPT = 8
_read: dict[Path, tuple[list[tuple[int, int]], "Mjcf"]] = {}


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
        _refuse(path, refused_shapes(slim))
        meshes, missing = asset_files(path, spec.meshdir, _asset_names(spec), _asset_names(slim))
        try:
            model = slim.compile()
        except (ValueError, RuntimeError, mujoco.FatalError) as error:
            raise _refused(path, error) from error
    _refuse(path, refused_model(model))
    efforts, of_efforts = efforts_of(model)
    lost = left_out(spec, model)
    urdf, renamed = write_urdf(spec.modelname, model, efforts, dynamics_of(model), lost.motion)
    rest = (
        *of_efforts,
        *renamed,
        *lost.rest,
        *missing,
        *(f"MuJoCo's warning: {text.strip()}" for text in dict.fromkeys(said)),
    )
    tied = dict((*other_ties(model), *((joint.id, text) for joint, text in ties)))
    named = {joint_name(model, joint): text for joint, text in tied.items()}
    return Mjcf(urdf, named, home_of(spec, model), LeftOut(lost.motion, rest), (*texts, *meshes))


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
