"""Control laws given as Python functions: each becomes a plug-in, so that worker processes and run hashes know it."""

import __future__

import builtins
import dis
import hashlib
import inspect
import sys
from collections.abc import Iterator, Mapping
from textwrap import dedent
from types import CodeType, FunctionType, ModuleType
from typing import Any

from runner.base import cache
from runner.base.atomic import write_atomically
from runner.base.errors import ConfigError
from runner.plugins.discovery import use_plugins
from runner.plugins.guard import place

_KEY = "controller"
_FUTURE = "from __future__ import annotations"  # so that they need no imports
_NO_ANNOTATIONS = __future__.annotations.compiler_flag


def use_functions(values: Mapping[str, object]) -> dict[str, object]:
    """Return keyword overrides in which `controller` has the names of its functions, which become plug-ins.

    A function of an imported module is used from there. Any other function, such as one of a notebook or of the script
    that runs, is copied with the imports that it needs to a file in the user's cache folder, named by its content.

    Raises:
        ConfigError: if the source of a function cannot be read, or uses variables other than modules.
        RunnerError: see use_plugins.
    """
    given = values.get(_KEY)
    if isinstance(given, list | tuple):
        return {**values, _KEY: [_use(each) for each in given]}
    return {**values, _KEY: _use(given)} if _KEY in values else dict(values)


def _use(given: Any) -> object:
    """Return the name of a function, which becomes a plug-in; any other value is returned unchanged."""
    if not callable(given):
        return given
    name = getattr(given, "__name__", repr(given))
    if not (inspect.isfunction(given) and name.isidentifier()):
        raise ConfigError(f"{_KEY}: {name} has no source that can be read. Define a function by `def`")
    module = sys.modules.get(given.__module__)
    imported = given.__module__ != "__main__" and vars(module or builtins).get(name) is given
    use_plugins([f"{_KEY}={given.__module__ if imported else _copy(given)}:{name}"])
    return name


def _copy(function: FunctionType) -> str:
    """Return the path of a file with a copy of a function and the imports that it needs."""
    name, where = function.__name__, place(function)
    try:
        source = dedent(inspect.getsource(function))
        code = compile(source, name, "exec", flags=_NO_ANNOTATIONS)
        if name not in {each.co_name for each in code.co_consts if isinstance(each, CodeType)}:
            raise OSError  # the line of another text with the same file name, such as that of `python -c` since 3.13
    except (OSError, TypeError, SyntaxError):
        raise ConfigError(f"{_KEY}: the source of {where} cannot be read. Write the function in a file") from None
    known = {**function.__globals__, **inspect.getclosurevars(function).nonlocals}
    used = sorted(set(_globals(code)) - {name} - set(vars(builtins)))
    modules = {each: known[each].__name__ for each in used if isinstance(known.get(each), ModuleType)}
    if others := [each for each in used if each not in modules]:
        raise ConfigError(
            f"{_KEY}: {where} uses {', '.join(others)} from outside. Allowed: arguments with defaults and "
            "imported modules. Or write it in a file and import it"
        )
    text = "\n".join([_FUTURE, *(f"import {module} as {each}" for each, module in modules.items()), "", "", source])
    folder = cache.folder()
    if folder is None:
        raise ConfigError(f"{_KEY}: {name} cannot be copied to the cache folder. Write it in a file and import it")
    path = folder / f"{name}_{hashlib.sha256(text.encode()).hexdigest()[:12]}.py"
    write_atomically(path, text.encode())
    return str(path)


def _globals(code: CodeType) -> Iterator[str]:
    """Yield the global names that a module and its functions read."""
    for each in dis.get_instructions(code):
        if each.opname in ("LOAD_NAME", "LOAD_GLOBAL"):
            yield each.argval
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            yield from _globals(inner)
