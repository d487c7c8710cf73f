"""Chapters of one recording are known by names and times, and are joined without being coded."""

from __future__ import annotations

from pathlib import Path

import av
import numpy as np
import pytest

from app.recognition.errors import VideoError
from app.recognition.recording.chapters import (
    _form,
    chapters_in,
    join_chapters,
    tell_chapters,
    tell_pieces,
)
from app.recognition.recording.video import probe, read_frames
from tests.recognition.damaged_clips import RATE, cut_off, sound_only, write_clip

STEP = 1 / RATE


@pytest.mark.parametrize(
    ("name", "where"),
    [
        ("GX010042.MP4", "may go on in GX020042.MP4"),
        ("gh120042.mp4", "is a chapter of a recording that begins in gh110042.mp4"),
        ("GOPR0042.MP4", "may go on in GP010042.MP4"),
        ("GP010042.MP4", "is a chapter of a recording that begins in GOPR0042.MP4"),
        ("GP020042.MP4", "is a chapter of a recording that begins in GP010042.MP4"),
        ("DJI_0001.MP4", "may go on in DJI_0002.MP4"),
        ("DJI_20240101120000_0009_D.MP4", "may go on in DJI_…_0010_D.MP4"),
        ("dive-0042.ts", "may go on in dive-0043.ts"),
        ("cam_20240101_120000.ts", None),
        ("DSC_0042.MP4", None),
        ("circle-0042.mp4", None),
        ("dive GX010042.MP4", None),
        ("GX010042-GX020042.MP4", None),
    ],
)
def test_the_other_chapter_has_the_same_number(name: str, where: str | None) -> None:
    told = [f"{name} {where};"] if where else []
    assert [each[: each.index(";") + 1] for each in tell_chapters(name)] == told


def test_chapters_of_a_gopro_are_one_clip_in_a_folder_of_their_own(tmp_path: Path) -> None:
    paths = [tmp_path / f"GX0{number}0042.MP4" for number in (3, 1, 2)]
    for path in (
        *paths,
        tmp_path / "GL010042.LRV",
        tmp_path / "GX010042.THM",
        tmp_path / ".hidden",
    ):
        path.touch()
    assert chapters_in(tmp_path) == sorted(paths)
    (tmp_path / "GX010043.MP4").touch()
    assert chapters_in(tmp_path) == []


@pytest.mark.parametrize(
    ("names", "starts", "joins"),
    [
        (("cam_20240101_120000.ts", "cam_20240101_120100.ts"), (60, 64), True),
        (("cam_20240101_120000.ts", "cam_20240101_120100.ts"), (60, 70), False),
        (("cam-0001.ts", "cam-0002.ts"), (60, 64), True),
        (("cam-0001.ts", "cam-0002.ts"), (0, 0), False),
        (("part_000.ts", "part_001.ts"), (60, 64), True),
        (("seg_0.mkv", "seg_1.mkv"), (60, 64), True),
        (("part_0000.mp4", "part_0001.mp4"), (0, 4), True),
        (("take-1.mp4", "take-2.mp4"), (0, 0), False),
        (("DJI_0001.MP4", "DJI_0002.MP4"), (0, 0), False),
    ],
)
def test_other_chapters_are_joined_only_where_one_begins_as_the_other_ends(
    tmp_path: Path, names: tuple[str, str], starts: tuple[float, float], joins: bool
) -> None:
    frames = 4 * RATE
    for name, start in zip(names, starts, strict=True):
        times = [start + index * STEP for index in range(frames)]
        write_clip(tmp_path / name, frames=frames, times=times)
    paths = [tmp_path / name for name in names]
    assert chapters_in(tmp_path) == (paths if joins else [])
    assert len(list(tell_pieces(paths))) == joins


def test_parameter_sets_that_differ_by_zeros_at_their_end_are_the_same(tmp_path: Path) -> None:
    paths = [write_clip(tmp_path / f"{each}.ts") for each in "ab"]
    forms = []
    for path, more in zip(paths, (b"", b"\0"), strict=True):
        with av.open(str(path)) as container:
            stream = container.streams.video[0]
            stream.codec_context.extradata = (stream.codec_context.extradata or b"") + more
            forms.append(_form(stream))
    assert forms[0] == forms[1]


@pytest.mark.parametrize(("second", "joins"), [("12:00:04", True), ("12:00:30", False)])
def test_chapters_of_a_dji_are_joined_by_the_times_in_their_containers(
    tmp_path: Path, second: str, joins: bool
) -> None:
    folder = tmp_path / "dive"
    folder.mkdir()
    for name, time in (("DJI_0001.MP4", "12:00:00"), ("DJI_0002.MP4", second)):
        clip = write_clip(tmp_path / "clip.mp4", frames=4 * RATE)
        with av.open(str(clip)) as source, av.open(str(folder / name), "w", "mp4") as target:
            target.metadata["creation_time"] = f"2024-01-01T{time}.000000Z"
            stream = source.streams.video[0]
            written = target.add_stream_from_template(stream)
            for packet in source.demux(stream):
                if packet.pts is not None:
                    packet.stream = written
                    target.mux(packet)
    assert bool(chapters_in(folder)) == joins


@pytest.mark.parametrize("ending", [".mp4", ".mov", ".ts"])
def test_joined_chapters_have_one_continuous_time(tmp_path: Path, ending: str) -> None:
    paths = [
        write_clip(tmp_path / f"{name}{ending}", frames=frames, rotation=rotation)
        for name, frames, rotation in (("a", 7, 90), ("b", 9, 90), ("c", 5, 90))
    ]
    join_chapters([(path, None) for path in paths], tmp_path / "joined")
    with read_frames(tmp_path / "joined") as reader:
        frames = list(reader)
    assert (len(frames), reader.warnings) == (21, ())
    assert np.allclose(np.diff([frame.time for frame in frames]), STEP, atol=1e-3)
    assert reader.info.rotation == probe(paths[0]).rotation


def test_chapters_are_read_out_of_one_file(tmp_path: Path) -> None:
    parts = [write_clip(tmp_path / f"{each}.mp4", frames=each).read_bytes() for each in (6, 3)]
    whole = tmp_path / "a,,:b.bin"
    whole.write_bytes(b"".join(parts))
    sizes = [len(part) for part in parts]
    join_chapters([(whole, (0, sizes[0])), (whole, (sizes[0], sum(sizes)))], tmp_path / "joined")
    assert probe(tmp_path / "joined").frames == 9


@pytest.mark.parametrize(
    ("second", "reason"),
    [
        (
            lambda path: write_clip(path, size=(96, 48)),
            "^a chapter .96 x 48 h264. is coded otherwise than the first one .64 x 48",
        ),
        (lambda path: write_clip(path, codec="mpeg4"), "64 x 48 mpeg4. is coded otherwise"),
        (lambda path: cut_off(write_clip(path), 0.5), "^b.mp4 is not a readable video"),
        (sound_only, "b.mp4 holds no video"),
    ],
)
def test_what_cannot_be_joined_is_refused(tmp_path: Path, second: object, reason: str) -> None:
    assert callable(second)
    paths = [write_clip(tmp_path / "a.mp4"), second(tmp_path / "b.mp4")]
    with pytest.raises(VideoError, match=reason):
        join_chapters([(path, None) for path in paths], tmp_path / "joined")


def test_a_codec_that_mp4_does_not_hold_is_refused(tmp_path: Path) -> None:
    path = write_clip(tmp_path / "a.webm", codec="libvpx")
    with pytest.raises(VideoError, match="convert them to MP4"):
        join_chapters([(path, None), (path, None)], tmp_path / "joined")
