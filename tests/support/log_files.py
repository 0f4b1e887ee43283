"""Files of logs in every known format, each made by the format's own writer where that can be installed."""

import json
import zipfile
from pathlib import Path

import numpy as np
import pandas as pd
import pinocchio as pin

START = 1_700_000_000_123_456_789  # ns

RTDE = {"t": "timestamp", "q": "actual_q_{}", "dq": "actual_qd_{}", "command": "target_q_{}",
        "tau": "actual_current_as_torque_{}"}  # fmt: skip
PLAIN = {"t": "t", "q": "q{}", "tau": "tau{}"}
FRANKA = {"t": "time", "q": "state.q[{}]", "dq": "state.dq[{}]", "command": "state.q_d[{}]", "tau": "state.tau_J[{}]"}


def arm_signals(arm):
    """Return 4 s of a ur5e, or a panda, at 125 Hz, with friction."""
    t = np.arange(0.0, 4.0, 0.008)
    w = np.array([1.3, 1.9, 1.6, 2.2, 1.1, 2.6, 1.7])[: arm.nq]
    q = np.array([0.1, -1.4, 1.5, -1.5, -1.4, 0.2, 0.3])[: arm.nq] + 0.3 * (1.0 - np.cos(np.outer(t, w)))
    dq, ddq = 0.3 * w * np.sin(np.outer(t, w)), 0.3 * w**2 * np.cos(np.outer(t, w))
    data = arm.pin_model.createData()
    tau = np.array([pin.rnea(arm.pin_model, data, *row) for row in zip(q, dq, ddq, strict=True)]) + dq + np.sign(dq)
    return {"t": t, "q": q, "dq": dq, "tau": tau, "command": q + 0.008 * dq}


def frame(signals, names, first=0):
    """Return a table of signals, a dict of t (N,), q, dq, command and tau (N, n), with columns named by a format."""
    columns = {}
    for kind, name in names.items():
        if kind == "t":
            columns[name] = signals["t"]
        else:
            columns |= {name.format(place + first): signals[kind][:, place] for place in range(signals["q"].shape[1])}
    return pd.DataFrame(columns)


def ros_messages(signals, joints):
    """Return messages of joint states: stamp in ns, names, positions, velocities and efforts."""
    rows = zip(signals["t"], signals["q"], signals["dq"], signals["tau"], strict=True)
    return [(START + round(1e9 * t), list(joints), q, dq, tau) for t, q, dq, tau in rows]


def serialized(messages, old=False, kind="JointState"):
    """Return the bytes of messages by rosbags, with their stamps."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC if old else Stores.ROS2_HUMBLE)
    if kind != "JointState":
        store.register(get_types_from_msg(CONTROLLER_STATE, f"control_msgs/msg/{kind}"))
    types = store.types
    found = []
    for stamp, names, q, dq, tau in messages:
        time = types["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9)
        header = types["std_msgs/msg/Header"](stamp=time, frame_id="base", **({"seq": 0} if old else {}))
        if kind == "JointState":
            message = types["sensor_msgs/msg/JointState"](
                header, names, *(np.array(v, dtype=float) for v in (q, dq, tau))
            )
        else:
            point = types["trajectory_msgs/msg/JointTrajectoryPoint"]
            since = types["builtin_interfaces/msg/Duration"](sec=0, nanosec=0)
            empty = np.zeros(0)
            commanded = point(np.array(q) + 0.001, np.array(dq), empty, empty, since)
            measured = point(np.array(q), np.array(dq), empty, np.array(tau), since)
            message = types[f"control_msgs/msg/{kind}"](header, names, commanded, measured, commanded)
        serialize = store.serialize_ros1 if old else store.serialize_cdr
        found.append((stamp, bytes(serialize(message, message.__msgtype__))))
    return store, found


CONTROLLER_STATE = """
std_msgs/Header header
string[] joint_names
trajectory_msgs/JointTrajectoryPoint reference
trajectory_msgs/JointTrajectoryPoint feedback
trajectory_msgs/JointTrajectoryPoint error
"""


def write_bag(path: Path, messages, form=".mcap", compressed=None, kind="JointState"):
    """Write a bag by rosbags: a file of ROS 1, or a folder of ROS 2."""
    from rosbags import rosbag1, rosbag2

    old = form == ".bag"
    store, rows = serialized(messages, old, kind)
    if old:
        writer = rosbag1.Writer(path)
        if compressed:
            writer.set_compression(rosbag1.Writer.CompressionFormat[compressed])
    else:
        plugin = rosbag2.StoragePlugin.MCAP if form == ".mcap" else rosbag2.StoragePlugin.SQLITE3
        writer = rosbag2.Writer(path, version=9, storage_plugin=plugin)
        if compressed:
            writer.set_compression(rosbag2.CompressionMode[compressed], rosbag2.CompressionFormat.ZSTD)
    package = "sensor_msgs" if kind == "JointState" else "control_msgs"
    with writer:
        connection = writer.add_connection("/joint_states", f"{package}/msg/{kind}", typestore=store)
        for stamp, data in rows:
            writer.write(connection, stamp, data)
    return path


def write_mixed_mcap(path: Path, messages, profile="", cut=1.0):
    """Write an MCAP by mcap: joint states with JSON and protobuf, without a profile, and cut off as by a kill."""
    from mcap.writer import Writer

    _, rows = serialized(messages)
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=20_000)
        writer.start(profile=profile, library="test")
        joints = writer.register_schema("sensor_msgs/msg/JointState", "ros2msg", b"string[] name")
        states = writer.register_channel("/joint_states", "cdr", joints)
        text = writer.register_channel("/text", "json", writer.register_schema("Text", "jsonschema", b"{}"))
        other = writer.register_channel("/proto", "protobuf", writer.register_schema("P", "protobuf", b"\x00"))
        for stamp, data in rows:
            writer.add_message(states, stamp, data, stamp)
            writer.add_message(text, stamp, b"{}", stamp)
            writer.add_message(other, stamp, b"\x00\x01", stamp)
        writer.finish()
    path.write_bytes(path.read_bytes()[: round(cut * path.stat().st_size)])
    return path


def write_meca_zip(path: Path, signals):
    """Write a zip as mecademicpy 3.0.3 does (`RobotTrajectories.to_file`): a JSON file and a CSV file by pandas."""
    degrees = {**signals, "q": np.degrees(signals["q"]), "dq": np.degrees(signals["dq"])}
    names = {"q": "JointPos_{}", "dq": "JointVel_{}", "command": "TargetJointPos_{}"}
    degrees["command"] = np.degrees(signals["command"])
    table = frame(degrees, names).round(6).set_index((1e6 * signals["t"]).round().astype(int))
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("log.json", json.dumps({"robot_information": [], "sent_commands": []}))
        archive.writestr("log_output_df.csv", table.to_csv(index_label="timestamp"))
    return path


def write_lerobot(path: Path, states, names, rate=30.0, episodes=2):
    """Write a LeRobot v3 data set: fixed-size lists of float32, several episodes; actions are 0.01 above the states."""
    import pyarrow as pa
    import pyarrow.parquet

    (path / "meta").mkdir(parents=True)
    (path / "data" / "chunk-000").mkdir(parents=True)
    feature = {"dtype": "float32", "shape": [len(names)], "names": [f"{name}.pos" for name in names]}
    info = {"codebase_version": "v3.0", "fps": rate, "features": {"observation.state": feature, "action": feature}}
    (path / "meta" / "info.json").write_text(json.dumps(info))
    count = len(states)
    rows = np.tile(states, (episodes, 1)).astype(np.float32)
    lists, actions = (
        pa.FixedSizeListArray.from_arrays(pa.array(values.ravel()), len(names)) for values in (rows, rows + 0.01)
    )
    index = np.repeat(np.arange(episodes), count)
    keep = np.r_[np.ones(count, bool), np.arange(count * (episodes - 1)) < count * (episodes - 1) - 10]
    table = pa.table({
        "observation.state": lists, "action": actions,
        "timestamp": pa.array(np.tile(np.arange(count) / rate, episodes).astype(np.float32)),
        "frame_index": np.tile(np.arange(count), episodes), "episode_index": index,
    }).filter(pa.array(keep))  # fmt: skip
    pyarrow.parquet.write_table(table, path / "data" / "chunk-000" / "file-000.parquet")
    return path


def write(folder, table):
    """Write a table as a log, and return its path."""
    table.to_csv(folder / "log.csv", index=False)
    return folder / "log.csv"
