"""Files of claims and statements of all studies."""

import pytest
import yaml

from runner.base.errors import RunnerError
from runner.base.paths import studies_with
from runner.papers.reporting import published_claims
from runner.papers.reporting.published_claims import CLAIMS, load_claims, load_statements


@pytest.fixture
def entries(tmp_path, monkeypatch):
    """The thesis' claims 1 to 5 as data, and a function that stores what was made of them."""
    monkeypatch.setattr(published_claims, "studies_dir", lambda: tmp_path)
    (tmp_path / "study").mkdir()

    def store(content):
        (tmp_path / "study" / "claims.yaml").write_text(yaml.safe_dump(content))

    return [each.model_dump() for each in THESIS[:5]], store


THESIS = load_claims("thesis")


@pytest.mark.parametrize("study", studies_with(CLAIMS))
def test_the_claims_of_a_study_are_numbered_in_order(study):
    assert [each.number for each in load_claims(study)] == list(range(1, len(load_claims(study)) + 1))


def test_the_statements_have_names_of_their_own():
    names = [each.name for each in load_statements("meca500")]
    assert len(names) == len(set(names)) == 7


def test_a_claim_that_does_not_fit_is_told_with_its_number(entries):
    content, store = entries
    store(content)
    assert load_claims("study") == THESIS[:5]
    del content[2]["place"]
    store(content)
    with pytest.raises(RunnerError, match=r"claims\.yaml: 2 \(3\)\.place: Field required"):
        load_claims("study")


def test_a_bound_by_a_claim_that_is_not_there_is_refused(entries):
    content, store = entries
    content[4]["bound"]["claim"] = 9
    store(content)
    with pytest.raises(RunnerError, match=r"claims\.yaml: claim 5: bound\.claim: there is no claim 9"):
        load_claims("study")
