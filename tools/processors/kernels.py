"""Kernels of other processors, chosen by the environment of a process; and what this machine cannot emulate.

OpenBLAS, NumPy, glibc and LLVM each choose their code by the processor. `environment` makes them choose that of another
one, so that the digits are those of that processor. Compiled libraries without such a choice (Pinocchio, PyBullet,
MuJoCo) have one form of code for all.
"""

import os
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

LLVM_CPU = "RUNNER_TOOLS_LLVM_CPU"
"""Variable that names the processor for LLVM, which has none. `use_llvm_cpu` reads it."""


@dataclass(frozen=True)
class Kernel:
    """A processor to emulate.

    Attributes:
        openblas: Core for OPENBLAS_CORETYPE.
        numpy_without: Groups of instructions that NumPy must not dispatch to.
        glibc_without: Instructions that glibc's libm must not use.
        llvm: Name of the processor for LLVM.
    """

    openblas: str
    numpy_without: Sequence[str]
    glibc_without: Sequence[str]
    llvm: str


_AVX512 = ("AVX512F", "AVX512VL", "AVX512DQ", "AVX512BW", "AVX512CD")
KERNELS: Mapping[str, Kernel] = {
    "skylakex": Kernel("SkylakeX", ("AVX512_ICL", "AVX512_SPR"), (), "skylake-avx512"),
    "haswell": Kernel("Haswell", ("X86_V4", "AVX512_ICL", "AVX512_SPR"), _AVX512, "haswell"),
    "nehalem": Kernel(
        "Nehalem", ("X86_V3", "X86_V4", "AVX512_ICL", "AVX512_SPR"), ("AVX", "AVX2", "FMA", *_AVX512), "nehalem"
    ),
}


def environment(name: str) -> dict[str, str]:
    """Return the variables that a process needs for a kernel, to be added to those of this one."""
    kernel, dispatched = KERNELS[name], _dispatched()
    return {
        "OPENBLAS_CORETYPE": kernel.openblas,
        "NPY_DISABLE_CPU_FEATURES": " ".join(group for group in kernel.numpy_without if group in dispatched),
        "GLIBC_TUNABLES": "glibc.cpu.hwcaps=" + ",".join(f"-{each}" for each in kernel.glibc_without),
        LLVM_CPU: kernel.llvm,
    }


def not_emulated(name: str) -> list[str]:
    """Return the parts of a kernel that this machine cannot emulate."""
    if platform.machine() != "x86_64":
        return [f"{name}: this machine is {platform.machine()}, not x86_64"]
    missing = []
    if name == "skylakex" and "X86_V4" not in _dispatched():
        missing.append(f"{name}: this processor has no AVX-512")
    if platform.libc_ver()[0] != "glibc":
        missing.append(f"{name}: libm of {platform.libc_ver()[0] or 'an unknown C library'} has no tunables")
    return missing


def use_llvm_cpu() -> None:
    """Let LLVM compile for the processor in the environment, with all that it has."""
    if cpu := os.environ.get(LLVM_CPU):
        import llvmlite.binding as llvm

        llvm.get_host_cpu_name = lambda: cpu
        llvm.get_host_cpu_features = lambda: llvm.FeatureMap()


def _dispatched() -> set[str]:
    """Return the groups of instructions that NumPy dispatches to here."""
    from numpy._core import _multiarray_umath as numpy

    return {group for group in numpy.__cpu_dispatch__ if numpy.__cpu_features__.get(group)}
