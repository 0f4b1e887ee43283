"""Inventory of a source against the equations that are audited."""

import pytest

from runner.papers.audit import audit as module
from runner.papers.audit.audit import differences, inventory
from runner.papers.audit.entry import entries
from runner.papers.audit.sources import sources


@pytest.mark.parametrize("source", sources())
def test_every_equation_listed_is_audited_and_the_other_way_round(source):
    assert differences(source) == []


@pytest.mark.parametrize("source", sources())
def test_the_places_stand_in_one_order(source):
    listed = [place.place for place in inventory(source).places]
    assert len(set(listed)) == len(listed)
    assert {entry.place for _, entry in entries(source)} == set(listed)


def test_what_is_missing_is_named(monkeypatch):
    places = list(inventory("xarm7").places)
    places[1] = places[1].model_copy(update={"equations": [*places[1].equations, "q8"]})
    changed = inventory("xarm7").model_copy(update={"places": places})
    monkeypatch.setattr(module, "inventory", lambda where: changed)
    assert differences("xarm7") == ["Inverse kinematics, page 8: q8 is not audited"]
