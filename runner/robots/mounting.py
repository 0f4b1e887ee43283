"""Mounting of one arm on another: two URDFs merged into one."""

import xml.etree.ElementTree as ET
from collections.abc import Sequence

from runner.base.errors import ConfigError, nearest
from runner.schema.values import MountConfig


def mount(macro: str, mini: str, prefix: str, place: MountConfig) -> tuple[str, str]:
    """Return the URDF of an arm with another arm mounted on it, and the name of the mounted arm's root link.

    The links and joints of the mounted arm get a prefix; the names of the base arm do not change.

    Args:
        macro: URDF of the base arm, or of a chain returned by this function.
        mini: URDF of the mounted arm.
        prefix: Prefix of the mounted arm's names: the name of its stage and an underscore.
        place: Frame and pose of the mount.

    Raises:
        ConfigError: if the frame does not exist, or if a name would not be unique.
    """
    whole, mounted = ET.fromstring(macro), ET.fromstring(mini)  # noqa: S314 - resolves no external entities
    links = _names(whole, "link")
    if place.frame not in links:
        raise ConfigError(
            f"robot.stages.{prefix.rstrip('_')}.mount.frame: no link '{place.frame}'{nearest(place.frame, links)}; "
            f"links: {', '.join(links)}"
        )
    _rename(mounted, prefix)
    for kind in ("link", "joint"):
        twice = sorted(set(_names(whole, kind)) & set(_names(mounted, kind)))
        if twice:
            raise ConfigError(
                f"robot.stages.{prefix.rstrip('_')}: the {kind} name {twice[0]} stands in the carrying arm "
                "already; name the stage differently"
            )
    children = {child.get("link") for child in mounted.findall("joint/child")}
    root = next(name for name in _names(mounted, "link") if name not in children)
    joint = ET.SubElement(whole, "joint", name=f"{prefix}mount", type="fixed")
    ET.SubElement(joint, "parent", link=place.frame)
    ET.SubElement(joint, "child", link=root)
    ET.SubElement(joint, "origin", xyz=_text(place.translation), rpy=_text(place.rotation))
    whole.extend(element for element in mounted if element.tag in ("link", "joint"))
    return ET.tostring(whole, encoding="unicode"), root


def _names(robot: ET.Element, kind: str) -> list[str]:
    return [element.get("name", "") for element in robot.findall(kind)]


def _rename(robot: ET.Element, prefix: str) -> None:
    for element in (*robot.findall("link"), *robot.findall("joint")):
        element.set("name", prefix + element.get("name", ""))
    for joint in robot.findall("joint"):
        for role in ("parent", "child"):
            end = joint.find(role)
            if end is not None:
                end.set("link", prefix + end.get("link", ""))


def _text(values: Sequence[float]) -> str:
    return " ".join(repr(float(value)) for value in values)
