"""Numbers of sections, and blocks and formulas in reading order."""

import numpy as np
from support.sample_document import document

from runner.reporting import outline
from runner.reporting.document import Document, Formula, Section, Table, Text


def test_sections_are_numbered_by_their_place():
    made = Document("", "", "", [Section("a", [], [Section("b"), Section("c", [], [Section("d")])]), Section("e")], "")
    assert [(chapter.number, chapter.level) for chapter in outline.chapters(made)] == [
        ("1", 1),
        ("1.1", 2),
        ("1.2", 2),
        ("1.2.1", 3),
        ("2", 1),
    ]


def test_blocks_come_in_reading_order():
    kinds = [block.block for block in outline.blocks(document())]
    assert kinds[0] == kinds[-1] == "text"
    assert len(kinds) == 16


def test_formulas_of_every_text_are_found_once():
    blocks = [Text("$a$ and $a$"), Table("$b$", ["$c$"], [["$d$"]], prose=True), Formula("e")]
    displayed, inline = outline.formulas(Document("$no$", "", "$z$", [Section("$no$", blocks)], ""))
    assert displayed == ["e"]
    assert inline == ["z", "a", "b", "c", "d"]
    assert not np.isin("no", inline)
