"""Small files that unpack to much: readers stay within a stated memory, also while they look."""

from __future__ import annotations

import importlib
import sqlite3
import subprocess
import sys
import zipfile
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

from tests.bags.bag_files import zip_of, zipped
from tests.bags.test_bag import packed_bag
from tests.keypoint_files.files import sleap_labels
from tests.recognition.strategies import BODY, circle, recording

ZEROS = 300_000_000
"""Bytes that each file unpacks to."""

MOST = 30_000_000
"""Most bytes that a reader may take for it."""

READ = """
import sys
from collections import deque
from pathlib import Path
from app.bags.bag import open_bag
from app.clip_sources import ReadOptions, source_of
from app.recognition import OsgError, Recording

file = Path(sys.argv[1])
source = source_of(file)
options = ReadOptions(frame_rate=25, frame_size=(640, 480))

def look():
    source.probe(file, options)

def read():
    if source.name != "bag":
        return source.record(file, options)
    with open_bag(file) as bag:
        for topic in bag.topics:
            deque(bag.messages(topic.name), maxlen=0)

def held():
    # Not of getrusage, which counts what the parent had before this program began.
    (most,) = (line for line in open("/proc/self/status") if line.startswith("VmHWM:"))
    return int(most.split()[1]) * 1024

import app.bags.topic_summary, app.keypoint_files, rosbags.rosbag2, rosbags.typesys, sleap_io, h5py
before = held()
for step in (look, read):
    said = ""
    try:
        step()
    except OsgError as error:
        said = str(error)
    print(held() - before, said)
"""


def taken(file: Path) -> list[tuple[int, str]]:
    """Return the bytes that a process takes to look at a file, then to read it; what it says."""
    command = [sys.executable, "-c", READ, str(file)]
    ran = subprocess.run(command, capture_output=True, text=True, check=True)
    lines = [line.partition(" ") for line in ran.stdout.splitlines()]
    return [(int(size), said) for size, _, said in lines]


def zstd_chunk(folder: Path) -> Path:
    return packed_bag(folder / "dive.mcap", chunks=1, size=ZEROS, compression="zstd")


def lz4_chunk(folder: Path) -> Path:
    return packed_bag(folder / "dive.mcap", chunks=1, size=ZEROS, compression="lz4")


def packed_message(folder: Path) -> Path:
    place = folder / "dive"
    writer = Writer(place, version=9, storage_plugin=StoragePlugin.SQLITE3)
    writer.set_compression(CompressionMode.MESSAGE, CompressionFormat.ZSTD)
    write_zeros(writer)
    return zipped(place)


def packed_row(folder: Path) -> Path:
    write_zeros(Writer(folder / "dive", version=9, storage_plugin=StoragePlugin.SQLITE3))
    return zipped(folder / "dive")


def write_zeros(writer: Writer) -> None:
    with writer:
        kind = "sensor_msgs/msg/CompressedImage"
        topic = writer.add_connection("/camera", kind, msgdef="uint8[] data", rihs01="x")
        writer.write(topic, 1, bytes(ZEROS))


def computed_row(folder: Path) -> Path:
    """Write a recording in SQLite whose table computes what it shows."""
    file = folder / "dive.db3"
    with closing(sqlite3.connect(file)) as database:
        database.executescript(
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT,"
            " serialization_format TEXT, offered_qos_profiles TEXT);"
            "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER,"
            f" data BLOB GENERATED ALWAYS AS (zeroblob({ZEROS})));"
            "INSERT INTO topics VALUES(1, '/camera', 'sensor_msgs/msg/CompressedImage', 'cdr', '');"
            "INSERT INTO messages(topic_id, timestamp) VALUES(1, 1);"
        )
    return file


def large_entry(folder: Path) -> Path:
    return zip_of(folder / "dive.zip", {"dive.mcap": b"\x89MCAP0\r\n" + bytes(ZEROS)})


def large_frames(folder: Path) -> Path:
    """Write a folder of OpenPose with one frame of white space."""
    file = folder / "frames.zip"
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a_000000000000_keypoints.json", b" " * ZEROS)
    return file


def analysis(folder: Path) -> Path:
    library: Any = importlib.import_module("sleap_io")
    h5py: Any = importlib.import_module("h5py")
    file = folder / "walk.h5"
    poses = recording(circle, frames=8, landmarks=tuple(BODY))
    library.save_analysis_h5(sleap_labels(library, [poses], tracked=True), str(file))
    with h5py.File(file, "a") as opened:
        shape = (
            *opened["tracks"].shape[:-1],
            ZEROS // 8 // int(np.prod(opened["tracks"].shape[:-1])),
        )
        del opened["tracks"]
        chunks = (*shape[:-1], 10_000)
        opened.create_dataset("tracks", shape, "f8", chunks=chunks, compression="gzip")
        for start in range(0, shape[-1], 10_000):
            opened["tracks"][..., start : start + 10_000] = 0.0
    return file


@pytest.mark.slow
@pytest.mark.withstands(row="H28")
@pytest.mark.parametrize(
    "write",
    [
        zstd_chunk,
        lz4_chunk,
        packed_message,
        packed_row,
        computed_row,
        large_entry,
        large_frames,
        analysis,
    ],
)
def test_a_reader_takes_little_memory_for_a_small_file(
    tmp_path: Path, write: Callable[[Path], Path]
) -> None:
    file = write(tmp_path)
    assert file.stat().st_size < ZEROS / 100
    looked, read = taken(file)
    assert looked[0] < MOST, looked[1]
    assert read[0] < MOST, read[1]
    assert read[1]  # It is refused.
