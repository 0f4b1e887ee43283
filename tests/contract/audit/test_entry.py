"""Entries of audited equations: bad files name entry and key; ids and findings are valid."""

import pytest

from runner.audit.entry import Entry, entries, parts
from runner.audit.sources import sources
from runner.base.errors import RunnerError
from runner.reporting.markup import spans

GOOD = {"id": "a", "number": "1", "place": "p", "title": "t", "printed": {"math": "x"}}


@pytest.mark.parametrize(
    ("form", "message"),
    [
        ({}, "neither elements nor math"),
        ({"code": "xarm7.right_inverse"}, "neither elements nor math"),
        ({"elements": {"a": "1"}, "code": "xarm7.right_inverse"}, "has elements and code"),
    ],
)
def test_a_form_is_evaluated_in_one_way(form, message):
    with pytest.raises(ValueError, match=message):
        Entry.model_validate(GOOD | {"printed": form})


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("symbols: b.c\nentries: [{number: 3.4, verdict: correct}]", r"bad.yaml: .*entries.0 \(3.4\).verdict: Extra"),
        ("entries: []", "bad.yaml: names no 'robot', so 'symbols' must name the function that draws the sample"),
        ("robot: macro\nentries: [{printed: {elements: {a: [1]}}}]", r"printed.elements.a: is \[1\]; allowed: an expr"),
        ("robot: [", "cannot read .*bad.yaml"),
    ],
)
def test_a_file_that_does_not_fit_names_entry_and_key(tmp_path, text, message):
    (tmp_path / "equations").mkdir()
    (tmp_path / "equations" / "bad.yaml").write_text(text)
    with pytest.raises(RunnerError, match=message):
        parts(tmp_path)


@pytest.mark.parametrize("source", sources())
def test_ids_are_unique_and_name_the_source(source):
    ids = [entry.id for _, entry in entries(source)]
    assert len(set(ids)) == len(ids) > 0
    assert all(part.source.name == source for part in parts(source))
    assert all(name.startswith(f"{source}-") for name in ids)


@pytest.mark.parametrize("source", sources())
def test_the_mathematics_of_every_finding_is_valid(source):
    from runner.reporting import formulas

    texts = [text for _, entry in entries(source) for text in (entry.finding, entry.repair.why if entry.repair else "")]
    inline = [span.text for text in texts for span in spans(text) if span.math]
    forms = [form for _, entry in entries(source) for form in (entry.printed, entry.repair, entry.corrected) if form]
    images = formulas.mathml(inline + [form.math for form in forms if form.math], displayed=False)
    assert [text for text, image in images.items() if image is None] == []
