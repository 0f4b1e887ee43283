"""Interface to llvmlite: availability, object code and loading."""

import ctypes
import importlib.util
import platform
from collections.abc import Callable
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Any

NAME = "llvmlite"
MOST_JOINTS = 12
"""Largest number of joints of a compiled arm; the code grows as their cube, and beyond it Pinocchio is as fast."""

Function = Callable[[ctypes.c_void_p], None]


@cache
def evaluator() -> dict[str, str]:
    """Return the library that evaluates compiled laws, with its version; empty if it is missing."""
    if importlib.util.find_spec(NAME) is None:
        return {}
    try:
        return {NAME: version(NAME)}
    except PackageNotFoundError:
        return {}


@cache
def processor() -> str:
    """Return the properties of the machine that machine code depends on; its results do not."""
    import llvmlite.binding as llvm

    return f"{platform.system()} {_target()[0].triple} {llvm.get_host_cpu_name()} {_features()}"


def machine_code(text: str) -> bytes:
    """Return the object file of a module of LLVM's intermediate representation."""
    import llvmlite.binding as llvm

    module = llvm.parse_assembly(text)
    module.verify()
    code: bytes = _target()[1].emit_object(module)
    return code


def load(code: bytes) -> Function:
    """Return the function `run` of an object file; its argument is the address of a frame.

    Raises:
        RuntimeError: if the file has no such function.
    """
    import llvmlite.binding as llvm

    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _target()[1])
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    address = engine.get_function_address("run")
    if not address:
        raise RuntimeError("no such function")
    _engines.append(engine)  # the code lives as long as its engine
    return ctypes.CFUNCTYPE(None, ctypes.c_void_p)(address)


_engines: list[Any] = []


@cache
def _target() -> tuple[Any, Any]:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_default_triple()
    machine = target.create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=_features(), opt=2, jit=True, codemodel="jitdefault"
    )
    return target, machine


def _features() -> str:
    import llvmlite.binding as llvm

    features: str = llvm.get_host_cpu_features().flatten()
    return features
