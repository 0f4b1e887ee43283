"""Names in the files of a third-party paper, against a secret, a scheduler, and files outside of its folder."""

import os
import shutil
import sys
import tempfile
from pathlib import Path

import pytest
from support.opened_files import opened, outside
from support.pages import ROOT

ABOUT = "title: T\nsource: S\nabstract: A\nchapters: [one.md]\n"
RUNS = "grids:\n  goal:\n    with: [robot=macro, plant=rk4, duration=0.05, experiment=paper/own]\n"
FILES = {
    "study.yaml": ABOUT,
    "runs.yaml": RUNS,
    "one.md": "# One\n\nWords.\n",
    "experiment/own.yaml": "# @package _global_\n# An experiment\nseed: 1\n",
}
GRID = "grids:\n  goal:\n    with: [robot=macro]\n"


@pytest.fixture
def paper(cli, tmp_path, monkeypatch):
    """Reproduce a paper of some files next to those of a small one, which are replaced by name."""
    monkeypatch.setenv("RUNNER_SECRET", "hidden")

    def reproduce(files, *options):
        for name, text in (FILES | files).items():
            place = tmp_path / "paper" / name
            place.parent.mkdir(parents=True, exist_ok=True)
            if not place.is_symlink():
                place.write_text(text)
        with opened() as seen:
            ending = cli("reproduce", "paper", *options)
        assert "hidden" not in ending.err
        beside = {str(path) for path in tmp_path.glob("own.*")} | {str(path) for path in tmp_path.glob("away/*")}
        assert beside.isdisjoint(seen)
        assert str(tmp_path / "paper/runs.yaml") in seen or ending.code
        return ending

    return reproduce


def refused(ending, tmp_path, problem):
    """Check that a paper is refused in one sentence, before anything is made."""
    assert (ending.code, ending.out) == (2, "")
    assert problem in ending.err
    assert ending.err.count("\n") <= 3
    assert [path for path in (tmp_path / "outputs").rglob("*") if path.is_file()] == []
    return True


def last_line(text):
    """Return the place of the last line of a string of runs.yaml, in the words of messages."""
    return f"paper/runs.yaml, line {text.count(chr(10)) + 1}: "


SECRET = "${oc.env:RUNNER_SECRET}"


@pytest.mark.parametrize(
    "text",
    [
        f"grids:\n  goal:\n    with: [robot=macro, 'robot.name={SECRET}']",
        f"{GRID}    over:\n      robot.name: ['{SECRET}']",
        f"{GRID}    over:\n      a: {{b: 'robot.name={SECRET}'}}",
        f"{GRID}calibrations:\n  tool:\n    with: ['robot.name={SECRET}']",
        f"{GRID}values: {{a: '{SECRET}'}}",
    ],
)
def test_runs_yaml_reads_no_environment(paper, tmp_path, text):
    assert refused(paper({"runs.yaml": text}), tmp_path, f"{last_line(text)}'")


def test_nor_one_that_is_put_together(paper, tmp_path):
    text = f"{GRID}    over:\n      sign: [$]\n      x: {{y: 'robot.name={{{{ sign }}}}{{oc.env:RUNNER_SECRET}}'}}"
    assert refused(paper({"runs.yaml": text}), tmp_path, "calls a function; a value may only refer to keys")


@pytest.mark.parametrize(
    ("file", "line"),
    [
        ("study.yaml", 5),
        ("claims.yaml", 1),
        ("gains.yaml", 1),
        ("caveats.yaml", 1),
        ("experiment/own.yaml", 4),
    ],
)
def test_nor_does_any_other_file(paper, tmp_path, file, line):
    text = FILES.get(file, "") + f"bibtex: '{SECRET}'\n"
    assert refused(paper({file: text}), tmp_path, f"{file}, line {line}: '{SECRET}' calls a function")


@pytest.mark.parametrize(
    ("text", "given"),
    [
        ("grids:\n  goal:\n    with: [robot=macro, 'KEY=VALUE']", "KEY=VALUE"),
        ("grids:\n  goal:\n    with: [robot=macro, '++KEY=VALUE']", "++KEY=VALUE"),
        (f"{GRID}    over:\n      KEY: ['VALUE']", "KEY=VALUE"),
        (f"{GRID}    over:\n      a: {{b: 'KEY=VALUE'}}", "KEY=VALUE"),
        (f"{GRID}calibrations:\n  tool:\n    with: ['KEY=VALUE']", "KEY=VALUE"),
        (
            f"{GRID}tunings:\n  t:\n    over: {{a: [b]}}\n    ranges: {{a: {{b: {{}}}}}}\n    minimize: energy\n"
            "    with: ['KEY=VALUE']",
            "KEY=VALUE",
        ),
    ],
)
@pytest.mark.parametrize(
    ("key", "value"),
    [("hydra.sweeper.address", "tcp://127.0.0.1:9"), ("outputs", "there"), ("hydra.searchpath", "[file:///]")],
)
def test_runs_yaml_does_not_say_how_runs_are_made(paper, tmp_path, text, given, key, value):
    text, given = (each.replace("KEY", key).replace("VALUE", value) for each in (text, given))
    line = f"{last_line(text)}'{given}' controls how or where runs are simulated, which no file may do"
    assert refused(paper({"runs.yaml": text}), tmp_path, line)


def test_nor_one_that_is_put_together_of_pieces(paper, tmp_path):
    text = f"{GRID}    over:\n      dot: ['.']\n      x: {{y: 'hydra{{{{ dot }}}}searchpath=[file:///]'}}"
    problem = (
        "paper/runs.yaml: 'hydra.searchpath=[file:///]' controls how or where runs are simulated, which no file may do"
    )
    assert refused(paper({"runs.yaml": text}), tmp_path, problem)


def test_nor_do_gains(paper, tmp_path):
    problem = "paper/gains.yaml, line 2: 'hydra.sweeper.workers' controls how or where runs are simulated"
    assert refused(paper({"gains.yaml": "a/b:\n- {hydra.sweeper.workers: 1000}\n"}), tmp_path, problem)


KINDS = [
    "study.yaml", "runs.yaml", "one.md", "experiment/own.yaml", "claims.yaml", "gains.yaml", "caveats.yaml",
    "checklist.yaml", "one.py", "robots/own.urdf", "robots/own.xml", "robots/mesh.stl", "own.csv", "own.parquet",
    "equations/inventory.yaml", "equations/own.yaml", "equations/derivations/own.py", "mine.ranges.yaml", "noise",
]  # fmt: skip


@pytest.mark.parametrize("file", KINDS)
def test_links_out_of_a_paper_are_refused(paper, tmp_path, file):
    away = tmp_path / "away" / Path(file).name
    away.parent.mkdir()
    if away.suffix:
        away.write_text(FILES.get(file, ""))
    else:
        away.mkdir()
    place = tmp_path / "paper" / file
    place.parent.mkdir(parents=True)
    place.symlink_to(away)
    problem = f"{place}: is {away}, outside of the folder {tmp_path}/paper; put the file itself there"
    assert refused(paper({}), tmp_path, problem)


def test_links_within_a_paper_are_free(paper, tmp_path):
    (tmp_path / "paper").mkdir()
    (tmp_path / "paper/two.md").write_text(FILES["one.md"])
    (tmp_path / "paper/one.md").symlink_to("two.md")
    assert paper({}, "hydra.sweeper.workers=0").code == 0


@pytest.mark.parametrize(
    ("file", "override"),
    [
        ("runs.yaml", "robot.urdf=HERE/own.urdf"),
        ("runs.yaml", "trajectory.file=own.csv"),
        ("experiment/own.yaml", "trajectory.file=HERE/own.csv"),
        pytest.param("experiment/own.yaml", "robot.urdf=HERE/own.urdf", marks=pytest.mark.slow),
        pytest.param("runs.yaml", "trajectory.file=HERE/own.csv", marks=pytest.mark.slow),
    ],
)
def test_a_paper_names_no_file_outside(paper, tmp_path, override, file):
    (tmp_path / "own.urdf").write_text("<robot name='hidden'/>")
    (tmp_path / "own.csv").write_text("hidden\n")
    key, _, value = override.replace("HERE", str(tmp_path)).partition("=")
    group, _, name = key.partition(".")
    text = f"# @package _global_\n# An experiment\n{group}: {{{name}: '{value}'}}\n"
    with_ = [f"{group}.{name}={value}"] if file == "runs.yaml" else []
    runs = RUNS.replace("[robot=macro", ", ".join(["[robot=macro, trajectory=from_file", *with_]))
    files = {"runs.yaml": runs} | ({file: text} if file != "runs.yaml" else {})
    problem = (
        f"own.{value[-4:].strip('.')}: is {tmp_path}/{value.rpartition('/')[2]}, outside of the folder {tmp_path}/paper"
    )
    ending = paper(files)
    assert (ending.code, ending.out) == (2, "")
    assert problem in ending.err


@pytest.mark.parametrize("file", ["../own.py", "HERE/own.py", "/HERE/away/own.py"])
@pytest.mark.parametrize("options", [(), ("--code",)])
def test_plug_ins_of_a_paper_lie_in_its_folder(paper, tmp_path, file, options):
    (tmp_path / "own.py").write_text("raise RuntimeError\n")
    about = f"{ABOUT}plugins: ['controller={file.replace('HERE', str(tmp_path))}']\n"
    assert refused(paper({"study.yaml": about}, *options), tmp_path, f"outside of the folder {tmp_path}/paper")


@pytest.mark.parametrize(
    ("expression", "problem"),
    [
        ('metric.args[0]["goal"]', "a value of type partial has no 'args'"),
        ('table.__globals__["__builtins__"]', "a value of type partial has no '__globals__'"),
        ('metric("goal", "peak_torque").__class__', "a value of type Measured has no '__class__'"),
        ('config("goal", "seed").bit_length()', "a value of type int has no 'bit_length'"),
        ('"%0999999999d" % 1', "forms %s, %d"),
        ('"a".ljust(20000000000)', "a value of type str has no 'ljust'"),
        ("norm('error')(1)", "only named functions can be called"),
        ("__import__('os').popen('touch taken')", "no name '__import__'"),
    ],
)
def test_a_chapter_reaches_its_values_and_nothing_behind_them(paper, tmp_path, expression, problem):
    ending = paper({"one.md": f"# One\n\nA {{{{ {expression} }}}}\n"}, "hydra.sweeper.workers=0")
    assert (ending.code, ending.out) == (2, "")
    assert "paper/one.md:3: " in ending.err
    assert problem in ending.err
    assert list(tmp_path.rglob("taken")) == []


SYSTEM = ("/usr", "/lib", "/proc", "/sys", "/dev", "/etc/fonts", "/etc/localtime", "/etc/os-release", "/etc/ssl")


@pytest.mark.costs(2)
def test_a_paper_without_code_opens_nothing_outside_its_folder(cli, tmp_path, monkeypatch):
    folder, home = tmp_path / "away/paper", tmp_path / "home"
    shutil.copytree(ROOT / "examples/own_paper", folder)
    (folder / "figures.py").write_text("open('secret.txt')\n")
    for each in (tmp_path, tmp_path / "away", home, tmp_path / "temporary"):
        each.mkdir(exist_ok=True)
        (each / "secret.txt").write_text("hidden\n")
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    with opened() as seen:
        ending = cli("reproduce", folder, "hydra.sweeper.workers=0")
    assert ending.code == 0, ending.err
    installed = (sys.prefix, sys.base_prefix, ROOT, home / ".fonts", home / ".local/share/fonts", *SYSTEM)
    elsewhere = (tmp_path / "outputs", os.environ["XDG_CACHE_HOME"], os.environ["XDG_CONFIG_HOME"])
    found = outside(seen, tmp_path / "temporary", *elsewhere, *installed)
    assert {str(folder / name) for name in ("runs.yaml", "claims.yaml", "goal.md")} <= found
    assert outside(found, folder) == set()
    assert str(tmp_path / "temporary/secret.txt") not in seen
