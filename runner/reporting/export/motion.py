"""Motions as animated GIFs or MP4 videos, drawn without a display."""

import io
import itertools
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

from runner.base.arrays import FloatArray
from runner.base.atomic import write_atomically
from runner.reporting.charts import palette
from runner.reporting.charts.canvas import GREY, INK, PALE, Camera, scene
from runner.reporting.charts.sheet import Sheet, style, wrap_text
from runner.reporting.document import Playback
from runner.reporting.playback import body_shapes, finite_places, first_view, frames

_DOTS = 150  # in an inch
_SLOWEST, _FASTEST = 10.0, 30.0  # frames a second
_HUNDREDTH = 0.01  # s, of which a GIF counts whole ones
_EXACT = 1e-3  # share of the speed that is not said
_LAST = 1.0  # s for which the last frame stays
_SHARE = 0.75  # height over width
_GHOST = "#b9c0c8"


class GifWriter(AbstractMovieWriter):
    """A writer of GIFs: a frame lasts whole hundredths of a second, and all of them the time of the run.

    Args:
        rate: Frames a second.
    """

    def __init__(self, rate: float) -> None:
        super().__init__(fps=round(rate))
        self._rate = rate
        self._kept: list[Image.Image] = []

    def setup(self, fig: Figure, outfile: str | Path, dpi: float | None = None) -> None:
        """Begin a file."""
        super().setup(fig, outfile, dpi)

    def grab_frame(self, **options: Any) -> None:
        """Keep the figure as a frame."""
        picture = io.BytesIO()
        self.fig.savefig(picture, format="rgba", dpi=self.dpi, **options)
        self._kept.append(Image.frombytes("RGBA", self.frame_size, picture.getvalue()).convert("RGB"))

    def finish(self) -> None:
        """Write the frames."""
        ends = [round(place / self._rate / _HUNDREDTH) for place in range(len(self._kept) + 1)]
        last = [round(1000 * _HUNDREDTH) * (end - start) for start, end in itertools.pairwise(ends)]
        first, *others = self._kept
        first.save(self.outfile, save_all=True, append_images=others, duration=last, loop=0)


@dataclass
class _Drawn:
    """A run in the picture.

    Attributes:
        run: Its motion.
        kept: Indices of its frames.
        lines: Each shape of the arm: its line, its ends in the picture, shape (T, 2 or 1, 2), and their nearness.
        front: What is added to the nearness, so that the run is in front of its ghost.
    """

    run: Playback
    kept: list[int]
    lines: list[tuple[Line2D, FloatArray, FloatArray]]
    front: float

    def show(self, time: float) -> None:
        """Move the lines to an instant, or to the last frame before it."""
        times = self.run.times[self.kept]
        frame = self.kept[max(0, int(np.searchsorted(times, time + 1e-9)) - 1)]
        for line, ends, near in self.lines:
            line.set_data(ends[frame, :, 0], ends[frame, :, 1])
            line.set_zorder(self.front + near[frame])

    def remark(self, time: float) -> str:
        """Return why a run that has ended did so."""
        return self.run.ends if time >= self.run.times[self.kept[-1]] - 1e-9 else ""


def write_motion(playback: Playback, path: Path, sheet: Sheet) -> Path:
    """Write a motion as a file, with the last of the other runs as a ghost; return its path.

    Args:
        playback: The motion.
        path: Name of the file; it ends in .gif or .mp4. Without ffmpeg an MP4 becomes a GIF.
        sheet: Width and letters.

    Raises:
        StoreError: If the file cannot be written.
    """
    video = path.suffix.lower() == ".mp4" and FFMpegWriter.isAvailable()
    path = path if video or path.suffix.lower() == ".gif" else path.with_suffix(".gif")
    runs, (times, shown, speed) = _shown(playback), _timing(playback)
    # What a player has to know of a video is at its beginning, so that it plays while it is loaded.
    begun = ["-movflags", "+faststart"]
    writer: AbstractMovieWriter
    writer = FFMpegWriter(fps=shown, extra_args=begun) if video else GifWriter(shown)  # type: ignore[arg-type]
    with mpl.rc_context(style(sheet)), tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / f"motion{path.suffix.lower()}"
        _draw(runs, times, shown, speed, sheet, writer, made)
        write_atomically(path, made.read_bytes())
    return path


def speed_told(playback: Playback) -> str:
    """Return a sentence on a motion that is shown faster or slower than the run; empty for the time of the run."""
    times, _, speed = _timing(playback)
    if abs(speed - 1.0) < _EXACT:
        return ""
    return f"the motion of {times[-1] - times[0]:.4g} s is shown at {speed:.3g} times its speed, which the picture says"


def _shown(playback: Playback) -> list[Playback]:
    """Return the run, and its ghost if it has one."""
    return [playback, *playback.others[-1:]]


def _timing(playback: Playback) -> tuple[FloatArray, float, float]:
    """Return the times of the frames, in s, the frames a second, and the speed of the picture over that of the run."""
    times = max((run.times[frames(run)] for run in _shown(playback)), key=lambda kept: float(kept[-1]))
    rate = (len(times) - 1) / max(float(times[-1] - times[0]), 1e-9)
    shown = min(max(rate, _SLOWEST), _FASTEST)
    return times, shown, shown / rate if rate else 1.0


def _draw(
    runs: list[Playback],
    times: FloatArray,
    rate: float,
    speed: float,
    sheet: Sheet,
    writer: AbstractMovieWriter,
    path: Path,
) -> None:
    azimuth, elevation = np.degrees(first_view(runs[0]))
    camera = Camera(float(azimuth), float(elevation))
    size = (sheet.width, _SHARE * sheet.width)
    figure, axes = scene(*size)
    low, high = _limits(runs, camera)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    points = 72.0 * min(size[0] / (high[0] - low[0]), size[1] / (high[1] - low[1]))  # in a metre
    _draw_floor(axes, runs, camera)
    drawn = [_add(axes, run, camera, points, ghost=place > 0) for place, run in enumerate(runs)]
    text = figure.text(0.02, 0.98, "", va="top", color=INK, fontsize=sheet.font)
    text.set_parse_math(False)
    fast = "" if abs(speed - 1.0) < _EXACT else f"   (speed × {speed:.3g})"
    with writer.saving(figure, path, _DOTS):
        for time in [*times, *np.repeat(times[-1:], int(_LAST * rate))]:
            lines = [f"{time:.2f} s{fast}"]
            for each, word in zip(drawn, ("", "grey: "), strict=False):
                each.show(float(time))
                said = f"{each.run.name} {each.remark(float(time))}".strip()
                lines += [wrap_text(f"{word}{said}", 0.96 * sheet.width / sheet.character)] if said else []
            text.set_text("\n".join(lines))
            writer.grab_frame()


def _limits(runs: list[Playback], camera: Camera) -> tuple[FloatArray, FloatArray]:
    """Return the lower left and the upper right corner of the picture."""
    flat = camera.project(np.concatenate([finite_places(run) for run in runs]))
    low, high = flat.min(axis=0), flat.max(axis=0)
    width, height = np.array([1.1, 1.3]) * (high - low) + 1e-3
    half = max(width, height / _SHARE) / 2.0 * np.array([1.0, _SHARE])
    middle = (low + high) / 2.0 + np.array([0.0, 0.07 * half[1]])  # room for the text
    return middle - half, middle + half


def _draw_floor(axes: Axes, runs: list[Playback], camera: Camera) -> None:
    places = np.concatenate([finite_places(run) for run in runs])
    low, high = places.min(axis=0), places.max(axis=0)
    cell = 10.0 ** np.floor(np.log10(max(float(np.ptp(places, axis=0).max()), 1e-9))) / 2.0
    floor = min(0.0, float(low[2]))
    first, last = np.floor(low[:2] / cell) - 1, np.ceil(high[:2] / cell) + 1
    for x in cell * np.arange(first[0], last[0] + 1):
        ends = np.array([[x, cell * first[1], floor], [x, cell * last[1], floor]])
        axes.plot(*camera.project(ends).T, color=PALE, lw=0.5, zorder=-1e6)
    for y in cell * np.arange(first[1], last[1] + 1):
        ends = np.array([[cell * first[0], y, floor], [cell * last[0], y, floor]])
        axes.plot(*camera.project(ends).T, color=PALE, lw=0.5, zorder=-1e6)


def _add(axes: Axes, run: Playback, camera: Camera, points: float, ghost: bool) -> _Drawn:
    """Add a run to the picture; a ghost is grey and behind everything."""
    if run.desired is not None and not ghost:
        axes.plot(*camera.project(run.desired).T, color=GREY, lw=1.2, ls=(0, (4, 2)), zorder=-1e5)
    color = palette.color(1 if run.look is None else run.look)
    axes.plot(*camera.project(run.path).T, color=_GHOST if ghost else color, lw=1.2, zorder=-1e5)
    lines = list(_shape_lines(axes, run, camera, points, ghost))
    return _Drawn(run, frames(run), lines, -1e4 if ghost else 0.0)


def _shape_lines(
    axes: Axes, run: Playback, camera: Camera, points: float, ghost: bool
) -> Iterator[tuple[Line2D, FloatArray, FloatArray]]:
    for body in run.bodies:
        for ends, radius in body_shapes(body):
            width = max(2.0, 2.0 * points * radius)
            color = _GHOST if ghost else palette.color(body.color)
            flat, near = camera.project(ends), camera.nearness(ends).max(axis=1)
            for more, shade in ((1.2, INK if not ghost else GREY), (0.0, color)):
                (line,) = axes.plot([], [], color=shade, lw=width + more, solid_capstyle="round")
                if ends.shape[1] == 1:
                    line.set(marker="o", markersize=width + more, markeredgewidth=0.0)
                yield line, flat, near + (0.0 if more else 1e-3)
