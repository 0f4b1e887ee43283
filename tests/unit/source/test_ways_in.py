"""The ways in that SECURITY.md lists, compared with the tests that it names and the modules that read something."""

import ast
import re

import pytest
from support.pages import ROOT

_SECTION = (ROOT / "SECURITY.md").read_text().split("\n## Ways in\n")[1].split("\n## ")[0]
ROWS = [
    [cell.strip() for cell in line.strip("|").split(" | ")]
    for line in _SECTION.splitlines()
    if line.startswith("| ") and not line.startswith("| Way ")
]
TEST = re.compile(r"`(tests/[\w/]+\.py)::(test_\w+)`")

READING = {
    "read_text", "read_bytes", "fromstring", "XMLParser", "ParquetFile", "from_file", "from_string", "loadURDF",
    "buildModelFromXML", "optuna.load_study", "Client", "read_csv", "read_parquet", "from_xml_path", "from_xml_string",
    "yaml.load", "yaml.safe_load", "yaml.parse", "json.load", "json.loads", "decode_json", "pickle.load",
    "pickle.loads", "np.load", "OmegaConf.load", "ast.parse", "csv.reader", "ET.parse", "importlib.import_module",
    "os.environ", "os.getenv", "deserialize_cdr", "sys.argv", "subprocess.run", "subprocess.Popen",
    "os.popen", "os.system", "eval", "exec", "urlopen", "create_connection",
}  # fmt: skip
"""Names and attributes that read a file, parse a string, ask the environment, start a program or connect to one."""


_MAY_READ = re.compile(rf"\b({'|'.join(map(re.escape, sorted(READING | {'open'})))})\b")


def reads(node):
    """Return True if a node of a syntax tree reads something; `open` does unless its mode is to write."""
    if isinstance(node, ast.Call) and _last(node.func) == "open" and _dotted(node.func) != "os.open":
        given = [*node.args, *(each.value for each in node.keywords if each.arg == "mode")]
        modes = [each.value for each in given if isinstance(each, ast.Constant) and isinstance(each.value, str)]
        text = any(each.arg in ("encoding", "errors", "newline") for each in node.keywords)
        return any("r" in mode for mode in modes) or (text and not modes) or isinstance(node.func, ast.Name)
    return _last(node) in READING or _dotted(node) in READING


def _last(node):
    return node.attr if isinstance(node, ast.Attribute) else getattr(node, "id", "")


def _dotted(node):
    return f"{_last(node.value)}.{node.attr}" if isinstance(node, ast.Attribute) else ""


def readers(text):
    """Return the lines of a string of Python that read something."""
    if not _MAY_READ.search(text):
        return []
    return sorted({node.lineno for node in ast.walk(ast.parse(text)) if reads(node)})


def test_every_row_has_a_way_what_it_may_modules_and_a_test():
    assert len(ROWS) > 25
    assert [row for row in ROWS if len(row) != 4 or not (row[0] and row[1] and TEST.fullmatch(row[3]))] == []
    ways = [row[0] for row in ROWS]
    assert len(set(ways)) == len(ways)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_its_test_is_there(row):
    file, name = TEST.fullmatch(row[3]).groups()
    tree = ast.parse((ROOT / file).read_text())
    assert name in {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}


def test_the_modules_listed_are_those_that_read_something():
    listed = {name for row in ROWS for name in re.findall(r"`([\w/]+\.py)`", row[2])}
    places = {f"hydra_plugins/{path.name}": path for path in (ROOT / "hydra_plugins").glob("*.py")}
    studies = ROOT / "runner/papers/studies"
    for path in (ROOT / "runner").rglob("*.py"):
        if studies not in path.parents:
            places[path.relative_to(ROOT / "runner").as_posix()] = path
    assert listed == {name for name, path in places.items() if readers(path.read_text())}


@pytest.mark.parametrize(
    "text",
    [
        "open(name)",
        "path.open('rb')",
        "path.open(encoding='utf-8')",
        "Path(name).read_text()",
        "yaml.safe_load(text)",
        "xml.etree.ElementTree.fromstring(text)",
        "pyarrow.parquet.ParquetFile(path)",
        "os.environ.get('HOME')",
        "subprocess.run(command)",
        "mujoco.MjSpec.from_file(name)",
        "pickle.loads(content)",
        "np.load(name)",
        "exec(text)",
    ],
)
def test_what_reads_is_seen(text):
    assert readers(text) == [1]


@pytest.mark.parametrize(
    "text", ["path.open('wb')", "os.open(name, 0)", "self._open('0')", "finished.open(name)", "a.load(b)"]
)
def test_what_does_not_read_is_not(text):
    assert readers(text) == []
