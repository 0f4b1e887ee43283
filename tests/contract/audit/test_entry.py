"""Entries of audited equations: bad files name entry and key; ids and findings are valid."""

import re

import pytest

from runner.base.errors import RunnerError
from runner.papers.audit.entry import Entry, entries, left_side, parts
from runner.papers.audit.sources import sources
from runner.papers.expressions.parser import parse
from runner.papers.expressions.typesetting import typeset
from runner.reporting.markup import spans

GOOD = {"id": "a", "number": "1", "place": "p", "title": "t", "printed": {"math": "x"}}


@pytest.mark.parametrize(
    ("form", "message"),
    [
        ({}, "neither elements nor math"),
        ({"code": "xarm7.right_inverse"}, "neither elements nor math"),
        ({"elements": {"a": "1"}, "code": "xarm7.right_inverse"}, "has elements and code"),
        ({"elements": {"a": "1"}, "math": "a = 1"}, "has elements and math; what is shown is evaluated"),
        ({"elements": {"a +": "1"}}, "it ends too early"),
    ],
)
def test_a_form_is_evaluated_in_one_way(form, message):
    with pytest.raises(ValueError, match=message):
        Entry.model_validate(GOOD | {"printed": form})


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "symbols: b.c\nentries: [{number: 3.4, verdict: correct}]",
            r"bad.yaml: .*entries.0 \(3.4\).verdict: unknown key; keys: id, ",
        ),
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


MEASURE = re.compile(r"\d\s?(?:[mcµ]?m|kg|N|rad|degrees?|°|s|Hz|%)\b")


@pytest.mark.parametrize("source", sources())
def test_no_measure_is_typed_in_words(source):
    """`{largest}`, `{typical}` and `{size}` are filled in; what a source prints is mathematics."""
    found = [
        (entry.id, span.text)
        for _, entry in entries(source)
        for text in (entry.finding, entry.emendation.why if entry.emendation else "")
        for span in spans(text)
        if not span.math and MEASURE.search(span.text)
    ]
    assert found == []


@pytest.mark.parametrize("text", ["off by 0.35 m", "7.5 cm", "3N", "10 degrees", "0.1 kg are"])
def test_a_typed_measure_is_found(text):
    assert MEASURE.search(text)


@pytest.mark.parametrize("source", sources())
def test_the_mathematics_of_every_entry_is_valid(source):
    from runner.reporting import mathml

    texts = [
        text
        for _, entry in entries(source)
        for text in (entry.finding, entry.emendation.why if entry.emendation else "")
    ]
    inline = [span.text for text in texts for span in spans(text) if span.math]
    shown = []
    for part, entry in entries(source):
        letters = {**part.letters, **entry.letters}
        for form in (form for form in (entry.printed, entry.emendation, entry.corrected) if form):
            shown += [form.math] if form.math else []
            nodes = [parse(text).root for text in form.elements.values()] if form.readable else []
            shown += [typeset(node, letters=letters) for node in (*map(left_side, form.elements), *nodes)]
    images = mathml.mathml(list(dict.fromkeys(inline + shown)), displayed=False)
    assert [text for text, image in images.items() if image is None] == []
