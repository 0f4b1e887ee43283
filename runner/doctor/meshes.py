"""Checks of the mesh files that a URDF names."""

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path

from runner.base.sanitize import few, quoted
from runner.doctor.finding import Finding
from runner.robots.tree import UrdfTree


def check_meshes(tree: UrdfTree, urdf: Path, packages: Sequence[Path]) -> list[Finding]:
    """Return the meshes that are not there, or lie outside the folder of the URDF or of their package.

    Args:
        tree: The arm.
        urdf: Its file.
        packages: Folders that hold ROS packages, searched before those around the file.
    """
    names = list(dict.fromkeys(mesh.get("filename", "") for link in tree.links.values() for mesh in link.iter("mesh")))
    wrong: dict[str, list[str]] = {}
    for name in names:
        with contextlib.suppress(OSError, RuntimeError):  # a name that is too long, links in a circle
            wrong.setdefault(_wrong(name, urdf.resolve().parent, packages), []).append(quoted(name))
    findings = []
    for said, found in wrong.items():
        hint = "--package-path DIR names a folder with its package; " if "package://" in found[0] else ""
        if said:
            text = f"{len(found)} of {len(names)} {said}: {few(found)}"
            findings.append(Finding("note", "meshes", text, f"{hint}runs need none, and draw such links as bones"))
    return findings


def _wrong(name: str, folder: Path, packages: Sequence[Path]) -> str:
    """Return what is wrong with the mesh of a name; "" for nothing."""
    roots, inner = [folder], name.removeprefix("file://")
    if name.startswith("package://"):
        package, _, inner = name.removeprefix("package://").partition("/")
        roots = list(_package_folders(folder, package, packages))
    for root in roots:
        path = (root / inner).resolve()
        if not path.is_relative_to(root.resolve()):
            return "outside of the folder of its URDF or package"
        if path.is_file():
            return ""
    return "not found"


def _package_folders(folder: Path, package: str, packages: Sequence[Path]) -> Iterator[Path]:
    """Yield where a ROS package may lie: in folders named, around the URDF, beside a folder around it, or beside it."""
    yield from (place / package for place in packages)
    for around in (folder, *folder.parents):
        if around.name == package:
            yield around
        yield around / package
    yield folder
