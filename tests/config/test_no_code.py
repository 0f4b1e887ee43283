import json

import pytest

HEAD = "# @package _global_\n# A stranger's\n# experiment\n"


@pytest.fixture
def stranger(cli, tmp_path):
    """Runs an experiment of a stranger's config folder, whose text may make the folder `done`, once or as a sweep."""

    def run(text, *mode):
        folder = tmp_path / "theirs"
        (folder / "experiment").mkdir(parents=True)
        made = json.dumps({"_target_": "os.mkdir", "path": str(tmp_path / "done")})
        (folder / "experiment/trap.yaml").write_text(HEAD + text.replace("MAKE", made))
        ending = cli(*mode, "--config-dir", folder, "experiment=trap", "robot=macro", "plant=rk4", "duration=0.05")
        assert not (tmp_path / "done").exists()
        return ending

    return run


@pytest.mark.parametrize("mode", [(), ("-m",)])
@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("hydra: {callbacks: {a: MAKE}}", "callbacks"),
        ("hydra: {callbacks: {a: '${oc.create:${trap}}'}}\ntrap: 'MAKE'", "callbacks"),
        ("hydra: {sweeper: {params: {seed: MAKE}}}", "sweeper"),
        ("hydra: {sweeper: {_recursive_: true}}", "sweeper"),
        ("hydra: {job_logging: {handlers: {a: {'()': os.mkdir, path: done}}, root: {handlers: [a]}}}", "job_logging"),
        ("hydra: {hydra_logging: {formatters: {a: {'()': os.getcwd}}}}", "hydra_logging"),
        ("hydra: {job: {env_set: {RUNNER_PLUGINS: metric=trap.py}}}", "job.env_set"),
    ],
)
def test_a_config_that_names_code_is_refused_before_it_runs(stranger, text, key, mode):
    ending = stranger(text, *mode)
    assert (ending.code, ending.out) == (2, "")
    assert f"hydra.{key}: a config cannot name code" in ending.err


def test_code_as_a_value_of_ours_is_only_a_wrong_value(stranger):
    ending = stranger("seed: MAKE")
    assert ending.code == 2
    assert "seed: must be a whole number" in ending.err


def test_axes_of_an_experiment_stay_free(stranger):
    ending = stranger("hydra: {sweeper: {workers: 0, params: {seed: '0,1'}}}", "-m")
    assert ending.code == 0
    assert "runner: 2 runs" in ending.err
