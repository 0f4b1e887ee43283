"""Overrides as they are handed to Hydra: keys are forced, options are not."""

import pytest

from runner.base.errors import ConfigError
from runner.config.compose.overrides import force


@pytest.mark.parametrize(
    ("override", "forced"),
    [
        ("noise.position=1", "++noise.position=1"),
        ("seed=3", "++seed=3"),
        ("robot=macro", "robot=macro"),
        ("robot=macro,mini", "robot=macro,mini"),
        ("noise=1", "noise='1'"),
        ("experiment=null", "experiment='null'"),
        ("hydra.sweeper.workers=1", "hydra.sweeper.workers=1"),
        ("+new=1", "+new=1"),
        ("~noise", "~noise"),
        ("--config-dir=" + "/x" * 20_000, "--config-dir=" + "/x" * 20_000),
    ],
)
def test_keys_are_forced_and_options_are_not(override, forced):
    assert force([override]) == [forced]


def test_the_deepest_value_that_is_read_has_thirty_levels():
    deepest = f"noise.position={'[' * 29}{']' * 29}"  # in a key of two levels
    assert force([deepest]) == [f"++{deepest}"]
    with pytest.raises(ConfigError, match="nested deeper than 30 levels"):
        force([f"noise.position={'[' * 30}{']' * 30}"])


@pytest.mark.parametrize("flag", ["--experimental-rerun", "--exp", "--experimental-rerun=config.pickle"])
def test_no_pickle_is_read(cli, tmp_path, flag):
    (tmp_path / "config.pickle").write_bytes(b"cos\nmkdir\n(Vdone\ntR.")
    ending = cli(flag, "config.pickle")
    assert (ending.code, ending.out) == (2, "")
    assert "a pickle may run code" in ending.err
    assert not (tmp_path / "done").exists()


@pytest.mark.parametrize(
    ("override", "problem"),
    [
        (
            "noise.position=" + "[" * 200 + "]" * 200,
            "(417 characters) is not a valid override: nested deeper than 30 levels",
        ),
        ("noise.position=" + "{a:" * 80 + "1" + "}" * 80, "nested deeper than 30 levels"),
        (".".join("a" * 100) + "=1", "nested deeper than 30 levels"),
        ("seed=" + "1," * 20_000, "it is too long; allowed: up to 20000 characters"),
        ("hydra/launcher=", "hydra/launcher: is Hydra's own; you may set hydra.sweeper.workers"),
        ("+hydra/job_logging=default", "+hydra/job_logging: is Hydra's own"),
        ("noise=", "noise: '' is not an option; choose by name, see `runner list`"),
        ("torque_limits=${robot.name}", "torque_limits: '${robot.name}' is not an option"),
        ('torque_limits=${oc.decode:"1e400"}', "calls a function; a value may only refer to keys"),
        *(
            (f"{key}=1", f"{key}: is Hydra's own; you may set hydra.sweeper.workers, .address and .params")
            for key in (
                "hydra",
                "hydra.run.dir",
                "+hydra.callbacks.a",
                "~hydra.job",
                "hydra.searchpath",
                "hydra.sweeper",
                "hydra.sweeper._target_",
                "noise@hydra.sweeper",
                "noise@_global_.hydra",
                "noise@a:hydra.x",
            )
        ),
    ],
)
@pytest.mark.parametrize("mode", [(), ("-m",)])
def test_what_hydra_would_choke_on_is_refused(cli, tmp_path, mode, override, problem):
    ending = cli(*mode, "robot=macro", override)
    assert (ending.code, ending.out) == (2, "")
    assert problem in ending.err
    assert len(ending.err) < 500
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(ConfigError):
        force([override])
