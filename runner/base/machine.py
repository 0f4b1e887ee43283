"""Machine that made a result, as far as it decides the rounding of numbers, and the size of rounding differences.

NumPy, OpenBLAS and the C library choose their routines by the processor. Routines of one function differ in the last
bit, so equal configs can have metrics with other bits on another machine.
"""

import ctypes
import importlib
import math
import os
import platform
import time
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path

from runner.base import quantities

ROUNDING = 1e-6
"""Relative difference up to which two values of a metric are equal up to rounding."""

_LEVELS: Mapping[str, frozenset[str]] = {  # flags of /proc/cpuinfo that each level of the x86-64 psABI adds
    "x86-64-v2": frozenset(["cx16", "lahf_lm", "popcnt", "sse4_1", "sse4_2", "ssse3"]),
    "x86-64-v3": frozenset(["abm", "avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "movbe", "xsave"]),
    "x86-64-v4": frozenset(["avx512bw", "avx512cd", "avx512dq", "avx512f", "avx512vl"]),
}
_CORE_NAMES = ("scipy_openblas_get_corename64_", "openblas_get_corename64_", "openblas_get_corename")
_LABELS = {"glibc": "glibc ", "numpy": "NumPy ", "openblas": "OpenBLAS "}
_HWCAPS = "glibc.cpu.hwcaps="


@dataclass(frozen=True)
class Machine:
    """Parts of a machine that decide rounding; an unknown part is empty.

    Attributes:
        processor: Model name of the processor.
        system: Operating system and architecture.
        level: Highest level of x86-64 that the processor has, such as "x86-64-v3".
        glibc: Version of the GNU C library, and the setting that masks features of the processor.
        numpy: Features of the processor for which NumPy uses its own routines.
        openblas: Processor core for which NumPy's OpenBLAS uses its routines.
    """

    processor: str = ""
    system: str = ""
    level: str = ""
    glibc: str = ""
    numpy: str = ""
    openblas: str = ""

    @property
    def text(self) -> str:
        """All known parts in one line."""
        inner = self.in_words([name for name in _NAMES if name not in ("processor", "system")])
        return ", ".join(filter(None, [f"{self.processor} ({inner})" if inner else self.processor, self.system]))

    def in_words(self, names: Iterable[str]) -> str:
        """Return some known parts, such as "x86-64-v3, OpenBLAS Haswell"."""
        values = [(name, getattr(self, name)) for name in names]
        return ", ".join(f"{_LABELS.get(name, '')}{value}" for name, value in values if value)

    def record(self) -> dict[str, str]:
        """Return the parts by name, as they are stored."""
        return {name: getattr(self, name) for name in _NAMES}


_NAMES = tuple(field.name for field in fields(Machine))


@cache
def today() -> str:
    """Return the date as stored, such as "2026-11-24", in UTC."""
    return time.strftime("%Y-%m-%d", time.gmtime())


@cache
def this_machine() -> Machine:
    """Return the machine of this process."""
    system, processor = f"{platform.system()} {platform.machine()}", platform.machine()
    model, level = _processor()
    return Machine(model or processor, system, level, _glibc(), _numpy(), _openblas())


def read_machine(stored: object) -> Machine:
    """Return the machine of a record; one of an earlier version is a text with the processor and the system."""
    if isinstance(stored, str):
        processor, _, system = stored.rpartition(", ")
        return Machine(processor or system, system if processor else "")
    values = stored if isinstance(stored, Mapping) else {}
    return Machine(**{name: value for name in _NAMES if isinstance(value := values.get(name), str)})


def parts_apart(machines: Iterable[Machine]) -> list[str]:
    """Return the names of the parts that are known to differ between machines."""
    every = list(machines)
    return [name for name in _NAMES if len({getattr(machine, name) for machine in every} - {""}) > 1]


def describe_mixture(counts: Mapping[Machine, int]) -> str:
    """Return a sentence on runs of machines that are known to differ, from their number; empty if none do."""
    names = parts_apart(counts)
    if not names:
        return ""
    groups: Counter[str] = Counter()
    for machine, count in counts.items():
        groups[machine.in_words(names) or "an unknown machine"] += count
    counted = "; ".join(f"{count} run{'s' if count > 1 else ''} on {text}" for text, count in groups.most_common())
    return f"made on {len(groups)} machines, which may round differently: {counted}"


def equal_up_to_rounding(a: float | None, b: float | None) -> bool:
    """Return True if two values of a metric differ by no more than rounding; None is not a value."""
    return a == b if a is None or b is None else math.isclose(a, b, rel_tol=ROUNDING, abs_tol=quantities.ROUNDING)


def _processor() -> tuple[str, str]:
    """Return the model name of the processor and its level of x86-64, as Linux states them; empty elsewhere."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return "", ""
    pairs = [(name.strip(), value.strip()) for name, _, value in (line.partition(":") for line in reversed(lines))]
    values = dict(pairs)  # of the first processor
    return values.get("model name", ""), _level(values.get("flags", "").split())


def _level(flags: Iterable[str]) -> str:
    """Return the highest level of x86-64 whose flags, and those of the levels below, a processor has."""
    found, has = "", frozenset(flags)
    for level, needed in _LEVELS.items():
        if not needed <= has:
            break
        found = level
    return found


def _glibc() -> str:
    try:
        version = os.confstr("CS_GNU_LIBC_VERSION") or ""
    except (AttributeError, ValueError, OSError):  # another C library
        return ""
    masks = [text for text in os.environ.get("GLIBC_TUNABLES", "").split(":") if text.startswith(_HWCAPS)]
    return " ".join([version.removeprefix("glibc "), *masks])


def _numpy() -> str:
    try:
        core = importlib.import_module("numpy._core._multiarray_umath")
        return " ".join(name for name in core.__cpu_dispatch__ if core.__cpu_features__.get(name))
    except (ImportError, AttributeError):  # a later NumPy
        return ""


def _openblas() -> str:
    try:
        library = ctypes.CDLL(importlib.import_module("numpy.linalg._umath_linalg").__file__)  # and what it links to
    except (ImportError, OSError):
        return ""
    for name in _CORE_NAMES:
        function = getattr(library, name, None)
        if function is not None:
            function.restype = ctypes.c_char_p
            return (function() or b"").decode()
    return ""
