"""Included files and meshes of an MJCF, with path and size checks before MuJoCo reads them."""

import xml.etree.ElementTree as ET
from collections.abc import Collection, Iterable, Iterator
from pathlib import Path

from runner.base.errors import ConfigError
from runner.base.limits import ARM_PARTS, HEIGHTS, MESH, MJCF_ELEMENTS, XML
from runner.base.sanitize import few, quoted
from runner.robots.tree import excess_depth, parse_xml

_DEPTH = 200
_MAKES_MORE = {  # elements that generate many bodies or load code; `model` loads another file
    "attach": "copy its bodies in",
    "composite": "write its bodies, or take it out",
    "extension": "take it out, and the plugins",
    "flex": "take it out",
    "flexcomp": "take it out",
    "mesh": "write its vertices to a file, as builtin makes them without limit",
    "model": "copy its bodies in",
    "plugin": "take it out",
    "replicate": "write its bodies, or take it out",
}


def follow_includes(path: Path) -> list[Path]:
    """Return an MJCF file and its included files, after checking that MuJoCo can safely read them.

    Raises:
        ConfigError: if the file is not an MJCF, if an included file is missing, outside its folder or not XML, or if an
            element generates many bodies or loads code.
    """
    root, folder = parse_xml(path, "robot.mjcf"), path.resolve().parent
    if root.tag != "mujoco":
        urdf = "; a URDF stands at robot.urdf" if root.tag == "robot" else ""
        raise ConfigError(f"robot.mjcf: {path} is not an MJCF: it begins with <{root.tag}>, not with <mujoco>{urdf}")
    found, todo, problems, roots = [path], [(path, root)], [], []
    while todo:
        file, element = todo.pop()
        roots.append(element)
        problems += _refused(file, element)
        for include in element.iter("include"):
            places = _places(include.get("file", ""), (folder, file.resolve().parent))
            problems += [f"robot.mjcf: {file} includes {wrong}" for wrong in _wrong(include, places, folder)]
            new = [] if problems else [place for place in places if place.is_file() and place not in found]
            found += new
            todo += [(place, parse_xml(place, "robot.mjcf")) for place in new]
        problems += [f"robot.mjcf: {path} {excess}, with all that it includes" for excess in _excess(found, roots)]
        if problems:
            raise ConfigError(problems)
    return found


def asset_files(path: Path, folder: str, files: Iterable[str], read: Collection[str]) -> tuple[list[Path], list[str]]:
    """Return the files of an MJCF's meshes or height fields, and messages about missing files that are not needed.

    Args:
        path: The MJCF file.
        folder: Folder of the files, relative to that of the MJCF: `meshdir`.
        files: Names of the files.
        read: Names of the files that are needed, because their shapes have mass.

    Raises:
        ConfigError: if needed files are missing or outside the folder of the MJCF; the message lists all of them.
    """
    home = path.resolve().parent
    found = {file: (home / folder / file).resolve() for file in files if file}
    wrong = {file: bad for file, place in found.items() if (bad := _led_out(place, home) or _missing(place))}
    told: dict[str, list[str]] = {}
    for file, problem in wrong.items():
        told.setdefault(problem if file in read else "", []).append(quoted(str(Path(folder) / file)))
    spare = told.pop("", [])
    if told:
        raise ConfigError(f"robot.mjcf: {path} names the mesh {few(n)}: {problem}" for problem, n in told.items())
    there = dict.fromkeys(place for file, place in found.items() if file not in wrong)
    return list(there), [f"meshes that are not in its folder, and weigh nothing: {few(spare)}"] if spare else []


def _excess(files: list[Path], roots: list[ET.Element]) -> Iterator[str]:
    """Yield messages about sizes of an MJCF, with its included files, for which MuJoCo would need much memory."""
    elements = [element for root in roots for element in root.iter()]
    fields = [(_whole(element, "nrow"), _whole(element, "ncol")) for element in elements if element.tag == "hfield"]
    for limit, count in (
        (XML, sum(file.stat().st_size for file in files)),
        (MJCF_ELEMENTS, len(elements)),
        (ARM_PARTS, sum(element.tag in ("body", "joint") for element in elements)),
        (HEIGHTS, sum(rows * columns for rows, columns in fields)),
    ):
        if excess := limit.excess(count):
            yield excess


def _whole(element: ET.Element, key: str) -> int:
    """Return the absolute integer value of an XML attribute; 0 if it is not an integer, which MuJoCo rejects."""
    try:
        return abs(int(element.get(key, "0")))
    except ValueError:
        return 0


def _places(name: str, folders: Iterable[Path]) -> list[Path]:
    """Return the paths at which MuJoCo looks for an included file: relative to the main file and to its own."""
    return list(dict.fromkeys((folder / name).resolve() for folder in folders))


def _wrong(include: ET.Element, places: list[Path], folder: Path) -> list[str]:
    name = include.get("file", "")
    there = [place for place in places if place.is_file()]
    wrong = [led for place in there or places if (led := _led_out(place, folder))]
    if not there and not wrong:
        wrong = [_missing(places[0])]
    return [f"{quoted(name)}: {wrong[0]}"] if wrong else []


def _led_out(place: Path, folder: Path) -> str:
    return "" if place.is_relative_to(folder) else f"out of the folder {folder.name}; put it there, or take it out"


def _missing(place: Path) -> str:
    return MESH.excess(place.stat().st_size) if place.is_file() else "no such file; put it there, or take it out"


def _refused(file: Path, root: ET.Element) -> list[str]:
    if deep := excess_depth(root, _DEPTH):
        return [f"robot.mjcf: {file}: {deep}"]
    return [
        f"robot.mjcf: {file} holds <{element.tag}>{_named(element)}, unknown here; {_MAKES_MORE[element.tag]}"
        for element in root.iter()
        if element.tag in _MAKES_MORE and (element.tag != "mesh" or element.get("builtin"))
    ]


def _named(element: ET.Element) -> str:
    name = element.get("name") or element.get("prefix") or element.get("plugin")
    return f" {quoted(name)}" if name else ""
