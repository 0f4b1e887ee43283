"""Which frame of an arm is its tip, and which others could be."""

from runner.errors import RunnerError, nearest
from runner.robots.tree import UrdfTree, moves


def choose_tip(tree: UrdfTree, wanted: str | None) -> str:
    """Return the link that is the tip: the one wanted, or the farthest one behind all joints that move.

    Raises:
        RunnerError: if there is no such link, nothing moves it, or the tree branches and no tip was named.
    """
    if wanted is not None:
        if wanted not in tree.links:
            raise RunnerError(f"--tip: no link '{wanted}'{nearest(wanted, tree.links)}; links: {', '.join(tree.links)}")
        if not _moving(tree, wanted):
            raise RunnerError(f"--tip: no joint moves the link '{wanted}'; choose one of {', '.join(_ends(tree))}")
        return wanted
    every = [name for name, joint in tree.joints.items() if moves(joint)]
    if not every:
        raise RunnerError(f"{tree.robot.get('name', 'the robot')} has no joint that moves: it is no arm")
    behind_all = [link for link in tree.links if len(_moving(tree, link)) == len(every)]
    if behind_all:
        return max(behind_all, key=lambda link: len(tree.way(link)))
    ways = "; ".join(f"{link} behind {len(_moving(tree, link))} of {len(every)} joints" for link in _ends(tree))
    raise RunnerError(
        f"{tree.robot.get('name', 'the robot')} branches, and the runner takes serial arms: name the tip by --tip "
        f"FRAME, and the joints beside the way to it are held fixed; ends: {ways}"
    )


def frames_at_the_end(tree: UrdfTree, tip: str) -> list[str]:
    """Return the links that the same joints move as the tip, the tip included, in the file's order."""
    way = _moving(tree, tip)
    return [link for link in tree.links if _moving(tree, link) == way]


def _moving(tree: UrdfTree, link: str) -> list[str]:
    return [name for name in tree.way(link) if moves(tree.joints[name])]


def _ends(tree: UrdfTree) -> list[str]:
    return [link for link in tree.ends if _moving(tree, link)]
