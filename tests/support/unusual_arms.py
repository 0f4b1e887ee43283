"""A small arm of three joints, as unusual but valid files write it."""

Z, Y = '<axis xyz="0 0 1"/>', '<axis xyz="0 1 0"/>'
ORIGIN = '<origin xyz="0 0 0.3"/>'
LIMIT = '<limit lower="-2" upper="2" effort="50" velocity="3"/>'
INERTIA = 'ixx="0.01" ixy="0" ixz="0" iyy="0.012" iyz="0" izz="0.008"'


def link(name, mass="1", inertia=INERTIA, place="0.01 0.02 0.1"):
    return (
        f'<link name="{name}"><inertial><origin xyz="{place}"/><mass value="{mass}"/><inertia {inertia}/></inertial>'
        "</link>\n"
    )


def joint(name, parent, child, axis=Y, origin=ORIGIN, limit=LIMIT, kind="revolute", more=""):
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}{origin}{axis}{limit}{more}</joint>\n'


def fixed(name, parent, child, place="0 0 0.25"):
    return joint(name, parent, child, "", f'<origin xyz="{place}"/>', "", "fixed")


TOOL = '<link name="tool0"/>\n' + fixed("end", "l3", "tool0")


def arm(first="", second="", third="", head="", tail="", links=None, tool=TOOL):
    """The arm; each joint may be given as a whole."""
    links = "".join(map(link, ("base", "l1", "l2", "l3"))) if links is None else links
    joints = (
        first or joint("j1", "base", "l1", Z),
        second or joint("j2", "l1", "l2"),
        third or joint("j3", "l2", "l3"),
    )
    return f'<robot name="arm"{head}>\n{links}{"".join(joints)}{tool}{tail}</robot>'


def first(**changed):
    """The arm with changes of its first joint; see joint."""
    return arm(first=joint("j1", "base", "l1", **({"axis": Z} | changed)))


def second(**changed):
    """The arm with changes of its second joint; see joint."""
    return arm(second=joint("j2", "l1", "l2", **changed))
