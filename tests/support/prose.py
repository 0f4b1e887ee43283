"""Prose of source files by line: text and comments without code.

Code is exempt: names in backticks, fenced blocks, expressions of chapters, placeholders such as `{name}`, keys of YAML,
names of arguments in docstrings, and a string of one word.
"""

import io
import re
import token
import tokenize
from collections.abc import Iterator
from pathlib import Path

_TEXTS = {token.STRING, token.COMMENT, getattr(token, "FSTRING_MIDDLE", token.STRING)}  # the last from Python 3.12
_TICKS = r"(``+)[^`]+\1|`[^`]+`"
_PLACEHOLDER = r"\{(?:[^{}]|\{[^{}]*\})*\}"
_ARGUMENT = r"(?m:^ +\w+:(?= ))"
_CHAPTER = r"(?ms:^```.*?^```|^holds: [^\n]*$|\{%.*?%\}|\{\{.*?\}\}|<!--.*?-->|\]\([^)\n]*\))"
_YAML_KEY = r"(?m:^\s*(?:- )?[\w. /-]+:(?=\s|$))"


def prose(file: Path) -> Iterator[tuple[int, str]]:
    """Yield the number, counted from 1, and the prose of each line of a file."""
    text = file.read_text(encoding="utf-8")
    for first, part in _of_python(text) if file.suffix == ".py" else [(1, _of_page(text, file.suffix))]:
        for number, line in enumerate(part.split("\n"), first):
            if line.strip():
                yield number, line


def _of_python(text: str) -> Iterator[tuple[int, str]]:
    for each in tokenize.generate_tokens(io.StringIO(text).readline):
        if each.type in _TEXTS and " " in each.string.strip("\"'# "):
            yield each.start[0], _without(each.string, _TICKS, _PLACEHOLDER, _ARGUMENT)


def _of_page(text: str, suffix: str) -> str:
    return _without(text, _CHAPTER, _TICKS, _PLACEHOLDER, *([_YAML_KEY] if suffix == ".yaml" else []))


def _without(text: str, *codes: str) -> str:
    """Return a text whose code is an ellipsis, on the same lines."""
    for code in codes:
        text = re.sub(code, lambda found: "…" + "\n" * found[0].count("\n"), text)
    return text
