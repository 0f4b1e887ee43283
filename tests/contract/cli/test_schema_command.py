"""`runner schema`: on standard output, and as a file."""

import json


def test_a_file_has_what_standard_output_shows(cli, tmp_path):
    shown = cli("schema", "controller")
    written = cli("schema", "controller", "--output", "schema.json")
    assert (shown.code, written.code, written.out) == (0, 0, "schema.json\n")
    assert (tmp_path / "schema.json").read_text() == shown.out
    assert json.loads(shown.out)["$schema"].startswith("https://json-schema.org/")
