"""Imports of Python modules from a folder, with or without an installed package.

The path of the folder determines the package name of its modules.
"""

import hashlib
import importlib
import re
import sys
from importlib.machinery import ModuleSpec
from importlib.util import module_from_spec
from pathlib import Path
from types import ModuleType

from runner.base.errors import RunnerError, describe_part_error
from runner.base.paths import package_dir


def folder_module(folder: Path, name: str, package: str = "") -> ModuleType:
    """Return a module of a folder; relative imports in the module work.

    Args:
        folder: The folder.
        name: Name of the module, with dots for subfolders: "equations.derivations.arm".
        package: Name of the folder as an installed package, if it is one; not needed in folders of this package.

    Raises:
        RunnerError: if a module outside this package cannot be imported; the message contains the file and the line.
    """
    folder = folder.resolve()
    if folder.is_relative_to(package_dir()):
        parts = folder.relative_to(package_dir().parent).parts
        return importlib.import_module(f"{'.'.join(parts)}.{name}")
    try:
        return importlib.import_module(f"{package or _package_of(folder)}.{name}")
    except Exception as error:
        path = folder.joinpath(*name.split(".")).with_suffix(".py")
        raise RunnerError(f"{path} cannot be imported: {describe_part_error(error)}") from error


def _package_of(folder: Path) -> str:
    """Return the name of a namespace package for a folder, and add the package to `sys.modules`."""
    digest = hashlib.sha256(str(folder).encode()).hexdigest()[:12]
    name = f"{re.sub(r'[^0-9a-zA-Z]', '_', folder.name)}_{digest}"
    if name not in sys.modules:
        spec = ModuleSpec(name, None, is_package=True)
        spec.submodule_search_locations = [str(folder)]
        sys.modules[name] = module_from_spec(spec)
    return name
