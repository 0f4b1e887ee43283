"""Digests of stored files: what was written is read again, and every changed byte is found."""

import pytest

from runner.store.seal import SCHEMA, DamagedError, Lines, SchemaError, digest, read_file, read_json, sealed_json

CONTENT = {"a": 1.5, "b": ["text", None], "c": {"d": True}}


def test_a_sealed_text_is_read_as_it_was_given(tmp_path):
    path = tmp_path / "record.json"
    path.write_bytes(sealed_json(CONTENT))
    assert read_json(path, "make it again") == {"schema": SCHEMA, **CONTENT}


def test_every_changed_byte_is_found(tmp_path):
    path, whole = tmp_path / "record.json", sealed_json(CONTENT)
    for place in range(len(whole)):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
        with pytest.raises((DamagedError, SchemaError), match=str(path)):
            read_json(path, "make it again")


@pytest.mark.parametrize("content", [b"", b"[]", b"{}", b'{"schema": true}', b"\xff", b"[" * 100_000])
def test_what_is_no_record_is_damaged(tmp_path, content):
    (tmp_path / "record.json").write_bytes(content)
    with pytest.raises(DamagedError, match="make it again"):
        read_json(tmp_path / "record.json", "make it again")


def test_another_schema_is_named(tmp_path):
    (tmp_path / "record.json").write_text('{"schema": 2}')
    with pytest.raises(SchemaError, match=f"it has schema 2, and this version reads schema {SCHEMA}"):
        read_json(tmp_path / "record.json", "make it again")


def test_a_file_beside_a_record_has_the_digest_that_is_stored(tmp_path):
    path = tmp_path / "robot.urdf"
    path.write_bytes(b"arm")
    assert read_file(path, {path.name: digest(b"arm")}, "make it again") == b"arm"
    for files in ({}, {path.name: digest(b"army")}):
        with pytest.raises(DamagedError, match="another digest than stored; make it again"):
            read_file(path, files, "make it again")


def test_a_chain_of_lines_finds_what_is_changed_missing_or_moved():
    chain = Lines()
    lines = [chain.seal(text) for text in ("one", "two", "three")]
    joined = "".join(f"{line}\n" for line in lines).encode()
    assert list(Lines().read(joined)) == ["one", "two", "three"]
    assert list(Lines().read(joined[:-3])) == ["one", "two"]  # a half line at the end is none
    for wrong in ([lines[1]], [lines[0], lines[2]], [lines[0], lines[1].replace("two", "too")]):
        with pytest.raises(ValueError, match="has another digest than it says"):
            list(Lines().read("".join(f"{line}\n" for line in wrong).encode()))
