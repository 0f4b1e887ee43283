"""NumPy's zip files as logs: which arrays are signals, and files that are damaged or promise too much."""

import io
import zipfile

import numpy as np
import pytest

from runner.base.errors import RunnerError
from runner.recordings.files import read_log

T = np.arange(0.0, 13.0, 0.01)
Q = np.column_stack([np.sin(T), np.cos(T)])


def saved(tmp_path, **arrays):
    np.savez_compressed(tmp_path / "log.npz", **arrays)
    return read_log(tmp_path / "log.npz")


def test_vectors_and_matrices_are_columns_whichever_axis_has_the_rows(tmp_path):
    found = saved(tmp_path, t=T, q=Q, dq=np.asfortranarray(Q.T), grip=T > 1.0, tau=Q.astype(">f4"))
    assert list(found.columns) == ["t", "q_0", "q_1", "dq_0", "dq_1", "grip", "tau_0", "tau_1"]
    np.testing.assert_array_equal(found.columns["t"], T)
    for name in ("q_1", "dq_1"):
        np.testing.assert_array_equal(found.columns[name], Q[:, 1])
    np.testing.assert_allclose(found.columns["tau_1"], Q[:, 1], rtol=1e-7)
    assert found.columns["grip"].sum() == (T > 1.0).sum()


def test_a_matrix_of_one_column_is_a_vector(tmp_path):
    """The times of panda-python's log are arrays of one number each."""
    found = saved(tmp_path, time=[np.array([1000.0 * t]) for t in T], q=list(Q))
    assert list(found.columns) == ["time", "q_0", "q_1"]
    np.testing.assert_array_equal(found.columns["time"], 1000.0 * T)


def test_what_is_no_signal_is_named_and_not_unpickled(tmp_path):
    odd = {"gains": np.ones(2), "names": np.array(["a", "b"]), "rate": np.array(100.0), "notes": np.array([{}, None])}
    found = saved(tmp_path, t=T, q=Q, images=np.zeros((len(T), 2, 2)), **odd)
    assert list(found.columns) == ["t", "q_0", "q_1"]
    assert set(found.others) == {"images", *odd}


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"no array", "q.npy is damaged"),
        (None, "its header promises more"),
    ],
)
def test_damaged_arrays_are_named(tmp_path, content, told):
    if content is None:
        stream = io.BytesIO()
        np.lib.format.write_array_header_1_0(stream, {"descr": "<f8", "fortran_order": False, "shape": (10**12,)})
        content = stream.getvalue()
    with zipfile.ZipFile(tmp_path / "log.npz", "w") as archive:
        archive.writestr("q.npy", content)
    with pytest.raises(RunnerError, match=told):
        read_log(tmp_path / "log.npz")


def test_a_file_without_signals_is_named(tmp_path):
    with pytest.raises(RunnerError, match="has no arrays of numbers"):
        saved(tmp_path, names=np.array(["a"]))


@pytest.mark.parametrize("place", range(120, 400, 20))
def test_damaged_compression_is_one_sentence(tmp_path, place):
    saved(tmp_path, q=np.random.default_rng(0).integers(0, 9, len(T)))
    content = bytearray((tmp_path / "log.npz").read_bytes())
    content[place : place + 8] = b"\xff" * 8
    (tmp_path / "log.npz").write_bytes(content)
    with pytest.raises(RunnerError, match=r"log\.npz"):
        read_log(tmp_path / "log.npz")
