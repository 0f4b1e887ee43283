"""Name of a robot, chosen from its file."""

import re
from pathlib import Path

from runner.base.errors import RunnerError
from runner.config.compose.files import group_options
from runner.doctor.finding import Finding

_GENERAL = {
    "arm_",
    "arm",
    "main",
    "mjcf",
    "model",
    "mujoco_model",
    "robot",
    "robots",
    "scene",
    "urdf",
    "xml",
}  # of any arm
_WORDS = {"false", "n", "no", "null", "off", "on", "true", "y", "yes"}  # that YAML takes for something else


def choose_name(path: Path, header: str, wanted: str | None) -> tuple[str, Finding]:
    """Return the name of an arm, of lower-case letters, digits and underscores, and what there is to say of it.

    It is the one wanted, else that of the file; where that could be any arm's, the one in the file, else that of the
    nearest folder around it. It begins with `my_` if a built-in robot has the name.

    Args:
        path: The arm's file.
        header: The name in the file.
        wanted: The name wanted; None for none.

    Raises:
        RunnerError: if the name wanted is that of a built-in robot, or holds other letters.
    """
    ours = group_options("robot")
    if wanted is not None:
        if wanted != _plain(wanted):
            raise RunnerError(f"--name: '{wanted}'; allowed: a lower-case letter, then such, digits and underscores")
        if wanted in ours:
            raise RunnerError(f"--name: '{wanted}' is one of our robots; choose another name, such as my_{wanted}")
        return wanted, Finding("note", "name", f"'{wanted}'")
    whole = path.resolve()
    stem = re.sub(r"(\.(urdf|xml|xacro|mjcf))+$", "", whole.name, flags=re.IGNORECASE)
    names = map(_plain, (stem, header, *(folder.name for folder in whole.parents)))
    own = next((name for name in names if name not in _GENERAL), "arm")
    name = f"my_{own}" if own in ours else own
    said = [f"'{name}'"] + [f"'{own}' is one of ours"] * (name != own)
    said += [f"the file says '{header}'"] if _plain(header) != own and header else []
    return name, Finding("note", "name", "; ".join(said), "--name gives another")


def _plain(name: str) -> str:
    plain = re.sub(r"\W+", "_", name.lower(), flags=re.ASCII).strip("_")
    return f"arm_{plain}" if plain in _WORDS or not plain[:1].isalpha() else plain
