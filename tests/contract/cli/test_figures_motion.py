"""`runner figures --motion`: animated files of stored runs."""

import io
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter
from PIL import Image
from support.sample_document import playback

from runner.reporting.charts.sheet import column
from runner.reporting.export import motion
from runner.reporting.export.motion import speed_told, write_motion

SMALL = column(60.0)


def pictures(path):
    with Image.open(path) as image:
        found = []
        for frame in range(image.n_frames):
            image.seek(frame)
            found.append((image.info["duration"], np.asarray(image.convert("RGB"), dtype=int)))
    return found


@pytest.mark.costs(3)
def test_a_motion_lasts_as_long_as_the_run_and_rests_for_a_second(tmp_path):
    found = pictures(write_motion(playback(), tmp_path / "m.gif", SMALL))
    assert sum(duration for duration, _ in found) == pytest.approx(3000, abs=50)  # 2 s and 1 s
    assert all(duration % 10 == 0 for duration, _ in found)
    assert np.abs(found[0][1] - found[len(found) // 2][1]).max() > 100
    assert found[0][1].shape[1] == int(60 / 25.4 * 150)


@pytest.mark.costs(3)
@pytest.mark.parametrize(("frames", "last"), [(60, 2.0), (61, 2.0), (114, 4.0), (30, 1.1)])
def test_a_gif_takes_the_time_of_the_run_at_any_rate(tmp_path, frames, last):
    """Fault 4: 60 frames of 30 ms for 2 s are 11 % too fast, as a GIF counts hundredths of a second."""
    motion = playback(frames, times=np.linspace(0.0, last, frames), desired=None)
    found = [duration for duration, _ in pictures(write_motion(motion, tmp_path / "m.gif", SMALL))]
    rest = int((frames - 1) / last) / ((frames - 1) / last)  # frames of the last second, and the last of the motion
    assert sum(found) / 1e3 == pytest.approx(last + rest + last / (frames - 1), abs=0.011)
    assert speed_told(motion) == ""


def test_a_motion_that_is_too_long_is_told_to_be_faster():
    assert speed_told(playback(13, times=np.linspace(0.0, 12.0, 13))) == (
        "the motion of 12 s is shown at 10 times its speed, which the picture says"
    )


@pytest.mark.skipif(not FFMpegWriter.isAvailable(), reason="ffmpeg is not installed")
def test_a_video_plays_while_it_is_loaded(tmp_path):
    """Question 24: the index of an MP4, `moov`, is before its pictures, `mdat`."""
    content = write_motion(playback(10, times=np.linspace(0.0, 0.5, 10)), tmp_path / "m.mp4", SMALL).read_bytes()
    assert 0 < content.index(b"moov") < content.index(b"mdat")


class Frames(AbstractMovieWriter):
    """Keeps the first frame and the last as SVG."""

    kept: list[str]

    def setup(self, fig, outfile, dpi=None):
        super().setup(fig, outfile, dpi)
        self.kept = []

    def grab_frame(self, **_):
        picture = io.StringIO()
        self.fig.savefig(picture, format="svg")
        self.kept = [*self.kept[:1], picture.getvalue()]

    def finish(self):
        self.outfile.write_bytes(b"frames")


@pytest.mark.costs(2)
def test_the_drawn_arm_and_its_ghost_are_as_recorded(tmp_path, monkeypatch, as_recorded):
    writer = Frames()
    monkeypatch.setattr(motion, "GifWriter", lambda rate: writer)
    ghost = playback(20, name="B", desired=None)
    write_motion(playback(20, name="A", ends="failed at 2 s", others=[ghost]), tmp_path / "m.gif", SMALL)
    as_recorded("drawings", "motion", writer.kept)


@pytest.mark.costs(3)
def test_the_picture_has_the_speed_unless_it_is_that_of_the_run(tmp_path):
    """The letters behind the time make the first line longer."""
    shares = []
    for last in (2.0, 120.0):
        motion = playback(30, times=np.linspace(0.0, last, 30), desired=None)
        picture = pictures(write_motion(motion, tmp_path / "m.gif", SMALL))[0][1]
        shares.append(np.flatnonzero((picture[:12].max(axis=2) < 160).any(axis=0)).max() / picture.shape[1])
    assert shares[0] < 0.2
    assert shares[1] > 0.3


@pytest.mark.costs(3)
def test_a_run_that_failed_stops_where_it_did_and_the_picture_says_so(tmp_path):
    """The arm and its ghost are alike, but the arm ends at half of the time."""
    early = replace(playback(), ends="failed at 1 s", name="A", desired=None)
    half = replace(early, times=early.times[:30], bodies=[
        replace(body, positions=body.positions[:30], rotations=body.rotations[:30]) for body in early.bodies
    ])  # fmt: skip
    ghost = playback(name="B", desired=None)
    stopped = pictures(write_motion(replace(half, others=[ghost]), tmp_path / "a.gif", SMALL))
    whole = pictures(write_motion(replace(playback(name="A", desired=None), others=[ghost]), tmp_path / "b.gif", SMALL))
    dark = [[(picture.max(axis=2) < 160).sum() for _, picture in found] for found in (stopped, whole)]
    assert len(stopped) > 2
    assert np.abs(stopped[-1][1] - whole[-1][1]).max() > 100  # arm and words
    assert dark[0][-1] > dark[1][-1]  # the words


def test_without_ffmpeg_a_video_becomes_a_gif(tmp_path, monkeypatch):
    monkeypatch.setattr(FFMpegWriter, "isAvailable", classmethod(lambda _: False))
    short = playback(3, times=np.array([0.0, 0.05, 0.1]))
    assert write_motion(short, tmp_path / "m.mp4", SMALL) == tmp_path / "m.gif"
    assert (tmp_path / "m.gif").read_bytes().startswith(b"GIF89a")


@pytest.mark.costs(5)
def test_a_failed_run_is_written_up_to_its_failure(cli, copy_run, tmp_path):
    ending = cli("figures", copy_run("failed"), "--motion", tmp_path / "m.gif", "--width", "60")
    assert (ending.code, ending.out) == (0, f"{tmp_path / 'm.gif'}\n")
    assert "its figures show repetition 0, up to " in ending.err
    assert pictures(tmp_path / "m.gif")


@pytest.mark.costs(5)
def test_two_runs_are_compared_and_their_names_printed(cli, copy_run, tmp_path):
    both = (copy_run("goal"), copy_run("other seed"))
    ending = cli("figures", *both, "--motion", tmp_path / "m.gif", "--width", "60")
    assert ending.code == 0
    assert "runner: the arm is A\nrunner: the grey arm is B\n" in ending.err


def test_another_ending_is_rejected_before_anything_is_read(cli, copy_run, tmp_path):
    ending = cli("figures", copy_run("goal"), "--motion", tmp_path / "m.avi")
    assert ending.code == 2
    assert f"--motion {tmp_path / 'm.avi'}: unknown ending '.avi'. Allowed: .gif, .mp4." in ending.err


def test_a_run_without_a_trace_has_no_motion(cli, copy_run, tmp_path):
    made = copy_run("goal")
    (made / "trace.parquet").unlink()
    ending = cli("figures", made, "--motion", tmp_path / "m.gif")
    assert ending.code == 2
    assert len(ending.err.splitlines()) == 1
    assert not (tmp_path / "m.gif").exists()
