"""The JSON decoder: values as of Python's own, and nesting that is refused before it is decoded."""

import json

import pytest

from runner.base.bounded_json import DEPTH, decode_json


def nested(depth, start="[", end="]", inside=""):
    return start * depth + inside + end * depth


@pytest.mark.parametrize(
    "text",
    [
        "{}",
        "[1, 2.5, null, true]",
        '"[[["',
        r'{"a\\": "\"[", "b": ["\\u005b{"], "": {}}',
        "[" + "[[]]," * 500 + "1]",
        " 3 ",
    ],
)
def test_values_are_those_of_json(text):
    assert decode_json(text) == decode_json(text.encode()) == json.loads(text)


@pytest.mark.parametrize(("start", "end"), [("[", "]"), ('{"a":', "}"), ('[3,"]",', "]"), ('["\\"",', "]")])
def test_the_deepest_text_that_is_read(start, end):
    assert decode_json(nested(DEPTH, start, end, "1")) == json.loads(nested(DEPTH, start, end, "1"))
    with pytest.raises(ValueError, match=f"nested deeper than {DEPTH} levels"):
        decode_json(nested(DEPTH + 1, start, end, "1"))


@pytest.mark.parametrize(
    "text", ["[" * 1_000_000, '{"a":' * 100_000, "[{" * 500, nested(2000), ("[" * 1000).encode("utf-16")]
)
def test_what_no_decoder_would_survive_is_refused_on_every_python(text):
    with pytest.raises(ValueError, match="nested deeper"):
        decode_json(text)


@pytest.mark.parametrize("text", ["", "[", '{"a": "', "]" * 500, "[}", '"' + "[" * 500, "[1, 2", b"\xff"])
def test_what_is_not_json_is_refused_as_by_json(text):
    with pytest.raises(ValueError, match=r"Expecting|Unterminated|Extra|decode|Illegal|delimiter"):
        decode_json(text)
