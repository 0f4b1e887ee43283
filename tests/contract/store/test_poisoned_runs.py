"""Runs that another user forged, digests included: too much is refused, and no text of theirs is more than text."""

import csv
import itertools
import shutil

import pytest
import yaml

from runner.store import write_sweep
from runner.store.seal import digest, sealed_json

HOSTILE = {
    "html": "<script>alert(1)</script>",
    "formula": "=cmd|'/C calc'!A0",
    "formula with @": "@SUM(1)",
    "formula with -": "-2+3|x",
    "terminal": "\x1b[31mred\x1b]0;t\x07",
    "latex": r"\input{/etc/passwd}$^%#",
    "typst": '#image("/etc/passwd")',
    "markdown": "a|b`c`[x](javascript:1)",
    "lines": "a\nb\r=1+1",
}
TEXT = " ".join(HOSTILE.values())
NAMES = "abcdefgh"
BOMB = "a: &a [1, 1]\n" + "".join(
    f"{name}: &{name} [{', '.join([f'*{before}'] * 9)}]\n" for before, name in itertools.pairwise(NAMES)
)


@pytest.fixture
def forged(runs, tmp_path):
    """Copy a stored run, change its record and its config, and make its digests right."""

    def forge(name, record=None, config=None, place="a"):
        run = runs[name]
        folder = shutil.copytree(run.folder, tmp_path / place / "runs" / run.hash)
        text = yaml.dump(dict(run.config), sort_keys=False) if config is None else config
        (folder / "config.yaml").write_text(text)
        files = dict(run.record["files"]) | {"config.yaml": digest(text.encode())}
        content = {key: value for key, value in {**run.record, **(record or {})}.items() if key != "schema"}
        (folder / "metrics.json").write_bytes(sealed_json({**content, "files": files}))
        return folder

    return forge


def hostile(run):
    """A record that holds every payload wherever a record holds text."""
    metric = next(iter(run.record["metrics"].values()))
    more = {text: {**metric, "unit": text} for text in HOSTILE.values()}
    return {
        "status": "failed",
        "failure": {"reason": TEXT, "time": 0.01, "joint": TEXT, "repetition": 0},
        "metrics": {**run.record["metrics"], **more},
        "caveats": [{"rule": text, "text": text, "value": 1.0, "repetitions": 1} for text in HOSTILE.values()],
        "provenance": {**run.provenance, "command": f"runner {TEXT}", "commit": TEXT},
    }


@pytest.mark.parametrize(
    ("config", "told"),
    [
        ("a: " + "[" * 100_000, "nested deeper than 30 levels"),
        ("- " * 5000 + "a", "nested deeper than 30 levels"),
        (BOMB, "more than 100000 values"),
        ("a: b\n" * 500_000, "has 2,500,000 bytes; allowed: up to 2,000,000"),
    ],
    ids=["nested", "nested in lines", "aliases", "long"],
)
def test_a_config_that_is_too_much_is_refused(cli, forged, config, told):
    ending = cli("table", forged("goal", config=config))
    assert ending.code == 2
    assert told in ending.err


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"[" * 3_000_000, "has 3,000,000 values; allowed: up to 2,000,000"),
        (b"{" + b" " * 50_000_000, "has 50,000,001 bytes; allowed: up to 50,000,000"),
        (b"[" * 1_000_000, "it is damaged"),
    ],
    ids=["values", "bytes", "nested"],
)
def test_a_record_that_is_too_much_is_refused(cli, forged, content, told):
    folder = forged("goal")
    (folder / "metrics.json").write_bytes(content)
    ending = cli("table", folder)
    assert ending.code == 2
    assert told in ending.err


@pytest.fixture
def pair(forged, runs):
    """Two runs whose strings are all hostile."""
    return [forged(name, hostile(runs[name]), place=name[0]) for name in ("goal", "other seed")]


def cells(text):
    return [cell for row in csv.reader(text.splitlines()) for cell in row]


def test_no_cell_of_csv_is_a_formula(cli, pair):
    found = cells(cli("table", pair[0], "--format", "csv").out)
    assert "'" + HOSTILE["formula"] in found
    for cell in found:
        assert not cell.startswith(("=", "@", "+", "\t")) and (not cell.startswith("-") or float(cell) < 0.0)  # noqa: PT018


def test_markdown_keeps_its_columns_and_holds_no_tag(cli, pair):
    lines = cli("table", pair[0], "--format", "markdown").out.splitlines()
    assert {line.replace(r"\|", "").count("|") for line in lines if line.startswith("| ")} == {4}
    assert not any("<script" in line or "[x](" in line for line in lines)


def test_latex_holds_no_command_of_a_text(cli, pair):
    lines = cli("table", pair[0], "--format", "latex").out.splitlines()
    assert not [line for line in lines if r"\input" in line and not line.startswith("%")]
    assert any(r"\textbackslash{}input\{/etc/passwd\}" in line for line in lines)


@pytest.mark.parametrize("command", [("table",), ("table", "--format", "latex"), ("table", "--format", "csv")])
def test_no_table_reaches_the_terminal(cli, pair, command):
    ending = cli(*command, pair[0])
    assert "\x1b" not in ending.out + ending.err


def test_a_comparison_is_made_safe(cli, pair):
    ending = cli("compare", *pair)
    assert ending.code == 0
    assert r"failed in repetition 0 at t = 0.01 s (<script>" in ending.out
    assert not {"\x1b", "\x07", "\r"} & set(ending.out + ending.err)


def test_a_page_shows_them_as_text(cli, pair):
    page = (cli("report", pair[0], "--format", "html").folder / "report.html").read_text()
    assert "&lt;script&gt;alert(1)" in page
    assert "<script>alert" not in page
    assert 'href="javascript' not in page
    assert "\x1b" not in page


def test_a_reference_is_learned_whatever_the_sweep_s_command(cli, runs, tmp_path):
    run = runs["goal"]
    shutil.copytree(run.folder, tmp_path / "o" / "runs" / run.hash)
    sweep = write_sweep(tmp_path / "o", [(["robot=macro", f"x={TEXT}"], run.hash)], f"runner -m {TEXT}")
    assert cli("check", sweep, "--save-baseline", "baseline.yaml").code == 0
    assert cli("check", sweep, "--baseline", "baseline.yaml").code == 0
