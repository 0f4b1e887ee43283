"""JSON of mappings with common parts: the text of `json.dumps`, and each common part encoded once."""

import json

import pytest

from runner.store import seal
from runner.store.seal import JsonTexts, encode_finite

SHARED = {"kind": "goal", "points": [0.1, 1e-300, -0.0], "name": "ä\n", "none": None}


def test_the_text_is_that_of_the_library():
    texts = JsonTexts()
    for seed in range(3):
        content = {"path": SHARED, "seed": seed, "other": SHARED, "empty": {}}
        assert texts.of(content) == json.dumps(content)
    assert texts.of({}) == json.dumps({})


def test_a_common_part_is_encoded_once(monkeypatch):
    encoded, encode = [], seal._encode
    monkeypatch.setattr(seal, "_encode", lambda value: encoded.append(value) or encode(value))
    texts = JsonTexts()
    for _ in range(3):
        texts.of({"path": SHARED})
    assert encoded.count(SHARED) == 1


def test_only_finite_numbers_have_a_text():
    assert encode_finite(0.1) == "0.1"
    with pytest.raises(ValueError, match="not JSON compliant"):
        encode_finite([float("nan")])
