from pathlib import Path

import h5py
import numpy as np
import pytest

from ryusa.errors import ResultsError
from ryusa.model import EVENT, Term
from ryusa.results import Results, lazy
from ryusa.results.schema import TALLY

N = 23


@pytest.fixture
def x(folder: Path) -> np.ndarray:
    """Wrapped centres of all frames."""
    k = np.arange(N)[:, None]
    still = np.zeros((N, 1))
    a = np.hstack([0.01 + 1e-4 * k, still, still + 0.01])
    b = np.hstack([still + 0.02, still, 0.01 + 1e-4 * k])
    return np.stack([a, b], axis=1)


def test_frames_are_what_was_recorded(folder: Path, x: np.ndarray) -> None:
    frames = Results.open(folder).frames
    assert len(frames) == N
    assert frames.step.tolist() == list(range(0, 230, 10))
    assert frames.t == pytest.approx(0.1 * np.arange(N))
    assert np.array_equal(frames.x_wrapped[:], x)
    assert np.array_equal(np.asarray(frames.v), 2 * x)
    assert np.array_equal(frames.omega[:], -x)
    assert frames.x.shape == (N, 2, 3)


def test_unwrapped_centres_add_the_periods_crossed(folder: Path, x: np.ndarray) -> None:
    frames = Results.open(folder).frames
    assert frames.x[:, 0, 0] == pytest.approx(x[:, 0, 0] + 0.04 * (np.arange(N) // 10))
    assert np.array_equal(frames.x[:, 1], x[:, 1])
    assert np.array_equal(frames[15].x, frames.x[15])
    assert np.array_equal(frames[15].x_wrapped, x[15])


@pytest.mark.parametrize(
    "key",
    [
        0,
        -1,
        13,
        slice(None),
        slice(2, 2),
        slice(1, 15),
        slice(None, None, 7),
        slice(None, None, -1),
        slice(20, 3, -4),
        [0, 22, 5],
        np.array([3, 3, -1]),
        [0, 1, 2, 3, 5],
        (slice(None), 1),
        (slice(0, 14), -1, 2),
        (5, 1),
        (slice(None), slice(0, 1)),
        (slice(None), slice(None, None, -1)),
        (..., 0),
        (slice(3, 6), ..., 2),
        (4, ..., 0),
        (slice(None), [1, 0]),
        ([1, 20], 1, slice(0, 2)),
        (slice(4, 4), 1),
        [],
        (slice(None), np.array([True, False])),
    ],
)
def test_indexing_reads_as_the_array_would(folder: Path, x: np.ndarray, key: object) -> None:
    lazy = Results.open(folder).frames.x_wrapped
    expected = x[np.array(key, dtype=int) if isinstance(key, list) else key]
    found = lazy[key]
    assert found.shape == expected.shape
    assert np.array_equal(found, expected)


def test_a_mask_of_frames_selects(folder: Path, x: np.ndarray) -> None:
    frames = Results.open(folder).frames
    late = frames.t > 1.05
    assert np.array_equal(frames.x_wrapped[late], x[late])
    with pytest.raises(IndexError):
        frames.x_wrapped[late[:-1]]


@pytest.mark.parametrize("key", [N, -N - 1, [0, N], (0, 2), [0.5], "x"])
def test_an_index_out_of_range_is_an_index_error(folder: Path, key: object) -> None:
    with pytest.raises(IndexError):
        Results.open(folder).frames.x[key]


def test_all_returned_arrays_are_read_only(folder: Path) -> None:
    results = Results.open(folder)
    arrays = [
        results.frames.t,
        results.frames.x[:],
        results.frames.x[3],
        results.frames[3].x,
        results.contacts,
        results.grains.d,
        results.bed.x,
        results.planes.normal,
        results.tally["kinetic"],
    ]
    for array in arrays:
        with pytest.raises(ValueError, match="read-only"):
            array[...] = array


def test_contacts_come_sorted_by_parting(folder: Path) -> None:
    contacts = Results.open(folder).contacts
    assert contacts.dtype == EVENT
    assert contacts["t_part"].tolist() == [-2.0, 9.0, 10.0]
    assert contacts["i"].tolist() == [12, 1, 0]


def test_the_account_has_a_row_per_frame_and_every_book(folder: Path) -> None:
    tally = Results.open(folder).tally
    assert set(tally) == set(TALLY.names)
    assert {term.name.lower() for term in Term} <= set(tally)
    assert tally["kinetic"].tolist() == list(range(N))
    assert tally["overlap_step"].tolist() == [7] * N


def test_a_folder_with_other_terms_is_refused_as_of_another_version(folder: Path) -> None:
    before = np.dtype([(name, TALLY[name]) for name in TALLY.names or () if name != "film"])
    for path in (folder / "parts").glob("part-*.h5"):
        with h5py.File(path, "r+") as file:
            rows = file["tally"][:]
            del file["tally"]
            file["tally"] = rows[list(before.names or ())].astype(before)
    with pytest.raises(ResultsError, match="'/tally' has other columns: another version of ryusa wrote it"):
        Results.open(folder)


def test_a_part_that_does_not_say_where_it_ends_is_refused(folder: Path) -> None:
    with h5py.File(folder / "parts" / "part-000000.h5", "r+") as file:
        del file.attrs["end_step"]
    with pytest.raises(ResultsError, match="has no 'end_step'"):
        Results.open(folder)


def test_grains_bed_and_scene_come_back(folder: Path) -> None:
    results = Results.open(folder)
    assert results.grains.d.tolist() == [0.002, 0.003]
    assert results.grains.m == pytest.approx(2650 * np.pi / 6 * results.grains.d**3)
    assert results.bed.d.tolist() == [0.0025]
    assert results.planes.normal.tolist() == [[0.0, 0.0, 1.0]]
    assert results.scene.period == (0.04, float("inf"))
    assert results.scene.contact.k_n == 1e4
    assert results.case["title"] == "two grains"
    assert results.complete
    assert "23 frames, 2 free and 1 fixed grains" in repr(results)


def test_a_run_can_be_walked_frame_by_frame(folder: Path, x: np.ndarray) -> None:
    assert [frame.step for frame in Results.open(folder).frames] == list(range(0, 230, 10))


def test_a_folder_that_is_no_run_says_so(tmp_path: Path) -> None:
    with pytest.raises(ResultsError, match="no such run folder"):
        Results.open(tmp_path / "nowhere")
    with pytest.raises(ResultsError, match="not a run folder"):
        Results.open(tmp_path)


def test_a_run_without_its_index_is_still_readable(folder: Path) -> None:
    (folder / "grains.vtkhdf").unlink()
    (folder / "bed.vtkhdf").unlink()
    (folder / "summary.json").unlink()
    assert len(Results.open(folder).frames) == N
    assert Results.open(folder).summary == {}


def test_frames_read_one_by_one_in_any_order_are_those_read_at_once(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = [np.asarray(getattr(Results.open(folder).frames, name)) for name in ("x", "v", "image")]
    order = [*range(len(whole[0])), *reversed(range(len(whole[0])))]
    for ahead in (0, 200, lazy.AHEAD):
        monkeypatch.setattr(lazy, "AHEAD", ahead)
        frames = Results.open(folder).frames
        for k in order:
            for name, every in zip(("x", "v", "image"), whole, strict=True):
                one = getattr(frames, name)[k]
                assert np.array_equal(one, every[k]) and not one.flags.writeable


@pytest.mark.parametrize(
    ("told", "who"),
    [('"ryusa 9.x"', "ryusa 9.x"), ('"rm -rf now"', "another version"), ("[1]", "another version"),
     ("null", "another version")],
)  # fmt: skip
def test_a_folder_of_another_format_says_who_reads_it(folder: Path, told: str, who: str) -> None:
    (folder / "provenance.json").write_text(f'{{"format": 99, "read_by": {told}}}')
    with pytest.raises(ResultsError, match=f"format 99, which {who} reads; this is ryusa .*, which reads 2"):
        Results.open(folder)
