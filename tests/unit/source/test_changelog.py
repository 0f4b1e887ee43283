"""Entries of the changelog: short, and only what a user notices."""

import re
from pathlib import Path

TEXT = (Path(__file__).resolve().parents[3] / "CHANGELOG.md").read_text(encoding="utf-8")
MOST_WORDS = 12


def test_no_entry_has_more_words_than_a_reader_takes_in():
    entries = re.findall(r"^- (.+(?:\n  .+)*)", TEXT, re.M)
    assert len(entries) > 100
    code_as_a_word = [re.sub(r"`[^`]*`", "code", entry) for entry in entries]
    assert [entry for entry in code_as_a_word if len(entry.split()) > MOST_WORDS] == []
