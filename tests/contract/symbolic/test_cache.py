"""Compiled code in the user's cache folder: found again, and not where others can write."""

import os
import resource
import stat
import sys
from pathlib import Path

import numpy as np
import pytest

from runner.base import cache
from runner.plants.compiled_motion import CompiledStep
from runner.robots.description import find_urdf, read_urdf
from runner.robots.model import RobotModel
from runner.symbolic import program

MACRO = RobotModel(read_urdf(find_urdf("macro.urdf"), {}), "tip")


@pytest.fixture
def place(code_cache):
    program._program.cache_clear()
    return code_cache


@pytest.fixture
def compilations(monkeypatch):
    """One entry for each compilation."""
    counted, compile_ = [], program.machine_code
    monkeypatch.setattr(program, "machine_code", lambda text: counted.append(1) or compile_(text))
    return counted


def stepped():
    state = np.array([0.3, 0.5, -0.4, 1.0, 0.5, -0.5])
    CompiledStep(MACRO, 0.01).advance(state, np.array([5.0, -3.0, 2.0]), 3)
    return state


def test_code_is_compiled_once_and_found_by_the_next_process(place, compilations):
    first = stepped()
    (file,) = place.iterdir()
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    program._program.cache_clear()  # as in its own process
    np.testing.assert_array_equal(stepped(), first)
    assert len(compilations) == 1


@pytest.mark.parametrize(
    "damage",
    [
        lambda code: code[:-1],
        lambda code: b"",
        lambda code: b"{}\n" + code[70:],
        lambda code: code.replace(b'"state": 6', b'"state": 5'),
    ],
)
def test_damaged_code_is_compiled_again(place, damage, compilations):
    first = stepped()
    (file,) = place.iterdir()
    whole = file.read_bytes()
    assert damage(whole) != whole
    file.write_bytes(damage(whole))
    program._program.cache_clear()
    np.testing.assert_array_equal(stepped(), first)
    assert len(compilations) == 2


def test_who_waits_at_a_terminal_is_told(place, capsys, monkeypatch):
    stepped()
    assert capsys.readouterr().err == ""
    program._program.cache_clear()
    next(place.iterdir()).unlink()
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    stepped()
    assert "compiling the motion of 3 joints" in capsys.readouterr().err


@pytest.mark.parametrize("mode", [0o770, 0o707, 0o1777])
def test_a_folder_that_others_can_write_is_not_used(place, mode):
    place.chmod(mode)
    assert cache.folder() is None
    place.chmod(0o700)
    assert cache.folder() == place
    place.parent.chmod(0o777)
    assert cache.folder() is None
    assert cache.read("any") is None
    cache.write("any", b"code", {})
    place.parent.chmod(0o700)
    assert list(place.iterdir()) == []


def test_a_folder_that_others_can_write_is_told_once(place, capsys):
    place.chmod(0o770)
    for _ in range(2):
        assert cache.read("any") is None
    told = f"runner: compiled code is not kept: {place}, or a folder above it, can be changed by other users\n"
    assert capsys.readouterr().err == told


@pytest.mark.parametrize("mode", [0o620, 0o602])
def test_a_file_that_others_can_write_is_not_used(place, mode):
    cache.write("key", b"code", {})
    (place / "key").chmod(mode)
    assert cache.read("key") is None
    (place / "key").chmod(0o644)
    assert cache.read("key") == (b"code", {})


def test_code_under_the_name_of_other_code_is_not_used(place):
    cache.write("one", b"code of one", {})
    (place / "one").rename(place / "two")
    assert cache.read("two") is None


def test_a_folder_or_a_file_of_somebody_else_is_not_used(place, monkeypatch):
    cache.write("key", b"code", {"errors": ["text"]})
    assert cache.read("key") == (b"code", {"errors": ["text"]})
    monkeypatch.setattr(os, "getuid", lambda: 12345)
    assert cache.folder() is None
    assert cache.read("key") is None


def test_without_a_folder_code_is_kept_in_the_process_alone(tmp_path, monkeypatch):
    file = tmp_path / "file"
    file.write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(file))
    program._program.cache_clear()
    assert cache.folder() is None
    assert np.isfinite(stepped()).all()
    assert Path(file).read_text() == ""


def test_a_file_that_cannot_be_written_whole_leaves_nothing(place):
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        cache.write("a", b"0" * 5000, {})
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert list(place.iterdir()) == []
    cache.write("a", b"0" * 5000, {})
    assert cache.read("a") == (b"0" * 5000, {})
