"""Built-in arms: the engines read the canonical text as they read the file, bit for bit."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from runner.base.paths import robots_dir
from runner.plants.mujoco import Mujoco
from runner.robots.description import read_urdf
from runner.robots.model import RobotModel
from runner.robots.tree import read_tree

FILES = sorted(path.stem for path in robots_dir().glob("*.urdf"))


@pytest.fixture(params=FILES)
def texts(request):
    """The file of a built-in arm and its canonical text."""
    path = robots_dir() / f"{request.param}.urdf"
    return path.read_text(), read_urdf(path, {})


def test_all_ten_arms_are_there():
    ours = {"panda", "fr3", "ur5e", "ur10e", "iiwa14", "gen3", "xarm7", "z1", "so101", "sawyer"}
    assert ours < set(FILES)


def test_pinocchio_has_the_same_model(texts):
    file, canonical = (pin.buildModelFromXML(text) for text in texts)
    assert file == canonical
    assert file.njoints > 2


def model_of(text):
    tip = pin.buildModelFromXML(text).frames[-1].name
    return RobotModel(text, tip)


def test_mujoco_has_the_same_model(texts):
    file, canonical = (Mujoco(text, model_of(text), 1e-3, 1, "euler", 1e-9)._model for text in texts)
    names = [name for name in dir(file) if name.startswith(("body_", "jnt_", "dof_", "geom_", "qpos"))]
    assert len(names) > 50
    for name in names:
        one, other = getattr(file, name), getattr(canonical, name)
        if isinstance(one, np.ndarray):
            assert one.tobytes() == other.tobytes(), name
    assert mujoco.mj_sizeModel(file) == mujoco.mj_sizeModel(canonical)


@pytest.mark.bullet
def test_pybullet_has_the_same_arm(texts):
    import pybullet

    from runner.plants.bullet_engine import Bullet

    found = []
    for text in texts:
        plant = Bullet(text, model_of(text), 1e-3, 1)
        body, client = plant._body, plant._client
        links = range(pybullet.getNumJoints(body, client))
        found.append([pybullet.getJointInfo(body, link, client) for link in links])
        found[-1] += [pybullet.getDynamicsInfo(body, link, client) for link in (-1, *links)]
        plant.close()
    assert found[0] == found[1]


def test_nothing_is_said_of_them(texts, tmp_path):
    path = tmp_path / "arm.urdf"
    for text in texts:
        path.write_text(text)
        assert read_tree(path).changes == ()
    assert read_urdf(path, {}) == texts[1]  # canonical already
