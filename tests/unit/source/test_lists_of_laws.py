"""Places outside its module in which a built-in control law is named."""

import re

import pytest
from support.pages import ROOT

from runner.controllers.joint_space.joint_law import JointLawConfig
from runner.reporting.words import in_words
from tools.laws import ARM_LAWS, JOINT_LAWS, LAWS, OWN_OPTIONS, Law


def read(name):
    return (ROOT / name).read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def pages():
    """The pages with rows of laws; of docs/configs.md the options of the group."""
    names = ("docs/laws.md", "docs/reference.md")
    options = " ".join(re.findall(r"^\| `controller`, .*?\| (.*?) \|", read("docs/configs.md"), re.MULTILINE))
    return {name: read(name) for name in names} | {"docs/configs.md": options}


def missing(law, pages):
    """Return sentences about the places in which a law is missing."""
    own = {option.partition("=")[0] for option in OWN_OPTIONS.get(law.name, ())}
    others = law.keys - JointLawConfig.model_fields.keys() - {"kind"} if law.name in JOINT_LAWS else set()
    row = f"\n| `{law.name}`"
    wanted = {
        "a config, conf/controller/NAME.yaml": (ROOT / f"conf/controller/{law.name}.yaml").is_file(),
        "a title in runner/reporting/names.yaml": "_" not in in_words(law.name),
        f"{', '.join(sorted(others - own))} in OWN_OPTIONS of tools/laws.py": others <= own,
        "a row in docs/laws.md": (row if law.follows_joints else f"`{law.name}`") in pages["docs/laws.md"],
        "its name in the row `controller` of docs/configs.md": re.search(rf"\b{law.name}\b", pages["docs/configs.md"]),
        "a row in docs/reference.md, by `make record`": row in pages["docs/reference.md"],
    }
    return [f"{law.name} lacks {what}" for what, there in wanted.items() if not there]


def test_every_law_is_in_all_places(pages):
    found = [each for law in LAWS.values() for each in missing(law, pages)]
    assert not found, "\n".join(found)


def test_a_law_that_is_nowhere_is_named_with_each_place(pages, monkeypatch):
    monkeypatch.setattr("test_lists_of_laws.JOINT_LAWS", ("new_law",))
    law = Law("new_law", frozenset({"kind", "task", "own_gain"}), True, True, True)
    assert missing(law, pages) == [
        "new_law lacks a config, conf/controller/NAME.yaml",
        "new_law lacks a title in runner/reporting/names.yaml",
        "new_law lacks own_gain in OWN_OPTIONS of tools/laws.py",
        "new_law lacks a row in docs/laws.md",
        "new_law lacks its name in the row `controller` of docs/configs.md",
        "new_law lacks a row in docs/reference.md, by `make record`",
    ]


def test_laws_are_chosen_by_property():
    assert {name for name, law in LAWS.items() if law.flexible} == {"motor_pd"}
    assert {name for name, law in LAWS.items() if law.periodic} == {"iterative_learning"}
    assert {name for name, law in LAWS.items() if law.in_stages} == {"macro_mini"}
    assert {*ARM_LAWS} - {*JOINT_LAWS} == {"operational_space", "whole_body"}
    assert LAWS["motor_pd"].plant("rk4") == "rk4_flexible"
