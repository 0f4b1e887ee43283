"""A public class of the package has a name that no other one has, unless it derives from its namesake."""

import ast
from collections import defaultdict
from pathlib import Path

import pytest

from runner.base.paths import package_dir

# Both classes are physics: the name of every run would change with theirs.
KEPT = {
    "JointMotion": ("controllers/joint_space/joint_law.py", "trajectories/joint_motion.py"),
    "Motion": ("calibration/gravity.py", "plants/decoupled.py"),
}


def doubles(sources):
    """Return the files of each name of public classes that several classes have, from the text of each file."""
    places = defaultdict(list)
    for file, text in sources.items():
        for node in ast.parse(text).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                bases = {ast.unparse(base).partition("[")[0].rpartition(".")[2] for base in node.bases}
                if node.name not in bases:
                    places[node.name].append(file)
    return {name: tuple(sorted(files)) for name, files in places.items() if len(files) > 1}


def test_no_two_classes_share_a_name():
    root = package_dir()
    found = doubles({str(path.relative_to(root)): path.read_text("utf-8") for path in sorted(root.rglob("*.py"))})
    new = {name: files for name, files in found.items() if KEPT.get(name) != files}
    assert not new, "\n".join(f"two classes {name}: {' and '.join(files)}" for name, files in new.items())
    assert set(found) == set(KEPT)  # a row that is no longer needed goes


@pytest.mark.parametrize(
    ("other", "said"),
    [("class Arm: ...", True), ("class Arm(robots.Arm): ...", False), ("class _Arm: ...", False)],
    ids=["double", "derived", "private"],
)
def test_only_an_unrelated_public_class_is_a_double(other, said):
    assert bool(doubles({Path("a.py"): "class Arm: ...", Path("b.py"): other})) is said
