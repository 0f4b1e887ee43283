"""The mesh files that a URDF names."""

import xml.etree.ElementTree as ET
from pathlib import Path

from runner.doctor.finding import Finding
from runner.limits import FACES, MESH
from runner.robots.tree import UrdfTree


def check_meshes(tree: UrdfTree, urdf: Path) -> list[Finding]:
    """Return the meshes that are not there, or lie outside the folder of the URDF (or of the ROS package it names).

    Runs need none of them: an arm without shapes is drawn by its joints.
    """
    findings: dict[str, Finding] = {}
    for name, link in tree.links.items():
        for mesh in link.iter("mesh"):
            wrong = _check_mesh(mesh, urdf.resolve().parent)
            if wrong:
                place = f"link '{name}', mesh '{mesh.get('filename', '')}'"
                findings.setdefault(place, Finding("refused", place, *wrong, mended=True))
    return list(findings.values())


def _check_mesh(mesh: ET.Element, folder: Path) -> tuple[str, str] | None:
    name = mesh.get("filename", "").removeprefix("file://")
    package, inner = None, name
    if name.startswith("package://"):
        package, _, inner = name.removeprefix("package://").partition("/")
    roots = [folder] if package is None else _package_folders(folder, package)
    for root in roots:
        path = (root / inner).resolve()
        if not path.is_relative_to(root):
            return f"it leads out of {root.name}", "put the mesh beside the URDF, and name it from there"
        if path.is_file():
            excess = MESH.excess(path.stat().st_size) or FACES.excess(_faces(path))
            return (f"it {excess}", "write it with fewer triangles, or take the shape out") if excess else None
    return "no such file", "put it there, or take the shape out"


def _faces(path: Path) -> int:
    return path.read_bytes().count(b"\nf") if path.suffix.lower() == ".obj" else 0


def _package_folders(folder: Path, package: str) -> list[Path]:
    """Return where a ROS package may lie: the folder around the URDF of that name, or one beside the URDF."""
    around = [parent for parent in (folder, *folder.parents) if parent.name == package]
    return [*around, folder / package, folder]
