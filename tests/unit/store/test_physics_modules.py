"""The table of the physics is complete; moves and strings leave its digest, what computes changes it."""

import pytest

from runner.base.paths import package_dir
from runner.store import physics, syntax

# Modules for finished runs, for output and storage, or for the resolved config, which is in the hash itself.
OTHERS = {
    "__init__.py", "__main__.py", "analysis", "api", "assembly/dependent_keys.py", "assembly/engine_check.py",
    "assembly/long_motion.py", "assembly/run_cost.py", "assembly/versions.py", "base/arrays.py", "base/atomic.py",
    "base/bounded_json.py", "base/bounded_yaml.py", "base/cache.py", "base/data_file.py", "base/dotted_keys.py",
    "base/engine_output.py", "base/engines.py", "base/entry_points.py",
    "base/errors.py", "base/former_names.py", "base/lazy_modules.py",
    "base/limits.py", "base/machine.py", "base/memory.py", "base/parquet.py", "base/paths.py",
    "base/progress.py", "base/quantities.py", "base/row_forms.py", "base/sanitize.py", "base/tables.py",
    "base/ticks.py",
    "caveats/contact_stability.py", "caveats/monitor.py",
    "caveats/plant_error.py", "caveats/rounding.py", "caveats/rule.py", "caveats/servo_contact_stability.py",
    "caveats/setting.py", "caveats/setting_rules.py", "caveats/time_constants.py", "caveats/trace_rules.py",
    "caveats/versions.py", "cli", "config/compose", "config/composed.py", "config/json_schema.py",
    "config/judgement.py", "config/limits.py", "controllers/stability.py", "doctor", "identification", "papers",
    "plants/agreement.py", "plugin.py", "plugins/discovery.py", "plugins/folder_code.py", "recordings", "reporting",
    "schema/bound.py", "schema/model.py", "schema/units.py", "simulation/provenance.py", "simulation/tick_time.py",
    "statistics", "store", "sweeps/arm.py", "sweeps/at_work.py", "sweeps/batch.py", "sweeps/challenge",
    "sweeps/changes.py", "sweeps/check.py", "sweeps/deadline.py", "sweeps/differing.py",
    "sweeps/engine.py", "sweeps/estimate.py", "sweeps/finer_step.py", "sweeps/forked.py", "sweeps/gathering.py",
    "sweeps/job.py", "sweeps/measurements.py", "sweeps/outcomes.py", "sweeps/part.py", "sweeps/plan.py",
    "sweeps/preview.py", "sweeps/processes.py", "sweeps/question.py", "sweeps/queue.py", "sweeps/records.py",
    "sweeps/remote.py", "sweeps/rerun.py", "sweeps/rounding.py", "sweeps/run.py", "sweeps/slurm.py",
    "sweeps/status.py", "sweeps/swept.py", "sweeps/table.py", "sweeps/template.py", "sweeps/tuning",
    "sweeps/typed.py", "sweeps/work.py", "sweeps/writer.py",
}  # fmt: skip
TREE = {
    "laws/__init__.py": 'from runner.laws.pd import Law\nKINDS = {"pd": "runner.laws.pd"}\n',
    "laws/pd.py": '"""A law."""\nfrom runner.base.errors import Told\nGAIN = 2.0\nclass Law:\n    gain = GAIN\n',
    "laws/pid.py": "from runner.laws.pd import GAIN\nclass Law:\n    gain = GAIN + 1.0\n",
    "loop.py": "from runner.laws import KINDS, Law\nfrom runner.laws.pid import GAIN\nmade = Law(), KINDS, GAIN\n",
}
TABLE = ".: loop laws: __init__=kinds pd pid"


@pytest.fixture
def digest(tmp_path, monkeypatch):
    """Return the digest of files under a table."""
    monkeypatch.setattr(physics, "package_dir", lambda: tmp_path)

    def of(files, table=TABLE):
        for name, text in files.items():
            (tmp_path / name).parent.mkdir(exist_ok=True, parents=True)
            (tmp_path / name).write_text(text)
        monkeypatch.setattr(physics, "_TABLE", table)
        return physics.physics_digest.__wrapped__()

    return of


def test_every_module_is_in_the_table_or_known_to_be_none_of_the_physics():
    files = {path.relative_to(package_dir()).as_posix(): path for path in package_dir().rglob("*.py")}
    others = {name for name in files if any(f"{name}/".startswith(f"{other}/") for other in OTHERS)}
    inits = {name: path.read_text() for name, path in files.items() if name.endswith("__init__.py")}
    empty = {name for name, text in inits.items() if text.endswith('"""\n') and text.count('"""') == 2}
    table = set(physics.module_ids())
    assert table - set(files) == set()
    assert set(files) - table - others - empty == set()
    assert table & others == set()
    assert {name for name in OTHERS if not (package_dir() / name).exists()} == set()


def test_each_module_has_an_id_of_its_own():
    ids = physics.module_ids()
    assert len(set(ids.values())) == len(ids)


def test_all_modules_of_a_folder_except_some(digest):
    digest(TREE, "loop: laws: * -pid __init__=kinds")
    assert physics.module_ids() == {"laws/__init__.py": "kinds", "laws/pd.py": "pd"}


def test_a_move_changes_nothing(digest):
    before = digest(TREE)
    moved = {
        "laws/__init__.py": "",
        "control/__init__.py": '"""Laws."""\nfrom runner.control.joint.spring import Law\n__all__ = ["Law"]\n',
        "control/kinds.py": 'from runner.control import Law\nKINDS = {"pd": "runner.control.joint.spring"}\n',
        "control/joint/spring.py": TREE["laws/pd.py"].replace("runner.base.errors", "runner.base.errors"),
        "control/pid.py": TREE["laws/pid.py"].replace("laws.pd", "control.joint.spring"),
        "loops/loop.py": "from runner.control.kinds import KINDS\nfrom runner.control.pid import GAIN\n"
        "from runner.control.joint import spring\nfrom runner.control import Law\nmade = Law(), KINDS, GAIN\n",
    }
    table = "laws: __init__=none control: __init__=new kinds pid control/joint: spring=pd loops: loop"
    assert digest(moved, table) == before


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("laws/pd.py", "A law.", "Another text."),
        ("laws/pd.py", "2.0", "2.0  # N m"),
        ("laws/pd.py", "    gain = GAIN", '    """Text."""\n\n    gain = (GAIN)'),
        ("laws/pd.py", "from runner.base.errors import Told\n", ""),
        (
            "loop.py",
            "from runner.laws import KINDS, Law",
            "from runner.laws.pd import Law\nfrom runner.laws import KINDS",
        ),
        ("loop.py", "from runner.laws.pid import GAIN", "from runner.laws.pd import GAIN"),
    ],
)
def test_texts_and_ways_of_an_import_change_nothing(digest, file, old, new):
    assert old in TREE[file]
    assert digest({**TREE, file: TREE[file].replace(old, new)}) == digest(TREE)


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("laws/pd.py", "2.0", "2.5"),
        ("laws/pid.py", "+ 1.0", "- 1.0"),
        (
            "loop.py",
            "from runner.laws import KINDS, Law",
            "from runner.laws import KINDS\nfrom runner.laws.pid import Law",
        ),
        ("laws/__init__.py", "laws.pd import Law", "laws.pid import Law"),
        ("laws/__init__.py", '"runner.laws.pd"', '"runner.laws.pid"'),
        ("loop.py", "from runner.laws.pid import GAIN", "from runner.laws.pid import GAIN as KINDS"),
    ],
)
def test_what_computes_counts(digest, file, old, new):
    assert old in TREE[file]
    assert digest({**TREE, file: TREE[file].replace(old, new)}) != digest(TREE)


def test_two_modules_that_change_their_ids_count(digest):
    assert digest(TREE, TABLE.replace("pd pid", "pd=pid pid=pd")) != digest(TREE)


def test_it_is_worked_out_once_for_each_state_of_the_source(digest, monkeypatch):
    files = {**TREE, "laws/pid.py": TREE["laws/pid.py"] + "ONCE = 1\n"}
    before, write, written = digest(files), syntax.content, []
    monkeypatch.setattr(syntax, "content", lambda *given: written.append(given) or write(*given))
    assert digest(files) == before
    assert not written
    assert digest({**files, "loop.py": files["loop.py"] + "# text\n"}) == before
    assert len(written) == len(files)


@pytest.mark.parametrize("source", [b"def broken(:\n", b"x = '\xff'\n", b"x\x00"])
def test_what_python_cannot_read_counts_with_all_its_text(source):
    digests = [physics.content_digest({"part": text}, {"part": "part"}) for text in (source, source + b"#", b"")]
    assert len(set(digests)) == 3
