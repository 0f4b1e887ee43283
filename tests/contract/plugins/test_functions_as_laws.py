"""A controller that is one function: its keys, its name, its hash, and what is wrong with it."""

import re
import sys

import numpy as np
import pytest

import runner
from runner.base.errors import ConfigError
from runner.papers.study.code import read_user_plugins
from runner.plugins import discovery
from runner.store import run_hash

LAWS = '''\
from math import sin


def pd(t, q, dq, desired, arm, kp=2000.0, kd=120.0):
    """Joint PD with gravity."""
    return kp * (desired.q - q) + kd * (desired.dq - dq) + arm.g(q)


def short(t, q, dq, desired, arm):
    return q[:2]


def endless(t, q, dq, desired, arm):
    return q / 0.0


def fails(t, q, dq, desired, arm):
    return q[7]


def writes(t, q, dq, desired, arm):
    desired.q[0] = 1.0
    return q


def joint_pd(t, q, dq, desired, arm):
    return q


number = 3
exec("def unread(t, q, dq, desired, arm): return q")
'''
RUN = ("robot=macro", "trajectory=quintic", "duration=0.05")


@pytest.fixture
def laws(tmp_path, monkeypatch, request):
    """Return the path of a module of laws with its own name, and forget its parts afterwards."""
    monkeypatch.setenv("RUNNER_PLUGINS", "")
    monkeypatch.setattr(sys, "path", [*sys.path])
    name = "laws_" + re.sub(r"\W", "_", request.node.name)
    path = tmp_path / f"{name}.py"
    path.write_text(LAWS)
    monkeypatch.chdir(tmp_path)
    yield path
    sys.modules.pop(name, None)


def plugin(path, name):
    return f"--plugin=controller={path.name}:{name}"


@pytest.mark.costs(2)
def test_a_sweep_compares_it_with_a_law_of_ours_and_over_its_keys(cli, laws):
    given = ("controller=pd,computed_torque", *RUN, "noise=thesis", "repetitions=6", "hydra.sweeper.workers=0")
    ending = cli("-m", plugin(laws, "pd"), *given)
    assert ending.code == 0, ending.err
    assert "computed_torque" in ending.err
    ending = cli("-m", plugin(laws, "pd"), "controller=pd", "controller.kp=500,1000", *RUN, "hydra.sweeper.workers=0")
    runs = runner.open_sweep(ending.folder)
    assert [runs.run(**{"controller.kp": kp}).config["controller"]["kp"] for kp in (500, 1000)] == [500, 1000]


def test_its_keys_are_those_of_the_motion_and_its_arguments(cli, laws):
    ending = cli(plugin(laws, "pd"), "controller=pd", *RUN, "controller.period=0.005", "controller.kp=1500")
    assert ending.code == 0, ending.err
    run = runner.open_run(ending.folder)
    config = run.config["controller"]
    assert (config["kind"], config["period"], config["kp"], config["kd"]) == ("pd", 0.005, 1500, 120.0)
    assert list(run.record["provenance"]["plugins"]) == [f"controller={laws.name}:pd"]
    assert f"--plugin controller={laws.name}:pd" in run.record["provenance"]["command"]
    ending = cli(plugin(laws, "pd"), "controller=pd", *RUN, "controller.kpp=1", "controller.kd=stiff")
    assert ending.code == 2
    assert "controller.kpp: unknown key (did you mean kp?)" in ending.err
    assert "controller.kd: must be a number; found 'stiff'" in ending.err


def test_a_joint_motion_reaches_it_as_it_is(cli, laws):
    ending = cli(plugin(laws, "pd"), "controller=pd", "robot=macro", "trajectory=joint_quintic", "duration=0.05")
    assert ending.code == 0, ending.err


def test_it_is_listed_with_its_docstring(cli, laws):
    assert "Joint PD with gravity." in cli("list", "controllers", plugin(laws, "pd")).out
    assert "no 'pdd' (did you mean pd?)" in cli(plugin(laws, "pd"), "controller=pdd", *RUN).err


def test_a_config_of_ones_own_comes_before_its_keys(cli, laws):
    (laws.parent / "mine/controller").mkdir(parents=True)
    text = "defaults: [/function_law@_here_, _self_]\nkind: pd\nkp: 700.0\nkd: 70.0\n"
    (laws.parent / "mine/controller/pd.yaml").write_text(text)
    ending = cli(plugin(laws, "pd"), "--config-dir=mine", "controller=pd", *RUN)
    assert ending.code == 0, ending.err
    assert runner.open_run(ending.folder).config["controller"]["kp"] == 700.0


def test_the_source_of_its_file_decides_about_the_runs_name(laws):
    discovery.use_plugins([f"controller={laws}:pd"])
    resolved = {"controller": {"kind": "pd"}}
    first = run_hash(resolved, "")
    other = laws.with_name("laws_edited.py")
    other.write_text(LAWS.replace("120.0", "130.0"))
    discovery.use_plugins([f"controller={other}:pd"])
    assert discovery.in_use() == (f"controller={other}:pd",)  # it replaces the earlier one
    assert run_hash(resolved, "") != first
    assert run_hash({"controller": {"kind": "joint_pd"}}, "") == run_hash({"controller": {"kind": "joint_pd"}}, "")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("short", "short ({file}, line 9) gave an array of shape (2,); it must be an array of shape (3,)"),
        ("endless", "endless ({file}, line 13) gave"),
        ("fails", "IndexError: index 7 is out of bounds for axis 0 with size 3 ({file}, line 18, in fails)"),
        ("writes", "read-only ({file}, line 22, in writes); a plug-in cannot change what it is given"),
    ],
)
@pytest.mark.filterwarnings("ignore:divide by zero", "ignore:invalid value")
def test_what_it_returns_is_checked_with_its_line(cli, laws, name, message):
    ending = cli(plugin(laws, name), f"controller={name}", *RUN)
    assert ending.code == 1
    assert message.format(file=laws.name) in ending.err


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("pdd", "unknown function in {file} 'pdd'. Allowed: pd, short,"),
        ("joint_pd", "controller.kind: 'joint_pd' is a built-in kind; rename your function"),
        ("number", "controller.kind: 'number' in {file} is not a Python function (found 3)"),
        ("sin", "controller.kind: 'sin' in {file} is not a Python function (found <built-in function sin>)"),
        ("unread", "controller.kind: the source of 'unread' is not in {file} (found unread (<string>, line 1))"),
    ],
)
def test_what_is_no_law_is_refused(cli, laws, name, message):
    ending = cli(plugin(laws, name), f"controller={name}", *RUN)
    assert ending.code == 2
    assert message.format(file=laws.name) in ending.err


def test_only_a_controller_can_be_a_function(cli, laws):
    ending = cli(f"--plugin=plant={laws.name}:pd", *RUN)
    assert ending.code == 2
    assert "only a controller can be a function; give plant=MODULE" in ending.err


def test_a_study_takes_it_without_a_config(laws):
    discovery.use_plugins([f"controller={laws}:pd"])
    (part,) = read_user_plugins(discovery.in_use())
    assert (part.name, part.override, part.folder, part.config_dirs) == ("pd", "controller=pd", laws.parent, ())
    assert part.options == ("--plugin", f"controller={laws.name}:pd")


GAIN = 3.0


def held(t, q, dq, desired, arm, push: np.float64 = 1.0):
    """Hold the joints."""
    return push * np.ones(len(q)) + arm.g(q)


def leaning(t, q, dq, desired, arm):
    return GAIN * q


@pytest.fixture
def typed(laws, monkeypatch):
    """Let the functions of this file look as if they were typed in a script or notebook."""
    for function in (held, leaning):
        monkeypatch.setattr(function, "__module__", "__main__")


def test_python_takes_a_function_of_a_script(typed):
    run = runner.run(*RUN, controller=held, controller__push=2.0)
    assert run.config["controller"]["push"] == 2.0
    assert run.status == "ok"
    (name,) = run.record["provenance"]["plugins"]
    assert name.endswith(":held")
    assert runner.run(*RUN, controller=held, controller__push=2.0).folder == run.folder


@pytest.mark.costs(2)
def test_python_sweeps_and_tunes_a_function(typed):
    sweep = runner.sweep(*RUN, controller=[held, "joint_pd"], workers=0)
    assert sweep.run(controller="held").config["controller"]["kind"] == "held"
    tuning = runner.tune(*RUN, controller=held, controller__push=(0.0, 1.0), trials=1, workers=0, minimize="energy")
    assert len(tuning.to_frame()) == 1


def test_python_takes_a_function_of_a_module_by_its_name(laws, monkeypatch):
    monkeypatch.syspath_prepend(laws.parent)
    module = __import__(laws.stem)
    run = runner.run(*RUN, controller=module.pd)
    assert list(run.record["provenance"]["plugins"]) == [f"controller={laws.stem}:pd"]


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (leaning, r"controller: leaning \(test_functions_as_laws.py, line \d+\) uses GAIN from outside"),
        (lambda t: t, r"controller: <lambda> has no source that can be read"),
        (abs, r"controller: abs has no source that can be read"),
    ],
)
def test_python_refuses_what_cannot_be_read(typed, function, message):
    with pytest.raises(ConfigError, match=message):
        runner.run(*RUN, controller=function)


def test_python_refuses_a_function_without_source(laws):
    space = {"__name__": "__main__"}
    exec("def unread(t, q, dq, desired, arm): return q", space)
    with pytest.raises(ConfigError, match=r"controller: the source of unread \(<string>, line 1\) cannot be read"):
        runner.run(*RUN, controller=space["unread"])


def test_the_source_of_another_text_is_not_taken(laws, monkeypatch):
    """Since Python 3.13 the text of `python -c` is found under <string>, which is the name of any exec."""
    space = {"__name__": "__main__"}
    exec("def unread(t, q, dq, desired, arm): return q", space)
    monkeypatch.setattr("inspect.getsource", lambda _: "import sys; print(sys.argv)\n")
    with pytest.raises(ConfigError, match=r"controller: the source of unread \(<string>, line 1\) cannot be read"):
        runner.run(*RUN, controller=space["unread"])
