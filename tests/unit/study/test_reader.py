"""Chapters as Markdown with expressions: what they become, and what is refused with its place."""

import pytest

from runner.papers.study.measured import Measured
from runner.papers.study.prose import ProseError, read_chapter
from runner.reporting.document import Items, Section, Table, Text
from runner.reporting.markup import link_text, mark_text

TABLE = Table("Caption", ["a"], [["1"]])
NAMES = {
    "turns": Measured("error in turns", 5e-2, "m"),
    "both": Measured("error of both", 1e-6, "m"),
    "missing": Measured("time", None, "s"),
    "table": lambda: TABLE,
    "tables": lambda: [TABLE, TABLE],
    "x": 3.5,
    "evil": "<b>$x$ *a* [l](http://q) {{ 1 }} \ue000b\ue001 ::: finding",
}


def read(text, names=NAMES):
    return read_chapter("chapter.md", f"# Title\n\n{text}\n", names).section


def test_paragraphs_lists_and_sections_become_blocks():
    chapter = read(
        "One *word*.\n\n- a {{ x }}\n- b\n\n{{ table() }}\n\n## Below\n\nTwo.\n\n### Deeper\n\n{{ tables() }}"
    )
    assert chapter.title == "Title"
    assert chapter.blocks == (Text(f"One {mark_text('word', 'emphasis')}."), Items(("a 3.5", "b")), TABLE)
    (below,) = chapter.sections
    assert (below.title, below.blocks) == ("Below", (Text("Two."),))
    assert (below.sections[0].title, below.sections[0].blocks) == ("Deeper", (TABLE, TABLE))


def test_an_inserted_section_is_beside_those_of_the_chapter_and_within_no_other():
    names = {**NAMES, "section": lambda: Section("Inserted", (TABLE,))}
    chapter = read("## First\n\nOne.\n\n{{ section() }}\n\n## Second\n\nTwo.", names)
    assert [each.title for each in chapter.sections] == ["First", "Inserted", "Second"]
    assert chapter.sections[0].blocks == (Text("One."),)


def test_marks_and_mathematics_of_a_sentence():
    (text,) = read("`a_b` costs $5, $tau_1 = {{ x }}$ is *so*, see [a page](https://example.org/a_b).").blocks
    page = link_text("a page", "https://example.org/a_b")
    assert text == Text(
        f"{mark_text('a_b', 'code')} costs $$5, $tau_1 = 3.5$ is {mark_text('so', 'emphasis')}, see {page}."
    )


def test_values_have_their_unit():
    assert (
        read("It errs by {{ turns }}, {{ turns / both }} times more.").blocks[0].text
        == "It errs by 50 mm, 5.00·10⁴ times more."
    )


def test_lengths_and_times_of_a_sentence_have_one_unit_if_that_needs_no_power_of_ten():
    sizes = {"far": 0.109, "near": 4.31e-5, "nearest": 1.45e-8, "late": 0.25, "later": 0.03, "rounding": 1e-15}
    units = {"late": "s", "later": "s"}
    names = {name: Measured(name, value, units.get(name, "m")) for name, value in sizes.items()}

    def told(sentence):
        return read(sentence, names).blocks[0].text

    assert told("It is {{ far }}, then *{{ near }}*; later {{ near }}.") == (
        f"It is 109 mm, then {mark_text('0.0431 mm', 'emphasis')}; later 0.0431 mm."
    )
    assert told("{{ far }} and {{ nearest }}. Else {{ near }}, {{ nearest }}.") == (
        "0.109 m and 0.0145 µm. Else 43.1 µm, 0.0145 µm."
    )
    assert told("After {{ late }}, not {{ later }}, {{ far }}.") == "After 0.25 s, not 0.03 s, 0.109 m."
    assert told("{{ far }} and {{ rounding }}.") == "0.109 m and less than 1·10⁻¹² m."
    (title,) = read("## {{ far }} and {{ near }}\n\nSo.", names).sections
    assert title.title == "109 mm and 0.0431 mm"


def test_no_value_becomes_markup_a_block_or_an_expression():
    (text,) = read("Say {{ evil }} here.").blocks
    assert text.text == "Say <b>$$x$$ *a* [l](http://q) {{ 1 }} \ufffdb\ufffd ::: finding here."


def test_a_title_is_plain_text():
    chapter = read("## It costs $5, {{ evil }}\n\n::: finding A $5 box, {{ x }}\nSo.\nholds: turns > both\n:::")
    (section,) = chapter.sections
    assert section.title == "It costs $5, <b>$x$ *a* [l](http://q) {{ 1 }} \ufffdb\ufffd ::: finding"
    assert section.blocks[0].title == "A $5 box, 3.5"


def test_a_finding_has_its_conditions():
    words = "Turns do {{ turns }} harm\nThey err by {{ turns }}\nagainst {{ both }}."
    box = f"::: finding {words}\nholds: turns > 10 * both\n:::"
    (found,) = read(box).blocks
    assert found.holds
    assert (found.claim, found.sentences) == ("Turns do 50 mm harm", "They err by 50 mm against 1 µm.")
    assert [condition.text for condition in found.conditions] == ["error in turns > 10 times error of both"]
    (fallen,) = read(box.replace("> 10", "< 10")).blocks
    assert fallen.title == "No longer holds: Turns do 50 mm harm"
    (without,) = read(box.replace("turns > 10", "missing > 10")).blocks
    assert "time: has no value" in without.text


@pytest.mark.parametrize("kind", ["stands", "falls", "turns", "why"])
def test_an_answer_may_be_its_title_only_and_says_when_it_no_longer_holds(kind):
    box = f"::: {kind} Turns err by {{{{ turns }}}}.\nholds: turns > 10 * both\n:::"
    chapter = read(box)
    (found,) = chapter.answers
    assert (found.kind, found.title, found.text) == (kind, "Turns err by 50 mm.", "")
    (fallen,) = read(box.replace("> 10", "< 10")).answers
    assert (fallen.kind, fallen.title) == ("warning", "No longer holds: Turns err by 50 mm.")
    assert (
        fallen.text == "Not so: error in turns < 10 times error of both (error in turns: 50 mm; error of both: 1 µm)."
    )
    assert read(box.replace(f"::: {kind}", "::: finding").replace("holds", "So.\nholds")).answers == []


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("## The error is $a^2$", 3, r"'The error is \$a\^2\$': a title is plain text"),
        ("::: finding So is *it*\nSo.\nholds: turns > both\n:::", 3, r"'So is \*it\*': a title is plain text"),
        ("::: fnding A\nSo.\n:::", 3, r"no box 'fnding' \(did you mean finding\?\); boxes: finding, stands, falls"),
        ("::: stand A\n:::", 3, r"no box 'stand' \(did you mean stands\?\)"),
        ("::: why\n:::", 3, "a box without a title; write `::: why TITLE`"),
        ("::: why A\n:::", 3, "a finding without a condition"),
        ("::: finding A\nholds: turns > both\n:::", 3, "a finding contains only sentences"),
        ("::: finding\nSo.\n:::", 3, "a box without a title; write `::: finding TITLE`"),
        ("So.\n\n::: finding A\nSo.", 5, "a box that is not closed"),
        ("::: finding A\n::: finding B\n:::", 4, "a box in a box; close that of line 3"),
        ("So.\nholds: turns > both", 4, "a condition outside a box"),
        ("::: finding A\nSo.\n:::", 3, "a finding without a condition"),
        ("::: finding A\nSo.\nholds: x > 1\n:::", 5, "holds: x > 1: gives bool, no condition"),
        ("::: finding A\n{{ table() }}\nholds: turns > both\n:::", 3, "a finding contains only sentences"),
        ("{{\n1 }} a\n\n{{ turs }}", 6, r"turs: no name 'turs' \(did you mean turns\?\)"),
        ("{{ turns if x else both }}", 3, "chooses between words; a chapter has one branch"),
        ("{{ x and turns }}", 3, "chooses between words"),
        ("{{ x|upper }}", 3, "no name 'upper'"),
        ("{{ x + }}", 3, "is not an expression"),
        ("{{ x", 3, "{{ is not closed"),
        ("{% if x %}a{% endif %}", 3, "{% is not used here: a chapter has one branch and no loops"),
        ("{{ x.__class__ }}", 3, "a value of type float has no '__class__'"),
        ("{{ table.__globals__ }}", 3, "a value of type function has no '__globals__'"),
        ("{{ 'a' * 100000000 }}", 3, "cannot compute with str and int"),
        ("{{ 9 ** 9 ** 9 }}", 3, "has no value"),
        ("{{ 1 / 0 }}", 3, "has no value: division by zero"),
        ("So {{ table() }} it is", 3, "not Table; put a block in a separate paragraph"),
        ("{{ [1, 2] }}", 3, "a sentence takes texts, numbers and measured values, not list"),
        ("$a_{{ evil }}$", 3, "a formula takes numbers, not str"),
        ("1. a", 3, "a report has no numbered lists"),
        ("a\n\n> b", 5, "a report has no quotations"),
        ("    code", 3, "a report has no blocks of code"),
        ("![a](b.png)", 3, "a report has no images"),
        ("**a**", 3, r"a report has no strong emphasis \(write \*so\*\)"),
        ("# Other", 3, "a second title; sections of a chapter begin with ##"),
        ("### Deep", 3, "leaves out a level; write ## Deep"),
        ("a \ue000 b", 3, "has a character for private use"),
    ],
)  # fmt: skip
def test_what_cannot_be_read_is_told_with_its_line(text, line, message):
    with pytest.raises(ProseError, match=message) as told:
        read(text)
    assert told.value.line == line
    assert str(told.value).startswith(f"chapter.md:{line}: ")


def test_a_chapter_begins_with_its_title():
    with pytest.raises(ProseError, match=r"chapter.md:1: begins without a title; write `# Title`"):
        read_chapter("chapter.md", "Text.", NAMES)


@pytest.mark.parametrize("text", ["<b>a</b>", "[a](javascript:b)", "<script>a</script> b"])
def test_raw_html_and_code_in_addresses_are_shown_as_they_are(text):
    assert read(text).blocks == (Text(text),)
