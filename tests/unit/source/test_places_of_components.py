"""Places outside its module in which a built-in law, sensor, metric or section is named."""

import re

import pytest
from support.pages import ROOT

from runner.caveats.time_constants import _parts
from runner.config.compose.files import group_options
from runner.config.groups import GROUPS
from runner.controllers import CONTROLLERS
from runner.plugins.metric_units import METRICS
from runner.plugins.registry import Kinds
from runner.reporting.metric_titles import TITLES
from runner.reporting.words import in_words
from runner.sensing import ENDPOINT_SENSORS, JOINT_TORQUE_SENSORS, NOISES, WRIST_SENSORS
from tools.laws import ARM_LAWS, JOINT_LAWS, LAWS, Law, own_options

SENSORS = (NOISES, WRIST_SENSORS, JOINT_TORQUE_SENSORS, ENDPOINT_SENSORS)
UNTIMED = ("impedance",)
"""Laws without a known time constant."""


def read(name):
    return (ROOT / name).read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def pages():
    """The pages with rows of laws and sensors; of docs/configs.md the options by group."""
    names = ("docs/laws.md", "docs/realism.md", "docs/reference.md")
    rows = re.findall(r"^\| `(\w+)`.*?\| (.*?) \|", read("docs/configs.md"), re.MULTILINE)
    options = {group: " ".join(text for other, text in rows if other == group) for group, _ in rows}
    return {name: read(name) for name in names} | {"docs/configs.md": options}


def lacks(name, wanted):
    return [f"{name} lacks {what}" for what, there in wanted.items() if not there]


def missing(law, pages):
    """Return sentences about the places in which a law is missing."""
    row = f"\n| `{law.name}`"
    timed = law.name in UNTIMED or (law.name in LAWS and CONTROLLERS.config_model(law.name) in _parts.registry)
    wanted = {
        "a config, conf/controller/NAME.yaml": (ROOT / f"conf/controller/{law.name}.yaml").is_file(),
        "a title in runner/reporting/names.yaml": "_" not in in_words(law.name),
        "its time constant in runner/caveats/time_constants.py": timed,
        "a row in docs/laws.md": (row if law.follows_joints else f"`{law.name}`") in pages["docs/laws.md"],
        "its name in the row `controller` of docs/configs.md": is_in(law.name, pages["docs/configs.md"]["controller"]),
        "a row in docs/reference.md, by `make record`": row in pages["docs/reference.md"],
    }
    return lacks(law.name, wanted)


def missing_of_sensor(group, kind, is_default, pages):
    """Return sentences about the places in which a kind of sensor is missing."""
    options = [kind] if not is_default else [*group_options(group)]
    wanted = {
        f"a config, conf/{group}/NAME.yaml": all((ROOT / f"conf/{group}/{name}.yaml").is_file() for name in options),
        f"its name in the row `{group}` of docs/configs.md": all(
            is_in(name, pages["docs/configs.md"][group]) for name in options
        ),
        "a section in docs/realism.md": is_default or f"`{group}={kind}`" in pages["docs/realism.md"],
    }
    return lacks(f"{group} {kind}", wanted)


def missing_of_metric(name, family, titles):
    """Return sentences about the places in which a metric of a family is missing."""
    wanted = {
        "a title in runner/reporting/names.yaml": name in titles,
        "a unit in UNITS": name in family.UNITS,
        "a line in the docstring of evaluate": is_in(name, family.evaluate.__doc__),
    }
    return lacks(name, wanted)


def is_in(name, text):
    return re.search(rf"\b{name}\b", text) is not None


def test_every_law_is_in_all_places(pages):
    found = [each for law in LAWS.values() for each in missing(law, pages)]
    assert not found, "\n".join(found)


def test_a_law_that_is_nowhere_is_named_with_each_place(pages):
    assert missing(Law("new_law", frozenset({"kind", "task", "own_gain"}), True, True, True), pages) == [
        "new_law lacks a config, conf/controller/NAME.yaml",
        "new_law lacks a title in runner/reporting/names.yaml",
        "new_law lacks its time constant in runner/caveats/time_constants.py",
        "new_law lacks a row in docs/laws.md",
        "new_law lacks its name in the row `controller` of docs/configs.md",
        "new_law lacks a row in docs/reference.md, by `make record`",
    ]


def test_every_sensor_is_in_all_places(pages):
    found = [
        each
        for kinds in SENSORS
        for kind in kinds.names()
        for each in missing_of_sensor(kinds.group, kind, kind == kinds.default, pages)
    ]
    assert not found, "\n".join(found)


def test_a_sensor_that_is_nowhere_is_named_with_each_place(pages):
    assert missing_of_sensor("noise", "resolver", False, pages) == [
        "noise resolver lacks a config, conf/noise/NAME.yaml",
        "noise resolver lacks its name in the row `noise` of docs/configs.md",
        "noise resolver lacks a section in docs/realism.md",
    ]


def test_every_metric_is_in_all_places():
    names = [(name, family) for family in METRICS.built_in() for name in family.UNITS]
    found = [each for name, family in names for each in missing_of_metric(name, family, TITLES)]
    assert not found, "\n".join(found)


def test_a_metric_that_is_nowhere_is_named_with_each_place():
    assert missing_of_metric("new_metric", METRICS.built_in()[0], TITLES) == [
        "new_metric lacks a title in runner/reporting/names.yaml",
        "new_metric lacks a unit in UNITS",
        "new_metric lacks a line in the docstring of evaluate",
    ]


def test_every_module_of_a_kind_is_in_its_registry():
    registries = [kinds for kinds in GROUPS.values() if isinstance(kinds, Kinds)]
    known = {module.__file__ for kinds in registries for module in kinds.built_in()}
    folders = {path.rsplit("/runner/", 1)[1].split("/")[0] for path in known}
    assert {"controllers", "environments", "plants", "sensing", "trajectories"} <= folders
    defining = [
        path
        for folder in sorted(folders)
        for path in (ROOT / "runner" / folder).rglob("*.py")
        if re.search(r"^CONFIG = ", path.read_text(encoding="utf-8"), re.MULTILINE)
    ]
    lost = [path.relative_to(ROOT).as_posix() for path in defining if str(path) not in known]
    assert not lost, f"no line of a registry names {', '.join(lost)}"


def test_every_section_of_a_sweep_is_listed():
    folder = ROOT / "runner" / "reporting" / "sweep"
    lists = [folder / "report.py", folder / "tuning.py"]
    listing = "".join(path.read_text(encoding="utf-8") for path in lists)
    functions = [
        f"{path.stem}.section" if name == "section" else name
        for path in folder.glob("*.py")
        for name in re.findall(r"^def ([a-z]\w*_section|section)\(", path.read_text(encoding="utf-8"), re.MULTILINE)
    ]
    assert {"caveats_section", "effects.section"} <= {*functions}
    lost = [name for name in functions if not is_in(name, listing)]
    assert not lost, f"no list of sections names {', '.join(lost)}; see DETAILS in runner/reporting/sweep/report.py"


def test_laws_are_chosen_by_property():
    assert {name for name, law in LAWS.items() if law.flexible} == {"motor_pd"}
    assert {name for name, law in LAWS.items() if law.periodic} == {"iterative_learning"}
    assert {name for name, law in LAWS.items() if law.in_stages} == {"macro_mini"}
    assert {*ARM_LAWS} - {*JOINT_LAWS} == {"operational_space", "whole_body"}
    assert LAWS["motor_pd"].plant("rk4") == "rk4_flexible"


def test_options_of_a_law_are_its_own_keys_with_other_values():
    assert own_options("joint_pid") == ["integral_share=0.25", "anti_windup=false"]
    assert own_options("computed_torque") == ["integral_gain=1.0"]
    assert own_options("joint_pd") == ["inertia=posture"]
