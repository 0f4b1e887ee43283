"""Tip (end effector) of an arm: the chosen frame, and the alternatives."""

import re

from runner.base.errors import RunnerError, nearest
from runner.base.sanitize import few
from runner.doctor.finding import DoctorFinding
from runner.robots.elements import end_of, moves
from runner.robots.tree import UrdfTree

_PARTS = r"(_?\d*(_?(link|frame|site|point|body))?)"
_TIPS = (
    rf"(.*[_/-])?(tcp|(tool|gripper)_?cent(er|re)(_point)?|grasp(_?target)?|grip_site|pinch){_PARTS}",
    rf"(.*[_/-])?(ee|eef|end_?effector|tool|tip|attachment|tool_?tip|gripper_(tool|frame|base)){_PARTS}",
    rf"(.*[_/-])?flange{_PARTS}",
    rf"(.*[_/-])?(hand|palm|gripper){_PARTS}",
)
"""Names of frames to which a tool or a hand belongs, the best ones first."""
_JAW = re.compile(r"jaw|finger|gripper|claw|pinch|grasp|thumb", re.IGNORECASE)
_FINGERS = re.compile(r"jaw|finger|claw|thumb|grippermover", re.IGNORECASE)
_SENSOR = re.compile(r"camera|optical|lens|imu|sensor|lidar|laser", re.IGNORECASE)
_WRIST = re.compile(r"wrist|roll|yaw|pitch|rotat|twist", re.IGNORECASE)
_FEWEST = 3  # joints of an arm, below its hand


def choose_tip(tree: UrdfTree, wanted: str | None) -> str:
    """Return the link that is the tip: the one wanted, or the best one where the arm ends.

    The arm ends before it branches into fingers, and before a single jaw. If the same joints move several links there,
    the tip is the one whose name says so, else the farthest.

    Raises:
        RunnerError: if there is no such link, nothing moves it, or the tree has several arms and no tip was named.
    """
    if wanted is not None:
        if wanted not in tree.links:
            raise RunnerError(f"--tip: no link '{wanted}'{nearest(wanted, tree.links)}; links: {few(list(tree.links))}")
        if not moving(tree, wanted):
            raise RunnerError(f"--tip: no joint moves the link '{wanted}'; choose one of {few(_offered(tree))}")
        return wanted
    if not any(map(moves, tree.joints.values())):
        raise RunnerError(f"{tree.robot.get('name')} has no joint that moves: it is not an arm")
    ends = _ends(tree)
    if len(ends) == 1:
        return frames_at(tree, ends[0])[0]
    counts = {tip: len(moving(tree, tip)) for tip in _offered(tree)}
    ways = "; ".join(f"{tip} behind {count} joint{'s' * (count != 1)}" for tip, count in counts.items())
    raise RunnerError(
        f"{tree.robot.get('name')} branches, and the runner takes serial arms: name the tip by --tip FRAME, and the "
        f"joints that are not on the way to it are held fixed; ends: {ways}"
    )


def name_tips(tree: UrdfTree, tip: str) -> DoctorFinding:
    """Return the link that is the tip, and other candidates: with the same joints, or with more or fewer."""
    same = [frame for frame in frames_at(tree, tip) if frame != tip]
    told = [f"--tip takes another that the same joints move: {few(same)}"] if same else []
    way = moving(tree, tip)
    beside = [name for name, joint in tree.joints.items() if moves(joint) and name not in way]
    behind = {
        end_of(tree.joints[name], "child"): name
        for name in beside
        if set(way) < set(tree.way(end_of(tree.joints[name], "child")))
    }
    if behind:
        told.append(f"or one behind further joints: {few([f'{link} ({joint})' for link, joint in behind.items()])}")
    return DoctorFinding("note", "tip", f"'{tip}', moved by {len(way)} joints", "; ".join(told))


def frames_at(tree: UrdfTree, link: str) -> list[str]:
    """Return the links that the same joints move as a link, itself included, the best tip first."""
    way = moving(tree, link)
    links = [each for each in reversed(tree.links) if moving(tree, each) == way]  # of equal ones the last
    return sorted(links, key=lambda each: _order(tree, each))


def moving(tree: UrdfTree, link: str) -> list[str]:
    """Return the joints that move a link, from the base outwards."""
    return [name for name in tree.way(link) if moves(tree.joints[name])]


def _order(tree: UrdfTree, link: str) -> tuple[int, int]:
    """Return the sort key of links as tips: by name, cameras and sensors last, then the farthest first."""
    if _SENSOR.search(link):
        return len(_TIPS) + 1, -len(tree.way(link))
    named = [] if _FINGERS.search(link) else [name for name in _TIPS if re.fullmatch(name, link.lower())]
    return _TIPS.index(named[0]) if named else len(_TIPS), -len(tree.way(link))


def _offered(tree: UrdfTree) -> list[str]:
    return [frames_at(tree, end)[0] for end in _ends(tree) if moving(tree, end)]


def _ends(tree: UrdfTree) -> list[str]:
    """Return the links where an arm ends: one, unless several branches could be the arm."""
    behind: dict[str, int] = {}  # most joints that move behind one another, from each joint on
    for end in tree.ends:
        count = 0
        for joint in reversed(tree.way(end)):
            count += moves(tree.joints[joint])
            behind[joint] = max(count, behind.get(joint, 0))
    borne: dict[str, list[str]] = {}
    for joint in sorted(filter(behind.get, behind), key=behind.__getitem__, reverse=True):
        borne.setdefault(end_of(tree.joints[joint], "parent"), []).append(joint)
    found, starts = [], [tree.root]
    while starts:
        link, before, joints = starts[0], len(moving(tree, starts[0])), borne.get(starts.pop(0), [])
        longest, second = (*(behind[joint] for joint in joints), 0, 0)[:2]
        hand = before >= _FEWEST and second > 0 and longest < before and longest - second <= 1
        if not joints or hand or (before >= _FEWEST and longest == 1 and _is_jaw(tree, joints[0])):
            found.append(link)
        else:
            one = not second or (second < _FEWEST and longest - second > 1)
            starts += [end_of(tree.joints[joint], "child") for joint in (joints[:1] if one else joints)]
    return found


def _is_jaw(tree: UrdfTree, joint: str) -> bool:
    """Return True if a joint moves and it, or its link, has the name of a jaw."""
    named = _JAW.search(joint) and not _WRIST.search(joint)
    return moves(tree.joints[joint]) and bool(named or _FINGERS.search(end_of(tree.joints[joint], "child")))
