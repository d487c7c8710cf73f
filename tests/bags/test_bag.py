"""What is in a recording, and how one that cannot be used is refused."""

from __future__ import annotations

import re
import sqlite3
import struct
import sys
import tracemalloc
from collections import deque
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import get_types_from_msg

from app.bags.bag import DEFINITIONS, USES, open_bag
from app.bags.extraction import record_bag
from app.bags.image_topic import BagFrames
from app.bags.keypoint_topic import _READERS
from app.bags.mcap_chunks import require_stated_sizes
from app.bags.topic_summary import usable_topics
from app.recognition.errors import BagError, TopicError, VideoError
from tests.api.recordings import recording_of
from tests.bags.bag_files import (
    START,
    Storage,
    compressed,
    file_of,
    message,
    published_rows,
    raw,
    stamps,
    store,
    write_bag,
    zip_of,
    zipped,
)
from tests.conftest import ROOT
from tests.recognition.damaged_clips import picture

STORAGES: tuple[Storage, ...] = ("mcap", "sqlite3")


def text(words: str) -> object:
    return message("std_msgs/msg/String", words)


@pytest.fixture
def camera(tmp_path: Path) -> Path:
    """Return a bag with ten raw pictures, one second of them, and a topic of text."""
    rows = [
        ("/camera", raw(picture(index), "rgb8", stamp), stamp)
        for index, stamp in enumerate(stamps(np.linspace(0, 1, 10).tolist()))
    ]
    return write_bag(tmp_path / "dive", [*rows, ("/log", text("start"), START)])


@pytest.mark.parametrize("storage", STORAGES)
@pytest.mark.parametrize("form", ["folder", "file", "zip", "zip of the file"])
def test_topics_are_listed_with_type_count_and_duration(
    tmp_path: Path, storage: Storage, form: str
) -> None:
    folder = write_bag(tmp_path / "dive", published_rows(recording_of("line")), storage)
    path = {
        "folder": lambda: folder,
        "file": lambda: file_of(folder),
        "zip": lambda: zipped(folder),
        "zip of the file": lambda: zip_of(
            tmp_path / "one.zip", {file_of(folder).name: file_of(folder).read_bytes()}
        ),
    }[form]()
    # The content decides the type of a file.
    path = path.rename(tmp_path / "received")
    recording = recording_of("line")
    with open_bag(path) as bag:
        listed = {topic.name: topic for topic in bag.topics}
        assert set(listed) == {"/pose_keypoints", "/vulcan_salute_detected", "/camera_info"}
        keypoints = bag.topic()
        assert keypoints == listed["/pose_keypoints"]
        assert keypoints.type == "keypoints_interfaces/msg/PoseKeypointsArray"
        assert keypoints.use == "keypoints"
        assert keypoints.messages == len(recording.poses)
        assert bag.durations() == {"/pose_keypoints": pytest.approx(recording.poses.duration)}
        assert not listed["/vulcan_salute_detected"].usable


@pytest.mark.parametrize("mode", ["FILE", "MESSAGE", "STORAGE"])
@pytest.mark.parametrize("packed", [False, True])
def test_recordings_compressed_by_the_recorder_are_read(
    tmp_path: Path, mode: str, packed: bool
) -> None:
    recording = recording_of("line")
    plugin = StoragePlugin.MCAP if mode == "STORAGE" else StoragePlugin.SQLITE3
    writer = Writer(tmp_path / "dive", version=9, storage_plugin=plugin)
    writer.set_compression(CompressionMode[mode], CompressionFormat.ZSTD)
    with writer:
        connections: dict[str, Any] = {}
        for topic, content, received in published_rows(recording):
            kind = content.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=store)
            writer.write(connections[topic], received, store.serialize_cdr(content, kind))
    path = zipped(tmp_path / "dive") if packed else tmp_path / "dive"
    assert len(record_bag(path).poses) == len(recording.poses)


def test_old_recordings_without_definitions_are_read_by_the_known_ones(tmp_path: Path) -> None:
    rows = list(published_rows(recording_of("line")))
    with Writer(tmp_path / "old", version=8, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connections = {
            topic: writer.add_connection(topic, content.__msgtype__, typestore=store)
            for topic, content, _ in rows[:2]
        }
        for topic, content, received in rows:
            if topic in connections:
                data = store.serialize_cdr(content, content.__msgtype__)
                writer.write(connections[topic], received, data)
    with sqlite3.connect(file_of(tmp_path / "old")) as database:
        database.execute("DROP TABLE message_definitions")
        database.execute("UPDATE schema SET schema_version = 3")
    database.close()
    assert len(record_bag(tmp_path / "old").poses) == len(recording_of("line").poses)


def write_parts(folder: Path, storage: Storage, starts: tuple[float, ...]) -> Path:
    """Write a recording that was split and lost its metadata: parts of one second, 4 pictures."""
    folder.mkdir()
    for number, start in enumerate(starts):
        rows = [
            ("/camera", raw(picture(4 * number + index), "rgb8", stamp), stamp)
            for index, stamp in enumerate(stamps([start + step / 4 for step in range(4)]))
        ]
        part = file_of(write_bag(folder.parent / f"{folder.name}-{number}", rows, storage))
        # The tenth part follows the ninth, unlike in the order of letters.
        part.rename(folder / f"dive_{9 + number}{part.suffix}")
    return folder


@pytest.mark.parametrize("storage", STORAGES)
@pytest.mark.parametrize("packed", [False, True])
def test_parts_without_metadata_are_one_recording(
    tmp_path: Path, storage: Storage, packed: bool
) -> None:
    folder = write_parts(tmp_path / "dive", storage, (0.0, 1.0, 2.0))
    with open_bag(zipped(folder) if packed else folder) as bag:
        (topic,) = bag.topics
        assert (topic.name, topic.messages) == ("/camera", 12)
        assert bag.durations() == {"/camera": 2.75}
        frames = list(BagFrames(bag, topic))
    assert [frame.time for frame in frames] == [index / 4 for index in range(12)]
    assert all(np.array_equal(frame.image, picture(frame.index)) for frame in frames)


def test_files_that_overlap_in_time_are_no_parts_of_one_recording(tmp_path: Path) -> None:
    folder = write_parts(tmp_path / "dive", "mcap", (0.0, 0.5))
    with pytest.raises(BagError, match="overlap in time"), open_bag(zipped(folder)):
        pass


def test_one_of_several_topics_must_be_named(camera: Path, tmp_path: Path) -> None:
    rows = [(name, raw(picture(0), "rgb8", START), START) for name in ("/left", "/right")]
    bag_path = write_bag(tmp_path / "stereo", rows)
    with open_bag(bag_path) as bag:
        with pytest.raises(TopicError, match=r"2 topics to choose from: /left \(sensor_msgs/Image"):
            bag.topic()
        assert bag.topic("/right").name == "/right"
        with pytest.raises(TopicError, match=r"no topic '/middle'; usable are /left .*, /right"):
            bag.topic("/middle")
    with open_bag(camera) as bag, pytest.raises(TopicError, match=r"/log is of type std_msgs"):
        bag.topic("/log")


@pytest.mark.parametrize(
    ("name", "encoding"),
    [("/cam/a_depth", "mono8"), ("/cam/aligned", "16UC1"), ("/cam/aligned", "32FC1")],
)
def test_depth_is_never_offered_first(tmp_path: Path, name: str, encoding: str) -> None:
    bits = {"mono8": np.uint8, "16UC1": np.uint16, "32FC1": np.float32}
    deep = np.zeros((48, 64), bits[encoding])
    rows = [
        (name, raw(deep, encoding, START), START),
        ("/cam/image", raw(picture(0), "rgb8", START), START),
    ]
    if encoding == "32FC1":
        rows.append(("/cam/other", raw(picture(0), "rgb8", START), START))
    folder = write_bag(tmp_path / "dive", rows)
    with open_bag(folder) as bag, pytest.raises(TopicError, match=r"--topic /cam/image\)"):
        bag.topic()
    assert usable_topics(folder)[0].name == "/cam/image"


def test_a_recording_with_nothing_to_use_says_what_it_holds(tmp_path: Path) -> None:
    only_text = write_bag(tmp_path / "text", [("/log", text("hello"), START)])
    with (
        open_bag(only_text) as bag,
        pytest.raises(BagError, match=r"only /log \(std_msgs/String, 1 messages\); record a topic"),
    ):
        bag.topic()


def test_a_topic_without_messages_is_refused(tmp_path: Path) -> None:
    with Writer(tmp_path / "dive", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        writer.add_connection("/camera", "sensor_msgs/msg/Image", typestore=store)
    with (
        open_bag(tmp_path / "dive") as bag,
        pytest.raises(BagError, match=r"have no messages.*was the camera running"),
    ):
        bag.topic()


@pytest.mark.parametrize("storage", STORAGES)
@pytest.mark.parametrize("share", [0.05, 0.5, 0.98])
def test_a_recording_cut_short_is_told_in_one_line(
    camera: Path, tmp_path: Path, storage: Storage, share: float
) -> None:
    rows = [("/camera", raw(picture(0), "rgb8", START + i), START + i) for i in range(30)]
    file = file_of(write_bag(tmp_path / "whole", rows, storage))
    content = file.read_bytes()
    file.write_bytes(content[: int(len(content) * share)])
    with pytest.raises(BagError, match="damaged or cut short") as raised:
        record_bag(file)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("profile", ["", "ros1"])
def test_an_mcap_file_of_another_program_is_named_for_what_it_is(
    tmp_path: Path, profile: str
) -> None:
    path = tmp_path / "dive.mcap"
    with path.open("wb") as file:
        writer = McapWriter(file)
        writer.start(profile=profile)
        schema = writer.register_schema("foxglove.CompressedVideo", "protobuf", b"")
        channel = writer.register_channel("/video", "protobuf", schema)
        writer.add_message(channel, 0, b"", 0)
        writer.finish()  # type: ignore[no-untyped-call]
    with pytest.raises(BagError, match="of another program, not a ROS 2 recording") as raised:
        record_bag(path)
    assert "damaged" not in str(raised.value)


@pytest.mark.parametrize("seed", range(12))
def test_flipped_bytes_give_frames_or_one_line_and_nothing_else(tmp_path: Path, seed: int) -> None:
    storage = STORAGES[seed % 2]
    rows = [
        ("/camera", compressed(picture(i), ".jpg", START + i * 10**8), START + i * 10**8)
        for i in range(8)
    ]
    file = file_of(write_bag(tmp_path / "dive", rows, storage))
    random = np.random.default_rng(seed)
    content = bytearray(file.read_bytes())
    for place in random.integers(0, len(content), 30):
        content[place] = random.integers(0, 256)
    file.write_bytes(content)
    said, frames = "", 1
    try:
        with open_bag(file) as bag:
            frames = len(list(BagFrames(bag, bag.topic())))
    except (BagError, VideoError) as error:
        said = str(error)
    assert 0 < frames <= 8
    assert "\n" not in said


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "no dive recording"),
        (b"not a bag at all", "no dive recording"),
        (b"#ROSBAG V2.0\n", "ROS 1; convert it with `rosbags-convert"),
        (b"PK\x03\x04" + bytes(60), "damaged, encrypted or unusual zip"),
        (b"SQLite format 3\0" + bytes(60), "damaged or cut short"),
    ],
)
def test_what_is_no_recording_is_refused(tmp_path: Path, content: bytes, words: str) -> None:
    path = tmp_path / "file.mcap"
    path.write_bytes(content)
    with pytest.raises(BagError, match=words):
        record_bag(path)
    with pytest.raises(BagError, match="does not exist"):
        record_bag(tmp_path / "nowhere")


def test_without_what_reads_recordings_the_command_to_install_it_is_told(
    camera: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "rosbags.rosbag2", None)
    with pytest.raises(BagError, match=r'pip install "osg-studio\[studio\]"'):
        record_bag(camera)


def test_a_database_that_is_no_recording_is_refused(tmp_path: Path) -> None:
    database = sqlite3.connect(tmp_path / "contacts.db3")
    database.execute("CREATE TABLE person (name TEXT)")
    database.commit()
    database.close()
    with pytest.raises(BagError, match="missing tables"):
        record_bag(tmp_path / "contacts.db3")


PACKAGES = ROOT / "ros2"
OURS = [name for name in DEFINITIONS if (PACKAGES / name.split("/")[0]).is_dir()]


@pytest.mark.parametrize("name", OURS)
def test_a_definition_is_that_of_the_package_beside(name: str) -> None:
    package, _, message = name.split("/")
    text = Path(PACKAGES, package, "msg", f"{message}.msg").read_text()
    (_, theirs) = get_types_from_msg(text, name)[name]
    (_, known) = get_types_from_msg(DEFINITIONS[name], name)[name]
    assert known == theirs


def test_the_packages_beside_are_found() -> None:
    assert {name.split("/")[0] for name in OURS} == {"keypoints_interfaces", "osg_interfaces"}


def test_every_type_of_keypoints_can_be_read() -> None:
    assert {kind for kind, use in USES.items() if use == "keypoints"} == set(_READERS)


def packed_bag(path: Path, *, chunks: int, size: int, compression: str = "zstd") -> Path:
    """Write an MCAP file of ROS 2 whose chunks hold zeros and all begin at the same time."""
    with path.open("wb") as file:
        writer = McapWriter(file, chunk_size=1, compression=CompressionType[compression.upper()])
        writer.start(profile="ros2", library="test")
        schema = writer.register_schema(
            "sensor_msgs/msg/CompressedImage", "ros2msg", b"uint8[] data"
        )
        channel = writer.register_channel("/camera", "cdr", schema)
        for _ in range(chunks):
            writer.add_message(channel, 1, bytes(size), 1)
        writer.finish()  # type: ignore[no-untyped-call]
    return path


@pytest.mark.withstands(row="H28")
@pytest.mark.parametrize("compression", ["zstd", "lz4"])
@pytest.mark.parametrize(("chunks", "size"), [(1, 300_000_000), (6, 60_000_000)])
def test_a_recording_that_would_take_all_memory_is_refused_before_it_is_unpacked(
    tmp_path: Path, compression: str, chunks: int, size: int
) -> None:
    file = packed_bag(tmp_path / "dive.mcap", chunks=chunks, size=size, compression=compression)
    tracemalloc.start()
    try:
        with pytest.raises(BagError, match="must be unpacked at once"), open_bag(file) as bag:
            bag.durations()
        assert tracemalloc.get_traced_memory()[1] < 20_000_000
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("compression", ["zstd", "lz4"])
def test_a_chunk_is_unpacked_only_as_far_as_its_header_says(
    tmp_path: Path, compression: str
) -> None:
    file = packed_bag(tmp_path / "dive.mcap", chunks=1, size=200_000_000, compression=compression)
    content = file.read_bytes()
    stated = re.search(rb"\x06.{8}.{16}(.{8})", content, re.DOTALL)
    assert stated is not None
    file.write_bytes(content.replace(stated[1], struct.pack("<Q", 1000)))
    tracemalloc.start()
    try:
        with pytest.raises(BagError, match="damaged"), open_bag(file) as bag:
            deque(bag.messages("/camera"), maxlen=0)
        assert tracemalloc.get_traced_memory()[1] < 20_000_000
    finally:
        tracemalloc.stop()


def test_a_session_is_not_unpacked_further_than_its_index_says(tmp_path: Path) -> None:
    for compression in ("zstd", "lz4"):
        path = packed_bag(tmp_path / compression, chunks=1, size=1000, compression=compression)
        with path.open("rb") as file:
            summary = make_reader(file).get_summary()
            assert summary is not None
            if compression == "zstd":
                require_stated_sizes(file, summary.chunk_indexes)
                summary.chunk_indexes[0].uncompressed_size -= 1
            with pytest.raises(BagError, match="not as its index says"):
                require_stated_sizes(file, summary.chunk_indexes)
