"""L: the closed loop as C++ with Pinocchio's headers, against which compiled laws are measured.

The wheel of Pinocchio brings its headers and libraries; Eigen's and urdfdom's come with the extra `bench`. It is
compiled as CMake's Release does, -O3 -DNDEBUG, without -march=native: that gains nothing on arms of this size, and
the wheel's libraries, which read the URDF, are not made so.
"""

import ctypes
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from functools import cache
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pinocchio as pin

from bench.tip_loop import FloatArray, TipLoop

_SOURCE = Path(__file__).with_name("closed_loop.cpp")
# As the wheel was made; pinocchioTargets.cmake. Without its library's instantiations this takes minutes.
_DEFINED = (
    "PINOCCHIO_ENABLE_TEMPLATE_INSTANTIATION",
    "PINOCCHIO_WITH_URDFDOM",
    "BOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "BOOST_MPL_LIMIT_LIST_SIZE=30",
    "BOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "BOOST_FUSION_INVOKE_MAX_ARITY=12",
)
_HEADERS = ("", "eigen3", "urdfdom_headers", "urdfdom")


class MissingError(Exception):
    """Reason for a missing L."""


def least_loop(loop: TipLoop) -> tuple[Callable[[], None], FloatArray]:
    """Return a function that runs a closed loop in C++ with one Runge-Kutta step in a tick, and its log.

    Raises:
        MissingError: without a compiler or the headers.
    """
    library = _library()
    place = library.make(loop.urdf.encode(), loop.tip.encode(), loop.gravity)
    assert place, "Pinocchio in C++ cannot read the URDF"
    log, held = loop.log(), loop
    arrays = [loop.law, loop.held, loop.rest, loop.limits, loop.start, loop.desired, loop.errors]
    # Eigen's columns are NumPy's rows: position, velocity and acceleration of the tip.
    arrays = [np.ascontiguousarray(array, dtype=float) for array in arrays]

    def run() -> None:
        addresses = [array.ctypes.data for array in (*arrays, log)]
        library.run(place, held.ticks, held.tick, *addresses)

    return run, log


@cache
def _library() -> ctypes.CDLL:
    compiler = shutil.which("g++")
    prefix = Path(pin.__file__).parents[4]
    if compiler is None:
        raise MissingError("there is no g++")
    for header in ("pinocchio/algorithm/aba.hpp", "eigen3/Eigen/Core", "urdfdom_headers/urdf_model/model.h"):
        if not (prefix / "include" / header).is_file():
            raise MissingError(f"there is no {header}; pip install -e '.[bench]'")
    numbers = zip(("MAJOR", "MINOR", "PATCH"), version("cmeel-urdfdom-headers").split("."), strict=False)
    defined = [*_DEFINED, *(f"PINOCCHIO_URDFDOM_HEADERS_{name}_VERSION={number}" for name, number in numbers)]
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "closed_loop.so"
        command = [compiler, "-O3", "-DNDEBUG", "-std=c++17", "-shared", "-fPIC", *(f"-D{each}" for each in defined)]
        command += [*(f"-I{prefix / 'include' / name}" for name in _HEADERS), str(_SOURCE), "-o", str(target)]
        command += [f"-L{prefix / 'lib'}", f"-Wl,-rpath,{prefix / 'lib'}", "-lpinocchio_parsers", "-lpinocchio_default"]
        subprocess.run(command, check=True)
        library = ctypes.CDLL(str(target))
    library.make.restype = ctypes.c_void_p
    library.make.argtypes = [ctypes.c_char_p, ctypes.c_char_p, ctypes.c_double]
    library.run.restype = None
    library.run.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.c_double, *[ctypes.c_void_p] * 8]
    return library
