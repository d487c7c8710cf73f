"""Recordings: saved ones load unchanged, and damage is reported clearly."""

import tracemalloc
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.recognition.errors import PoseError
from app.recognition.poses.frame import Hand
from app.recognition.poses.sequence import PoseSequence
from app.recognition.recording.recording import FILE_VERSION, Recording
from tests.recognition.parametric_hand import hand_xy, salute
from tests.recognition.strategies import known

FRAMES = 7


def recording(*, with_confidence: bool = True) -> Recording:
    random = np.random.default_rng(3)
    xy = random.uniform(0, 640, (FRAMES, 2, 2))
    xy[2] = np.nan
    hand = hand_xy(salute())
    return Recording(
        poses=PoseSequence(
            landmarks=("left_wrist", "right_wrist"),
            xy=xy,
            confidence=random.uniform(0, 1, (FRAMES, 2)) if with_confidence else None,
            time=np.arange(FRAMES) / 25,
            frame_size=(640, 480),
        ),
        hands=(
            (),
            (Hand(hand, "left", 0.9),),
            (Hand(2 * hand, "right", 0.8), Hand(hand, "left", 0.7)),
            *[()] * (FRAMES - 3),
        ),
        salute=random.uniform(0, 1, FRAMES),
        warnings=("no person in 1 of 7 frames",),
        salute_warnings=("no salute in any of 7 frames",),
    )


@pytest.mark.parametrize("with_confidence", [True, False])
def test_a_saved_recording_loads_as_it_was(tmp_path: Path, with_confidence: bool) -> None:
    saved = recording(with_confidence=with_confidence)
    saved.save(tmp_path / "clip.npz")
    loaded = Recording.load(tmp_path / "clip.npz")
    assert loaded.poses == saved.poses
    assert np.array_equal(loaded.salute, saved.salute)
    assert loaded.list_warnings() == saved.list_warnings()
    assert len(loaded.list_warnings()) == 2
    assert [len(hands) for hands in loaded.hands] == [len(hands) for hands in saved.hands]
    for before, after in zip(sum(saved.hands, ()), sum(loaded.hands, ()), strict=True):
        assert np.array_equal(before.xy, after.xy)
        assert (before.side, before.score) == (after.side, after.score)


def test_the_number_of_people_is_kept_and_unknown_in_older_files(tmp_path: Path) -> None:
    counted = replace(recording(), people=np.array([1, 2, 0, 2, 1, 1, 3]))
    counted.save(tmp_path / "clip.npz")
    people = Recording.load(tmp_path / "clip.npz").people
    assert people is not None
    assert people.tolist() == [1, 2, 0, 2, 1, 1, 3]
    recording().save(tmp_path / "older.npz")
    assert Recording.load(tmp_path / "older.npz").people is None


@pytest.mark.parametrize("people", [[1] * (FRAMES - 1), [-1] * FRAMES])
def test_impossible_numbers_of_people_are_refused(people: list[int]) -> None:
    with pytest.raises(PoseError, match="numbers of people"):
        replace(recording(), people=np.array(people))


def test_a_recording_without_frames_or_hands_survives(tmp_path: Path) -> None:
    poses = recording().poses.between(90, 91)
    Recording(poses=poses, hands=(), salute=np.empty(0)).save(tmp_path / "clip.npz")
    assert len(Recording.load(tmp_path / "clip.npz").poses) == 0


def test_saving_leaves_nothing_else_behind(tmp_path: Path) -> None:
    target = tmp_path / "clip.npz"
    for _ in range(2):
        recording().save(target)
    assert list(tmp_path.iterdir()) == [target]


def test_a_failed_save_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "clip.npz"
    recording().save(target)
    before = target.read_bytes()

    def full_disk(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full_disk)
    with pytest.raises(OSError, match="No space left"):
        recording().save(target)
    assert target.read_bytes() == before
    assert list(tmp_path.iterdir()) == [target]


def test_a_missing_or_damaged_file_is_named(tmp_path: Path) -> None:
    target = tmp_path / "clip.npz"
    with pytest.raises(PoseError, match=r"clip\.npz is not a readable recording"):
        Recording.load(target)
    recording().save(target)
    whole = target.read_bytes()
    cut = [whole[: int(len(whole) * share)] for share in (0.3, 0.7, 0.99)]
    for content in (b"", b"PK\x03\x04", b"not a recording" * 50, *cut):
        target.write_bytes(content)
        with pytest.raises(PoseError, match=r"clip\.npz is not a readable recording.*again"):
            Recording.load(target)


def test_pickled_objects_are_never_opened(tmp_path: Path) -> None:
    np.savez(tmp_path / "clip.npz", version=np.array({"a": 1}, dtype=object))
    with pytest.raises(PoseError, match="not a readable recording"):
        Recording.load(tmp_path / "clip.npz")


def test_a_small_file_whose_arrays_are_huge_is_refused_before_they_are_read(
    tmp_path: Path,
) -> None:
    target = tmp_path / "clip.npz"
    recording().save(target)
    header = {"descr": "<f8", "fortran_order": False, "shape": (10**9,)}
    with (
        zipfile.ZipFile(target, "a", zipfile.ZIP_DEFLATED) as archive,
        archive.open("world.npy", "w") as packed,
    ):
        np.lib.format.write_array_header_1_0(packed, header)
        packed.write(bytes(10**6))
    tracemalloc.start()
    try:
        with pytest.raises(PoseError, match="would take more than 512 MB of memory"):
            Recording.load(target)
        assert tracemalloc.get_traced_memory()[1] < 10**7
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    ("names", "reason"),
    [
        (["world", "people"], "has the shape"),
        (["time", "world"], "two arrays of one name"),
    ],
)
def test_the_size_of_arrays_cannot_be_hidden(tmp_path: Path, names: list[str], reason: str) -> None:
    target = tmp_path / "clip.npz"
    recording().save(target)
    shapes = [(-(10**12),), (10**9,)]
    with zipfile.ZipFile(target, "a", zipfile.ZIP_DEFLATED) as archive:
        for name, shape in zip(names, shapes, strict=True):
            header = {"descr": "<f8", "fortran_order": False, "shape": shape}
            with archive.open(f"{name}.npy", "w") as packed:
                np.lib.format.write_array_header_1_0(packed, header)
    with pytest.raises(PoseError, match=reason):
        Recording.load(target)


def test_a_newer_file_is_refused_as_such(tmp_path: Path) -> None:
    target = tmp_path / "clip.npz"
    recording().save(target)
    with np.load(target) as archive:
        arrays = dict(archive)
    arrays["version"] = np.array(FILE_VERSION + 1)
    np.savez(target, **arrays)
    with pytest.raises(PoseError, match=f"file version {FILE_VERSION + 1}"):
        Recording.load(target)


def test_parts_of_different_length_are_refused() -> None:
    good = recording()
    with pytest.raises(PoseError, match="7 poses has 6 frames of hands"):
        Recording(poses=good.poses, hands=good.hands[:-1], salute=good.salute)


def test_scores_are_shares() -> None:
    good = recording()
    with pytest.raises(PoseError, match=r"outside \[0, 1\]"):
        Recording(poses=good.poses, hands=good.hands, salute=good.salute + 2)


def test_places_in_the_world_are_saved_to_a_micrometre(tmp_path: Path) -> None:
    whole = recording()
    world = np.random.default_rng(1).normal(size=(FRAMES, 2, 3))
    world[2] = np.nan
    poses = replace(whole.poses, world=world)
    replace(whole, poses=poses).save(tmp_path / "clip.npz")
    loaded = known(Recording.load(tmp_path / "clip.npz").poses.world)
    np.testing.assert_allclose(loaded, world, atol=1e-6)


def test_an_array_of_an_unknown_name_stays_packed(tmp_path: Path) -> None:
    file = tmp_path / "clip.npz"
    recording().save(file)
    with (
        zipfile.ZipFile(file, "a", zipfile.ZIP_DEFLATED) as archive,
        archive.open("unknown.npy", "w") as packed,
    ):
        np.lib.format.write_array_header_1_0(
            packed, {"descr": "|u1", "fortran_order": False, "shape": (100_000_000,)}
        )
        for _ in range(100):
            packed.write(bytes(1_000_000))
    tracemalloc.start()
    try:
        assert len(Recording.load(file).poses) == FRAMES
        assert tracemalloc.get_traced_memory()[1] < 20_000_000
    finally:
        tracemalloc.stop()
