"""Joint states of ROS bags, written here by rosbags, against the numbers that were written."""

import sys

import numpy as np
import pytest

from runner.base.errors import RunnerError
from runner.base.limits import Limit
from runner.recordings import bags
from runner.recordings.columns_map import ColumnsMap, Factor, Signal
from runner.recordings.files import read_log
from runner.recordings.recording import read_recording

WANTED = ["stamp", "a.position", "b.effort"]
COUNT, START = 60, 1_700_000_000_123_456_789  # ns


def read_columns(path, topic, wanted):
    return read_log(path, wanted, topic).of(wanted, "stamp").columns


@pytest.fixture
def write(tmp_path):
    """Return the writer of a bag from messages (stamp in ns, names, positions, efforts) of each topic."""
    pytest.importorskip("rosbags", reason="the extra ros is not installed")
    from rosbags import rosbag1, rosbag2
    from rosbags.typesys import Stores, get_typestore

    def written(topics, suffix=".mcap", compressed=None):
        old = suffix == ".bag"
        store = get_typestore(Stores.ROS1_NOETIC if old else Stores.ROS2_HUMBLE)
        serialize = store.serialize_ros1 if old else store.serialize_cdr
        kinds = store.types
        path = tmp_path / (f"log{suffix}" if old else "log")
        if old:
            writer = rosbag1.Writer(path)
        else:
            plugin = rosbag2.StoragePlugin.MCAP if suffix == ".mcap" else rosbag2.StoragePlugin.SQLITE3
            writer = rosbag2.Writer(path, version=9, storage_plugin=plugin)
            if compressed:
                writer.set_compression(rosbag2.CompressionMode[compressed], rosbag2.CompressionFormat.ZSTD)
        with writer:
            for topic, messages in topics.items():
                connection = writer.add_connection(topic, "sensor_msgs/msg/JointState", typestore=store)
                for stamp, names, positions, efforts in messages:
                    time = kinds["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9)
                    head = {"seq": 0} if old else {}
                    header = kinds["std_msgs/msg/Header"](stamp=time, frame_id="", **head)
                    arrays = (np.array(values, dtype=float) for values in (positions, [], efforts))
                    message = kinds["sensor_msgs/msg/JointState"](header, names, *arrays)
                    writer.write(connection, stamp or START, serialize(message, message.__msgtype__))
        return path if old else next(file for file in path.iterdir() if file.name != "metadata.yaml")

    return written


def states(count=COUNT):
    return [(START + 4_000_000 * k, ["b", "a"], [9.0, 0.1 * k], [0.2 * k, 8.0]) for k in range(count)]


@pytest.mark.parametrize(
    ("suffix", "compressed"), [(".bag", None), (".db3", None), (".mcap", None), (".mcap", "STORAGE")]
)
def test_columns_of_a_bag(write, suffix, compressed):
    gripper = [(START + 1_000_000, ["finger"], [1.0], [])]  # on the same topic, as some drivers publish it
    path = write({"/joint_states": sorted([*states(), *gripper])}, suffix, compressed)
    found = read_columns(path, None, WANTED)
    assert found["stamp"] == pytest.approx(4e-3 * np.arange(COUNT), abs=1e-12)
    assert found["a.position"] == pytest.approx(0.1 * np.arange(COUNT))
    assert found["b.effort"] == pytest.approx(0.2 * np.arange(COUNT))
    if suffix != ".bag":
        of_folder = read_columns(path.parent, None, WANTED)
        assert all(np.array_equal(of_folder[name], found[name]) for name in WANTED)


def test_a_recording_from_a_bag(write):
    said = ColumnsMap(
        time={"column": "stamp", "unit": "s"},
        columns={"a.position": {"joint": "q1", "unit": "rad"}, "b.effort": {"torque": "q1", "unit": "N m"}},
    )
    factors = {"stamp": Factor(1.0, "s"), "a.position": Factor(1.0, "rad"), "b.effort": Factor(2.0, "N m")}
    messages = states()
    path = write({"/joint_states": messages})
    found = read_recording(path, said, factors)
    assert found.period == pytest.approx(4e-3)
    assert found.torque_shift == pytest.approx(2e-3)
    assert found.signals[Signal("torque", "q1")] == pytest.approx(0.4 * np.arange(COUNT))


def test_what_a_bag_lacks_is_named(write, tmp_path):
    messages = states()
    messages[7] = (messages[7][0], ["b", "a"], [9.0, 0.7], [])
    path = write({"/arm": messages, "/other": states(3)})
    for topic, wanted, told in (
        (None, WANTED, r"more than one topic of joint states; say in the column map topic: one of /arm, /other"),
        ("/arn", WANTED, r"no joint states on '/arn' \(did you mean /arm\?\)"),
        ("/arm", ["stamp", "c.position"], r"has no column 'c.position' .*its columns: stamp, b.position"),
    ):
        with pytest.raises(RunnerError, match=told):
            read_columns(path, topic, wanted)
    said = ColumnsMap(rate=250.0, topic="/arm", columns={"b.effort": {"torque": "q1", "unit": "N m"}})
    with pytest.raises(RunnerError, match=r"row 8: b.effort is missing for 0.008 s, .*; `--fill-gaps 8ms` fills"):
        read_recording(path, said, {"b.effort": Factor(1.0, "N m")})
    path.write_bytes(path.read_bytes()[:1000])
    with pytest.raises(RunnerError, match=r"cannot read .*log.mcap: "):
        read_columns(path, "/arm", WANTED)


@pytest.mark.parametrize("compressed", ["STORAGE", "FILE"])
def test_a_bag_that_unpacks_to_more_than_allowed_is_not_held(write, monkeypatch, compressed):
    zeros = [(START, ["a"], np.zeros(8_000_000), [])]  # 64 MB
    folder = write({"/joint_states": zeros}, compressed=compressed).parent
    assert sum(file.stat().st_size for file in folder.iterdir()) < 1_000_000
    monkeypatch.setattr(bags, "BAG_MEMORY", Limit(1_000_000, "bytes"))
    with pytest.raises(
        RunnerError, match=r"cannot read .*(takes more than 1,000,000 bytes|memory|File too large|exceeds limit)"
    ):
        read_columns(folder, None, ["a.position"])


def test_without_the_extra_its_name_is_told(write, monkeypatch):
    path = write({"/joint_states": states()})
    monkeypatch.setitem(sys.modules, "mcap.stream_reader", None)
    with pytest.raises(
        RunnerError, match=r"uv pip install -e '\.\[ros\]'` in the checkout, or `pip install 'WHEEL\[ros\]'`"
    ):
        read_columns(path, None, WANTED)
