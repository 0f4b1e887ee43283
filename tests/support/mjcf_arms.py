"""Arms as MJCF, and MuJoCo's own model of one next to the model of its URDF."""

import mujoco
import numpy as np

from runner.robots.description import read_urdf
from runner.robots.model import RobotModel

CHAIN = """<mujoco model="elbow">
  <compiler angle="degree"/>
  <default><joint range="-170 170"/><geom type="capsule" size="0.04" density="800"/></default>
  <worldbody>
    <body name="base" pos="0 0 0.1">
      <body name="upper"><joint name="q1" axis="0 0 1"/><geom fromto="0 0 0 0 0 0.3"/>
        <body name="fore" pos="0 0 0.3"><joint name="q2" axis="0 1 0"/><geom fromto="0 0 0 0.3 0 0"/>
          <body name="hand" pos="0.3 0 0"><joint name="q3" axis="0 1 0"/><geom fromto="0 0 0 0.2 0 0"/>
            <site name="tcp" pos="0.2 0 0"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
"""Three joints z, y, y, whose inertias follow from shapes; the tip is a site."""


def written(folder, text, name="arm.xml"):
    """The file of a string."""
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def own_model(path):
    """MuJoCo's model of a file, without what the runner leaves out."""
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda text: None)  # it would write them to a file
    model = mujoco.MjModel.from_xml_path(str(path))
    mujoco.set_mju_user_warning(before)
    model.dof_damping[:], model.dof_armature[:], model.dof_frictionloss[:] = 0.0, 0.0, 0.0
    model.opt.gravity[:] = 0.0, 0.0, -9.81
    return model


def disagreement(path, tip, samples=20, seed=0):
    """Largest differences of mass matrix, bias forces and tip pose at random states.

    They are relative to the largest entry; those of forces to the arm's weight, where that is more.
    """
    theirs, ours = own_model(path), RobotModel(read_urdf(path, {}), tip)
    assert [theirs.joint(index).name for index in range(theirs.njnt)] == list(ours.joint_names)
    data, generator, worst = mujoco.MjData(theirs), np.random.default_rng(seed), 0.0
    for _ in range(samples):
        data.qpos[:] = generator.uniform(-1.0, 1.0, theirs.nq) * np.where(ours.prismatic, 0.3, 2.5)
        data.qvel[:] = generator.uniform(-2.0, 2.0, theirs.nv)
        M, theirs_bias = np.zeros((theirs.nv, theirs.nv)), np.zeros(theirs.nv)
        for step in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_makeM, mujoco.mj_comVel):
            step(theirs, data)
        mujoco.mj_rne(theirs, data, 0, theirs_bias)
        mujoco.mj_fullM(theirs, data, M)
        q, dq = data.qpos.copy(), data.qvel.copy()
        bias = ours.gravity_torque(q) + ours.coriolis_torque(q, dq)
        end = data.site(tip) if mujoco.mj_name2id(theirs, mujoco.mjtObj.mjOBJ_SITE, tip) >= 0 else data.body(tip)
        pose = np.hstack([end.xmat.reshape(3, 3), end.xpos[:, None]])
        weight = 9.81 * ours.mass  # prismatic joints across gravity carry none
        for one, other, least in (
            (ours.mass_matrix(q), M, 0.0),
            (bias, theirs_bias, weight),
            (ours.tip_pose(q)[:3], pose, 0.0),
        ):
            worst = max(worst, float(np.abs(one - other).max() / max(np.abs(other).max(), least)))
    return worst
