"""Recording of a viser scene without a server: no socket, no thread, no output."""

import asyncio
import contextlib
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import cast

import viser

# viser offers recording only on a running server, so these parts of it are used that it does not export. The version
# is pinned in constraints.txt, and a test renders a playback.
from viser._scene_api import SceneApi
from viser._viser import InitialCameraConfig
from viser.infra import Message, StateSerializer, WebsockMessageHandler, WebsockServer
from viser.infra._async_message_buffer import AsyncMessageBuffer


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
