"""HDF5 files of strangers: nothing but the file itself is read, and no more than it holds."""

from __future__ import annotations

import importlib
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.keypoint_files import KeypointOptions, read_keypoints
from app.keypoint_files.self_contained import require_self_contained
from app.recognition.errors import KeypointFileError, OsgError
from tests.keypoint_files.files import sleap_labels
from tests.recognition.damaged_clips import write_clip
from tests.recognition.strategies import BODY, circle, recording

h5py: Any = importlib.import_module("h5py")

SECRET = b"secret of another file, " * 8
FRAMES = 8
POSES = recording(circle, frames=FRAMES, landmarks=tuple(BODY))
OPTIONS = KeypointOptions(frame_rate=25, frame_size=(640, 480))


@pytest.fixture
def secret(tmp_path: Path) -> Path:
    """Return a file of somebody else, whose bytes must not come back."""
    path = tmp_path / "secret.txt"
    path.write_bytes(SECRET)
    return path


@pytest.fixture
def analysis(tmp_path: Path) -> Path:
    """Return SLEAP's analysis file, without its largest table."""
    library: Any = importlib.import_module("sleap_io")
    path = tmp_path / "walk.h5"
    library.save_analysis_h5(sleap_labels(library, [POSES], tracked=True), str(path))
    return path


def external_storage(file: Any, secret: Path) -> None:
    shape = file["tracks"].shape
    del file["tracks"]
    place = [(str(secret), 0, int(np.prod(shape)))]
    file.create_dataset("tracks", shape=shape, dtype="u1", external=place)


def other_file(secret: Path) -> Path:
    path = secret.with_name("other.h5")
    with h5py.File(path, "w") as other:
        other["tracks"] = np.full((1, 2, len(POSES.landmarks), FRAMES), 77.0)
    return path


def external_link(file: Any, secret: Path) -> None:
    del file["tracks"]
    file["tracks"] = h5py.ExternalLink(str(other_file(secret)), "/tracks")


def nested_external_link(file: Any, secret: Path) -> None:
    file.create_group("a/b/c")["d"] = h5py.ExternalLink(str(other_file(secret)), "/tracks")


def soft_link(file: Any, secret: Path) -> None:
    file["again"] = h5py.SoftLink("/tracks")


def virtual_dataset(file: Any, secret: Path) -> None:
    shape = file["tracks"].shape
    layout = h5py.VirtualLayout(shape=shape, dtype="f8")
    layout[...] = h5py.VirtualSource(str(other_file(secret)), "tracks", shape=shape)
    del file["tracks"]
    file.create_virtual_dataset("tracks", layout)


def unknown_filter(file: Any, secret: Path) -> None:
    plan = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    plan.set_chunk((1,))
    plan.set_filter(32008, h5py.h5z.FLAG_OPTIONAL, (0, 2))  # bitshuffle
    space = h5py.h5s.create_simple((1,))
    h5py.h5d.create(file.id, b"packed", h5py.h5t.IEEE_F64LE, space, plan)


def object_reference(file: Any, secret: Path) -> None:
    file["refers"] = np.array([file["tracks"].ref], dtype=h5py.ref_dtype)


def reference_in_an_attribute(file: Any, secret: Path) -> None:
    file["tracks"].attrs["refers"] = file["tracks"].ref


def nothing_stored(file: Any, secret: Path) -> None:
    del file["tracks"]
    file.create_dataset("tracks", shape=(1, 2, 2, 10**8), dtype="f8", chunks=(1, 2, 2, 100))


def nothing_stored_in_one_piece(file: Any, secret: Path) -> None:
    file.create_dataset("much", shape=(10**7,), dtype="f8")


def much_in_few_bytes(file: Any, secret: Path) -> None:
    zeros = np.zeros(MANY, dtype="u1")
    for number in range(6):
        file.create_dataset(f"zeros {number}", data=zeros, compression="gzip", chunks=(MANY,))


def much_in_a_small_chunk(file: Any, secret: Path) -> None:
    small = file.create_dataset("small", shape=(100,), dtype="f8", chunks=(100,), compression=4)
    small.id.write_direct_chunk((0,), zlib.compress(bytes(10_000_000)))


def much_in_a_small_chunk_that_is_shuffled(file: Any, secret: Path) -> None:
    plan = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    plan.set_chunk((100,))
    plan.set_deflate(4)
    plan.set_shuffle()
    space = h5py.h5s.create_simple((100,))
    small = h5py.h5d.create(file.id, b"shuffled", h5py.h5t.IEEE_F64LE, space, plan)
    packed = zlib.compress(bytes(10_000_000))
    packed += bytes(-len(packed) % 8)
    small.write_direct_chunk((0,), np.frombuffer(packed, dtype="u1").reshape(-1, 8).T.tobytes())


MANY = 100_000_000


def one_text_many_times(file: Any, secret: Path) -> None:
    kind = h5py.string_dtype()
    texts = file.create_dataset("texts", shape=(60_000,), dtype=kind)
    texts[0] = "x" * 20_000
    raw = texts.id.get_offset()
    file.flush()
    path = Path(file.filename)
    file.close()
    content = bytearray(path.read_bytes())
    first = bytes(content[raw : raw + 16])
    content[raw : raw + 16 * 60_000] = first * 60_000
    path.write_bytes(content)


def a_list_of_texts_as_attribute(file: Any, secret: Path) -> None:
    file.attrs["many"] = ["text"] * 100


def many_objects(file: Any, secret: Path) -> None:
    group = file.create_group("many")
    for number in range(10_001):
        group.create_group(str(number))


ATTACKS: list[Callable[[Any, Path], None]] = [
    external_storage,
    external_link,
    nested_external_link,
    soft_link,
    virtual_dataset,
    unknown_filter,
    object_reference,
    reference_in_an_attribute,
    nothing_stored,
    nothing_stored_in_one_piece,
    much_in_few_bytes,
    much_in_a_small_chunk,
    much_in_a_small_chunk_that_is_shuffled,
    one_text_many_times,
    a_list_of_texts_as_attribute,
    many_objects,
]


@pytest.mark.withstands(row="H28")
@pytest.mark.parametrize("attack", ATTACKS)
def test_a_file_that_refers_to_others_or_announces_more_than_it_holds_is_refused(
    analysis: Path, secret: Path, attack: Callable[[Any, Path], None]
) -> None:
    with h5py.File(analysis, "a") as file:
        attack(file, secret)
    with pytest.raises(KeypointFileError, match=r"is refused: .*; export it again") as refused:
        read_keypoints(analysis, OPTIONS)
    assert "\n" not in str(refused.value)


def test_the_same_file_without_an_attack_is_read(analysis: Path) -> None:
    assert len(read_keypoints(analysis, OPTIONS).recording.poses) == FRAMES


def test_circles_of_hard_links_end(analysis: Path) -> None:
    with h5py.File(analysis, "a") as file:
        file["circle/deeper/top"] = file["/"]
    require_self_contained(analysis)


@pytest.mark.parametrize("filters", [{"compression": 9}, {"compression": 9, "shuffle": True}])
@pytest.mark.parametrize("checksum", [False, True])
def test_packed_values_of_any_kind_are_read(
    analysis: Path, filters: dict[str, Any], checksum: bool
) -> None:
    with h5py.File(analysis, "a") as file:
        values = np.random.default_rng(1).random(1000)
        file.create_dataset("more", data=values, chunks=(300,), fletcher32=checksum, **filters)
        texts = np.array(["nose", "left wrist"], dtype=h5py.string_dtype())
        file.create_dataset("texts", data=texts, chunks=(2,), **filters)
        file.create_dataset("none", shape=(0,), dtype="f8", chunks=(300,), maxshape=(None,))
    require_self_contained(analysis)


def test_embedded_pictures_and_a_project_are_self_contained(tmp_path: Path) -> None:
    library: Any = importlib.import_module("sleap_io")
    video = library.Video.from_filename(str(write_clip(tmp_path / "dive.mp4", frames=FRAMES)))
    labels = sleap_labels(library, [POSES], tracked=True)
    labels.videos[0].replace_filename(str(video.filename))
    for frame in labels.labeled_frames:
        frame.frame_idx -= 100
    project = tmp_path / "dive.pkg.slp"
    labels.save(str(project), embed=True)
    assert len(read_keypoints(project, OPTIONS).recording.poses) == FRAMES


def test_a_project_of_too_many_frames_is_refused_before_they_are_read(analysis: Path) -> None:
    with h5py.File(analysis, "a") as file:
        del file["tracks"]
        shape = (1, 2, 1, 60_000)
        file.create_dataset("tracks", data=np.ones(shape), compression="gzip")
    with pytest.raises(OsgError, match="60000 frames"):
        read_keypoints(analysis, OPTIONS)


def test_the_video_that_a_file_names_is_not_opened(analysis: Path, tmp_path: Path) -> None:
    # Another diver's clip, whose size would come back as the frame size.
    other = write_clip(tmp_path / "other.mp4")
    with h5py.File(analysis, "a") as file:
        del file["video_path"]
        file["video_path"] = str(other)
    read = read_keypoints(analysis, KeypointOptions(frame_rate=25))
    assert read.recording.poses.frame_size != (64, 48)


@pytest.mark.parametrize("stated", ['{"shape": ["a", "b", "c", 1]}', '{"shape": 3}', "[[1]]"])
def test_a_senseless_frame_size_is_refused(analysis: Path, stated: str) -> None:
    with h5py.File(analysis, "a") as file:
        file.attrs["video_backend_metadata"] = stated
    with pytest.raises(KeypointFileError, match="cannot be read as SLEAP's"):
        read_keypoints(analysis, KeypointOptions(frame_rate=25))
