"""Parts from outside the package, written to files and named as a user's are."""

import os
import sys
from textwrap import dedent

import pytest

from runner.plugins import use_plugins


@pytest.fixture
def own_part(tmp_path, monkeypatch):
    """Write a module and the YAML that chooses it, and use it; return the folder for --config-dir."""
    monkeypatch.delenv("RUNNER_PLUGINS", raising=False)
    monkeypatch.setattr(sys, "path", [*sys.path])
    folder, written = tmp_path / "own", []

    def write(group, name, module, keys=""):
        (folder / group).mkdir(parents=True, exist_ok=True)
        (folder / f"{name}.py").write_text(dedent(module))
        (folder / group / f"{name}.yaml").write_text(dedent(keys) + ("" if "kind:" in keys else f"kind: {name}\n"))
        written.append(name)
        use_plugins([f"{group}={folder / name}.py"])
        return folder

    yield write
    os.environ.pop("RUNNER_PLUGINS", None)
    for name in written:
        sys.modules.pop(name, None)
