"""Playback of a motion as an offline viser recording: a shared player page, and the scene without a server."""

import asyncio
import base64
import contextlib
import re
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from typing import cast

import numpy as np
import viser
from numpy.typing import NDArray
from viser import FrameHandle

# viser offers recording only on a running server, so these parts of it are used that it does not export. The version
# is pinned in constraints.txt, and a test renders a playback.
from viser._scene_api import SceneApi
from viser._viser import InitialCameraConfig
from viser.infra import Message, StateSerializer, WebsockMessageHandler, WebsockServer
from viser.infra._async_message_buffer import AsyncMessageBuffer

from runner.base.arrays import FloatArray
from runner.reporting.charts import palette
from runner.reporting.document import Body, Playback

FRAME_RATE = 30.0
"""Most frames a second."""
FRAMES = 150
"""Most frames of a playback."""

_FIELD_OF_VIEW = np.radians(40.0)
_PATH_COLOR = 1
_PIECES = 400
_EMBEDDED = re.compile(r'<script>window\.__VISER_EMBED_DATA__="[^"]*";.*?</script>', re.DOTALL)
# One script for all scenes, and one code from an address, so that a policy can list the player's scripts.
_START = (
    "<script>window.__VISER_EMBED_DATA__=frameElement.dataset.scene;"
    'window.__VISER_EMBED_CONFIG__={darkMode:frameElement.dataset.dark==="true"};</script>'
)
_INLINE = "e.textContent=code;"
_BY_ADDRESS = 'e.src=URL.createObjectURL(new Blob([code],{type:"text/javascript"}));'


@dataclass(frozen=True)
class _Extent:
    """The box that holds the motion: its least and greatest corner, shape (3,) [m]."""

    low: FloatArray
    high: FloatArray

    @property
    def center(self) -> FloatArray:
        return (self.low + self.high) / 2

    @property
    def radius(self) -> float:
        return max(float(np.linalg.norm(self.high - self.low)) / 2, 1e-3)


@cache
def player() -> str:
    """Return the page of the player; it takes its scene from the frame that it stands in, as `data-scene`.

    Raises:
        RuntimeError: If viser writes its page in another form than this project knows.
    """
    with recorder() as stage:
        page = stage.recording.as_html()
    whole, found = _EMBEDDED.subn(_START, page)
    if found != 1 or whole.count(_INLINE) != 1:
        raise RuntimeError("viser's as_html() no longer embeds its scene, or no longer runs its code, as it did")
    return whole.replace(_INLINE, _BY_ADDRESS)


def record(playback: Playback) -> str:
    """Return the scene and its motion as the player takes it, base64: a recording that needs no server."""
    chosen = frames(playback)
    with recorder() as stage:
        _set_stage(stage, playback, chosen)
        nodes = [_add_body(stage, body, f"/body_{number}") for number, body in enumerate(playback.bodies)]
        for previous, frame in zip([None, *chosen[:-1]], chosen, strict=True):
            if previous is not None:
                stage.recording.insert_sleep(float(playback.times[frame] - playback.times[previous]))
            for node, body in zip(nodes, playback.bodies, strict=True):
                node.position = body.positions[frame]
                node.wxyz = body.rotations[frame]
        scene = stage.recording.serialize()
    return base64.b64encode(scene).decode("ascii")


def frames(playback: Playback) -> list[int]:
    """Return the indices of the instants to show: evenly spaced, and none from where a body's pose is not finite."""
    times = np.asarray(playback.times)
    finite = np.isfinite(times)
    for body in playback.bodies:
        finite &= np.isfinite(body.positions).all(axis=1) & np.isfinite(body.rotations).all(axis=1)
    length = times.size if finite.all() else int(finite.argmin())
    if length == 0:
        return []
    span = float(times[length - 1] - times[0])
    count = min(FRAMES, length, int(span * FRAME_RATE) + 1)
    wanted = np.linspace(times[0], times[length - 1], count)
    return [int(index) for index in np.unique(np.searchsorted(times[:length], wanted - 1e-9))]


def _set_stage(stage: "Recorder", playback: Playback, chosen: list[int]) -> None:
    extent = _extent(playback, chosen)
    low, size = extent.low, extent.radius
    cell = 10.0 ** np.floor(np.log10(size))
    stage.scene.add_grid(
        "/floor",
        width=20 * size,
        height=20 * size,
        position=(0.0, 0.0, float(min(low[2], 0.0))),
        cell_size=cell / 2,
        section_size=cell * 2,
        cell_thickness=0.6,
        section_thickness=1.0,
        fade_distance=12 * size,
    )
    for name, path, color in (
        ("/desired", _dashes(playback.desired), palette.rgb_of(palette.DESIRED)),
        ("/path", _segments(playback.path), palette.rgb(_PATH_COLOR)),
    ):
        if path.size:
            stage.scene.add_line_segments(name, points=path, colors=color, thickness=3.0, thickness_units="screen")
    camera = stage.initial_camera
    direction = _view(extent)
    distance = 1.12 * size / np.sin(_FIELD_OF_VIEW / 2)
    camera.fov = float(_FIELD_OF_VIEW)
    camera.near, camera.far = size / 100, size * 100
    camera.position = extent.center + distance * direction
    camera.look_at = extent.center


def _add_body(stage: "Recorder", body: Body, name: str) -> FrameHandle:
    color = palette.rgb(body.color)
    node = stage.scene.add_frame(name, show_axes=False)
    for number, (start, end, radius) in enumerate(body.segments):
        axis = np.subtract(end, start)
        length = float(np.linalg.norm(axis))
        if length > 0:
            stage.scene.add_cylinder(
                f"{name}/segment_{number}",
                radius=radius,
                height=length,
                color=color,
                wxyz=_turn_from_z(axis / length),
                position=np.add(start, end) / 2,
            )
    for number, (center, radius) in enumerate(body.balls):
        stage.scene.add_icosphere(f"{name}/ball_{number}", radius=radius, color=color, position=center)
    return node


def _extent(playback: Playback, chosen: list[int]) -> _Extent:
    """Return the box around all bodies at all shown instants and both paths."""
    corners = [path[np.isfinite(path).all(axis=1)] for path in (playback.path, playback.desired) if path is not None]
    for body in playback.bodies:
        ends = [(point, radius) for *points, radius in body.segments for point in points]
        for point, radius in [*ends, *body.balls]:
            places = body.positions[chosen] + _rotated(body.rotations[chosen], np.asarray(point, dtype=float))
            corners += [places - radius, places + radius]
    points = np.concatenate(corners) if corners else np.zeros((0, 3))
    if not points.size:
        points = np.zeros((1, 3))
    return _Extent(points.min(axis=0), points.max(axis=0))


def _view(extent: _Extent) -> FloatArray:
    """Return the unit vector from the motion to the camera: square to the plane of a planar arm, otherwise oblique."""
    size = extent.high - extent.low
    direction = [0.9, -1.3, 0.75]
    thin = int(size.argmin())
    if size[thin] < 0.25 * size.max():
        # A little from the side, so that depth is seen.
        direction = {0: [1.0, -0.35, 0.3], 1: [0.35, -1.0, 0.3], 2: [0.25, -0.6, 1.0]}[thin]
    return np.array(direction) / float(np.linalg.norm(direction))


def _rotated(quaternions: FloatArray, vector: FloatArray) -> FloatArray:
    """Return a vector turned by quaternions w, x, y, z of shape (T, 4), shape (T, 3)."""
    unit = quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)
    w, v = unit[:, :1], unit[:, 1:]
    cross = np.cross(v, vector)
    turned: FloatArray = vector + 2 * (w * cross + np.cross(v, cross))
    return turned


def _turn_from_z(axis: FloatArray) -> FloatArray:
    """Return the quaternion w, x, y, z that turns the z axis to a unit vector."""
    x, y, z = axis
    if z < -1 + 1e-9:
        return np.array([0.0, 1.0, 0.0, 0.0])
    quaternion = np.array([1 + z, -y, x, 0.0])
    return quaternion / float(np.linalg.norm(quaternion))


def _segments(path: FloatArray | None) -> NDArray[np.float32]:
    """Return a path as line segments, shape (N, 2, 3)."""
    if path is None:
        return np.zeros((0, 2, 3), dtype=np.float32)
    points = path[np.isfinite(path).all(axis=1)]
    if len(points) > _PIECES:
        points = points[np.linspace(0, len(points) - 1, _PIECES).astype(int)]
    return np.stack([points[:-1], points[1:]], axis=1).astype(np.float32)


def _dashes(path: FloatArray | None) -> NDArray[np.float32]:
    """Return a path as dashes of equal length, shape (N, 2, 3)."""
    segments = _segments(path)
    if not segments.size:
        return segments
    points = np.concatenate([segments[:, 0], segments[-1:, 1]]).astype(float)
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    even = np.linspace(0.0, length[-1], 2 * 60)
    resampled = np.stack([np.interp(even, length, points[:, axis]) for axis in range(3)], axis=1)
    return np.stack([resampled[:-1:2], resampled[1::2]], axis=1).astype(np.float32)


class _Sink(WebsockMessageHandler):
    """Takes the messages of a scene for the recording alone."""

    def __init__(self) -> None:
        super().__init__()
        loop = asyncio.new_event_loop()
        loop.close()
        # Nobody reads from it: a closed loop makes a buffer that has nobody to wake.
        self._buffer = AsyncMessageBuffer(loop, persistent_messages=False)

    def get_message_buffer(self) -> AsyncMessageBuffer:
        return self._buffer


class Recorder(viser.ViserServer):
    """A viser server that was never started, with the scene and the first camera of a real one.

    Attributes:
        recording: What the scene has been told so far; `insert_sleep` parts the frames, `as_html` ends it.
    """

    def __init__(self, executor: ThreadPoolExecutor) -> None:
        sink = _Sink()
        self.recording: StateSerializer = sink.get_message_serializer(_of_scene)
        self._websock_server = cast(WebsockServer, sink)
        self._scene_lifecycle_lock = threading.RLock()
        self._initial_camera = InitialCameraConfig(broadcast=sink.queue_message)
        self.scene = SceneApi(self, thread_executor=executor, event_loop=sink.get_message_buffer().event_loop)
        self.scene.set_up_direction("+z")


@contextlib.contextmanager
def recorder() -> Iterator[Recorder]:
    """Open a scene to be recorded."""
    with ThreadPoolExecutor(max_workers=1) as executor:
        yield Recorder(executor)


def _of_scene(message: Message) -> bool:
    return message.include_in_scene_serialization
