"""`make install` with an existing .venv; nothing here needs a network."""

import importlib.util
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from support.pages import ROOT

PINS = """\
numpy==2.1 ; python_full_version < '3.12' \\
    --hash=sha256:00
setuptools==84.2 \\
    --hash=sha256:01 \\
    --hash=sha256:02
uv==0.13 \\
    --hash=sha256:03
uv-build==1.0 \\
    --hash=sha256:04
"""


@pytest.fixture(scope="module")
def install():
    spec = importlib.util.spec_from_file_location("install", ROOT / ".ci" / "install.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def checkout(tmp_path):
    """A checkout with a .venv of this Python, its scripts naming where it is."""
    root = tmp_path / "check out"
    root.mkdir()
    (root / "pyproject.toml").write_text("pyproject.toml")
    (root / "constraints.txt").write_text(PINS)
    venv = root / ".venv"
    (venv / "bin").mkdir(parents=True)
    (venv / "bin" / "python").symlink_to(sys.executable)
    (venv / "bin" / "pip").write_text(
        f"#!/bin/sh\n'''exec' \"{venv}/bin/python3.11\" \"$0\" \"$@\"\n' '''\nimport sys\n"
    )
    return root


@pytest.fixture
def commands(install, monkeypatch):
    """The commands that would have been run, where Python writes bytecode."""
    monkeypatch.delenv("PYTHONDONTWRITEBYTECODE", raising=False)
    given = []
    monkeypatch.setattr(install, "run", lambda command, root: given.append(command[1:]))
    return given


def write_python(path, version):
    """Write what answers as a Python of a version does; as a shim of pyenv's without one where that is None."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.unlink(missing_ok=True)
    path.write_text("#!/bin/sh\nexit 127\n" if version is None else f"#!/bin/sh\necho {version}\n")
    path.chmod(0o755)
    return str(path)


def another_python(venv, version):
    write_python(venv / "bin" / "python", version)


def test_a_sound_venv_is_installed_into_once(install, checkout, commands):
    install.install(checkout, any_version=True)
    pip, uv = ["-m", "pip", "install"], ["pip", "install", "--quiet"]
    assert [command[:3] for command in commands] == [pip, pip, uv, uv]
    install.install(checkout, any_version=True)
    assert len(commands) == 4
    (checkout / "constraints.txt").write_text(PINS + "# newer\n")
    install.install(checkout, any_version=True)
    assert len(commands) == 8


def test_every_package_needs_a_known_digest_and_the_checkout_brings_none(install, checkout, commands):
    install.install(checkout, any_version=True)
    *packages, own = commands
    hashed = ["--require-hashes", "--no-build-isolation", "--requirement"]
    assert [command[-4:-1] for command in packages] == [hashed] * 3
    files = [Path(command[-1]).read_text() for command in packages[:2]]
    assert files == [PINS[PINS.index("setup") : PINS.index("uv==")], PINS[PINS.index("uv==") : PINS.index("uv-build")]]
    assert packages[2][-1] == "constraints.txt"
    assert own[-4:] == ["--no-deps", "--no-build-isolation", "--editable", "."]
    assert "--system-certs" in own  # as pip does, where a proxy has its own certificate


def test_without_uv_pip_installs_the_same(install, checkout, monkeypatch):
    given = []
    monkeypatch.delenv("PYTHONDONTWRITEBYTECODE", raising=False)

    def run(command, root):
        given.append(command[1:])
        if command[-1].endswith("uv.txt"):
            raise install.InstallError("no wheel of uv")

    monkeypatch.setattr(install, "run", run)
    install.install(checkout, any_version=True)
    assert [command[:3] for command in given] == [["-m", "pip", "install"]] * 4


def test_pins_without_what_builds_are_refused(install, checkout, commands):
    (checkout / "constraints.txt").write_text("uv==0.13\n")
    with pytest.raises(install.InstallError, match="pins no setuptools; `make pins` writes it anew"):
        install.install(checkout, any_version=True)


def test_bytecode_is_written_where_python_writes_none(install, checkout, commands, monkeypatch):
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    install.install(checkout, any_version=True)
    *_, packages, own, compiled = commands
    assert "--compile-bytecode" in packages
    assert "--compile-bytecode" in own
    assert compiled == ["-m", "compileall", "-q", "runner", "hydra_plugins"]


def test_every_pin_has_a_digest():
    pins = (ROOT / "constraints.txt").read_text()
    entries = re.split(r"^(?=[a-z])", pins, flags=re.M)[1:]
    assert len(entries) > 100
    assert all(re.match(r"[\w.-]+==\S+ .*\\\n(    --hash=sha256:[0-9a-f]{64}( \\)?\n)+$", entry) for entry in entries)
    names = {entry.partition("==")[0] for entry in entries}
    wanted = tomllib.loads((ROOT / "pyproject.toml").read_text())
    extras = wanted["project"]["optional-dependencies"]
    texts = [
        *wanted["project"]["dependencies"],
        *extras["dev"],
        *extras["docs"],
        *extras["bench"],
        *extras["ros"],
        "uv",
        "setuptools",
    ]
    assert {re.match(r"[\w.-]+", text)[0].lower() for text in texts} <= names


@pytest.mark.parametrize(
    ("name", "value", "place"),
    [("HOME", "", ""), ("XDG_CACHE_HOME", "cache", ""), ("UV_CACHE_DIR", "uv", "uv"), ("HOME", "made", "made")],
    ids=["home", "cache not made yet", "of uv", "home with something in it"],
)
def test_uv_keeps_what_it_fetched_if_it_can(install, checkout, commands, tmp_path, monkeypatch, name, value, place):
    for other in ("UV_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(other, raising=False)
    (tmp_path / place).mkdir(exist_ok=True)
    monkeypatch.setenv(name, str(tmp_path / value))
    for writable in (True, False):
        asked = []
        monkeypatch.setattr(install.os, "access", lambda path, mode, a=asked, w=writable: (a.append(path), w)[1])
        (checkout / "constraints.txt").write_text(f"{PINS}# {writable}\n")
        install.install(checkout, any_version=True)
        assert asked == [str(tmp_path / place)]
        assert ("--no-cache" in commands[-1]) is not writable


@pytest.mark.parametrize("fault", ["moved", "gone", "old", "other"])
def test_a_venv_that_cannot_stay_is_made_anew_and_says_why(install, checkout, commands, capsys, fault):
    if fault == "moved":
        checkout = checkout.rename(checkout.parent / "elsewhere")
    venv = checkout / ".venv"
    if fault == "gone":
        (venv / "bin" / "python").unlink()
    if fault in ("old", "other"):
        another_python(venv, "3 10" if fault == "old" else "3 99")
    with pytest.raises(FileNotFoundError):  # the stamp's folder: nothing is really made here
        install.install(checkout, any_version=fault != "other")
    assert commands[0] == ["-m", "venv", str(venv)]
    why = {"moved": "it was made in ", "gone": "its Python is gone", "old": "it has Python 3.10", "other": "3.99"}
    said = capsys.readouterr().err
    assert said.startswith("make install: .venv is made anew: ")
    assert why[fault] in said
    assert said.splitlines()[1].startswith("make install: Python 3.")
    assert said.count("\n") == 2


def test_another_version_stays_unless_one_is_asked_for(install, checkout, commands):
    another_python(checkout / ".venv", "3 99")
    install.install(checkout, any_version=True)
    assert commands[0][:3] == ["-m", "pip", "install"]


@pytest.fixture
def elsewhere(install, tmp_path, monkeypatch):
    """A machine with no Python but the running one, which calls itself 3.15, and those that a test writes."""
    (tmp_path / "bin").mkdir()
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    monkeypatch.setenv("PYENV_ROOT", str(tmp_path / "pyenv"))
    monkeypatch.setattr(install.sys, "version_info", (3, 15, 0))
    return tmp_path


def test_a_new_venv_gets_python_3_11_where_there_is_one(install, elsewhere):
    for version in ("3.14", "3.13", "3.12"):
        write_python(elsewhere / "bin" / f"python{version}", version.replace(".", " "))
    found = write_python(elsewhere / "bin" / "python3.11", "3 11")
    assert install.choose() == ((3, 11), found)
    assert install.describe((3, 11), found, True) == f"Python 3.11 ({found}): PyBullet has a wheel for it"


def test_a_shim_without_its_python_is_none_and_pyenv_s_newest_is_taken(install, elsewhere):
    write_python(elsewhere / "bin" / "python3.11", None)
    for version in ("3.11.9", "3.11.10", "3.11.2"):
        write_python(elsewhere / "pyenv" / "versions" / version / "bin" / "python3.11", "3 11")
    newest = elsewhere / "pyenv" / "versions" / "3.11.10" / "bin" / "python3.11"
    assert install.choose() == ((3, 11), str(newest))


def test_without_3_11_it_gets_the_newest_supported_and_says_what_is_left_out(install, elsewhere):
    for version in ("3.12", "3.13"):
        write_python(elsewhere / "bin" / f"python{version}", version.replace(".", " "))
    found = write_python(elsewhere / "bin" / "python3.14", "3 14")
    assert install.choose() == ((3, 14), found)
    assert install.describe((3, 14), found, True) == (
        f"Python 3.14 ({found}), as no Python 3.11 was found: PyBullet has no wheel for it and is left out; "
        "plant=bullet is compiled"
    )


def test_without_any_of_them_it_gets_the_running_one(install, elsewhere):
    assert install.choose() == ((3, 15), sys.executable)


def test_one_that_is_asked_for_is_named_so(install):
    assert install.describe((3, 12), "python3.12", False).startswith("Python 3.12 (python3.12), as asked for: ")
    assert (
        install.describe((3, 11), "python3", False)
        == "Python 3.11 (python3), as asked for: PyBullet has a wheel for it"
    )


@pytest.mark.parametrize(
    ("version", "found"), [((3, 10), "3.10"), ((3, 15), "3.15, for which pin (Pinocchio) has no wheel")]
)
def test_a_python_that_is_too_old_or_too_new_is_told_in_a_line(install, version, found):
    with pytest.raises(install.InstallError) as raised:
        install.require(version, "/usr/bin/python3")
    assert str(raised.value) == (
        f"Python 3.11 to 3.14 is needed, and /usr/bin/python3 is {found}; name another one, as in make install "
        "PYTHON=python3.11"
    )


def test_the_pythons_are_those_of_the_package_the_readme_and_ci(install):
    for version in install.SUPPORTED:
        install.require(version, "python")
    named = [f"3.{minor}" for _, minor in sorted(install.SUPPORTED)]
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    classifiers = [text.rpartition(" ")[2] for text in project["classifiers"] if ":: 3." in text]
    jobs = re.search(r"matrix: {python: \[(.*)\]}", (ROOT / ".github/workflows/ci.yml").read_text()).group(1)
    assert classifiers == re.findall(r'"(.*?)"', jobs) == named
    assert f"Python {named[0]} to {named[-1]}" in (ROOT / "README.md").read_text()


@pytest.mark.parametrize(
    "printed",
    [
        "WARNING: ... Failed to establish a new connection: [Errno -3] Temporary failure in name resolution",
        "error: Failed to fetch: `https://pypi.org/simple/numpy/`\n  Caused by: dns error",
        "ReadTimeoutError: Read timed out.",
    ],
)
def test_without_a_network_it_says_so_and_stops(install, checkout, monkeypatch, capsys, printed):
    tried = []

    def fail(command, **_):
        tried.append(command)
        return subprocess.CompletedProcess(command, 1, stdout=printed.encode())

    monkeypatch.setattr(install, "version_of", lambda _: sys.version_info[:2])
    monkeypatch.setattr(install.subprocess, "run", fail)
    monkeypatch.setattr(install, "ROOT", checkout)
    assert install.main(["--any-version"]) == 2
    assert len(tried) == 1
    last = capsys.readouterr().err.splitlines()[-1]
    assert last.startswith("make install: the packages cannot be fetched: is there a network?")


def test_make_hands_on_whether_a_version_was_asked_for():
    asked = {
        "": "python3 .ci/install.py --any-version",
        "PYTHON=python3.12": "python3.12 .ci/install.py ",
    }
    for argument, line in asked.items():
        words = ["make", "-n", "install", *([argument] if argument else [])]
        clean = {"PATH": os.environ["PATH"]}  # these tests may themselves be started by make
        assert subprocess.run(words, cwd=ROOT, env=clean, capture_output=True, text=True).stdout.strip() == line.strip()
