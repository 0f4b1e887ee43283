"""Imports of the commands used most, against the few parts of SciPy and of other large packages that they need."""

import json
import subprocess
import sys

from support.patience import PATIENCE

from runner.base.paths import examples_dir

SHORT = ("robot=macro", "duration=0.05")
LINES = (
    SHORT,
    (*SHORT, "trajectory=joint_quintic", "notch=torques"),
    ("-m", *SHORT, "controller.period=5ms,10ms", "seed=0,1", "hydra.sweeper.workers=0"),
    ("compare", "latest", "--by", "controller.period"),
)
SECTION = f"section={examples_dir() / 'small_parts' / 'shares.py'}"
CHILD = """
import json, sys
import scipy
from runner.cli.main import dispatch

large = {"dask", "distributed", "jinja2", "matplotlib", "optuna", "pandas", "plotly"}
codes = [dispatch(line) for line in json.loads(sys.argv[1])]
parts = {name.split(".")[1] for name in sys.modules if name.startswith("scipy.")} & {*scipy.__all__}
print(json.dumps([codes, sorted(parts), sorted(large & {*sys.modules})]))
"""


def test_runs_sweeps_and_comparisons_need_linear_algebra_and_special_functions_of_scipy_at_most(tmp_path):
    ended = subprocess.run(
        [sys.executable, "-c", CHILD, json.dumps(LINES)],
        check=True, cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE,
    )  # fmt: skip
    codes, parts, large = json.loads(ended.stdout.splitlines()[-1])
    assert codes == [0] * len(LINES)
    assert {*parts} <= {"linalg", "special"}
    assert large == []


def test_a_report_on_a_sweep_with_a_section_of_a_plugin_needs_no_pandas_hydra_or_optuna(tmp_path, cli):
    folder = cli("-m", *SHORT, "noise=thesis", "controller.period=5ms,10ms", "hydra.sweeper.workers=0").folder
    script = f"""
import sys
from runner.cli.main import dispatch

code = dispatch(["report", "--plugin", {SECTION!r}, {str(folder)!r}, "-o", {str(tmp_path / "report")!r}, "-q"])
print(code, sorted({{"dask", "hydra", "optuna", "pandas"}} & {{*sys.modules}}))
"""
    ended = subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True, timeout=PATIENCE)
    assert ended.stdout.splitlines()[-1] == "0 []"
