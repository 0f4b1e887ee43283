"""An arm of one joint, about z, and one link along y with a mass at its end."""

from runner.robots import RobotModel

LENGTH = 1.5  # m


def one_beam(tip_mass):
    """Return the rigid arm; its flange and tip is `tip`, its link `arm`."""
    none = '<inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/>'
    return RobotModel(
        f"""<robot name="one"><link name="base"/>
        <link name="arm"><inertial><origin xyz="0 {LENGTH} 0"/><mass value="{tip_mass}"/>{none}</inertial></link>
        <joint name="q" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
        <limit lower="-9" upper="9" effort="1e9" velocity="1e9"/></joint>
        <joint name="mount" type="fixed"><parent link="arm"/><child link="tip"/><origin xyz="0 {LENGTH} 0"/></joint>
        <link name="tip"/></robot>""",
        "tip",
    )
