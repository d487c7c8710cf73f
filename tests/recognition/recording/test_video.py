"""Reading clips: unusual ones with the right time and orientation, bad ones refused clearly."""

import gc
import io
import re
import weakref
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.errors import VideoError
from app.recognition.poses.frame import Image
from app.recognition.recording.timestamps import SEAM
from app.recognition.recording.video import (
    FrameReader,
    Turn,
    VideoFrame,
    over_background,
    probe,
    read_frames,
    read_jpeg_size,
)
from app.recognition.recording.video_limits import VideoLimits
from tests.recognition.damaged_clips import (
    HEIGHT,
    IMPOSTORS,
    PLAYLISTS,
    WIDTH,
    cut_off,
    flipped,
    huge_motion_jpeg,
    joined,
    of_another_file,
    sound_only,
    write_clip,
    write_program_stream,
)

RED, BLUE = 0, 2


def read(path: Path, limits: VideoLimits | None = None) -> tuple[list[VideoFrame], tuple[str, ...]]:
    reader = read_frames(path, limits)
    return list(reader), reader.warnings


def is_red(image: Image, row: int, column: int) -> bool:
    red, _, blue = image[row, column]
    return bool(red > 180 and blue < 80)


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("clip.mp4", {}),
        ("clip.mov", {}),
        ("clip.mkv", {}),
        ("clip.ts", {}),
        ("clip.webm", {"codec": "libvpx-vp9"}),
        ("clip.avi", {"codec": "mpeg4"}),
        ("ten_bits.mp4", {"pixel_format": "yuv420p10le"}),
        ("odd.mp4", {"pixel_format": "yuv444p", "size": (63, 47)}),
        ("odd.webm", {"codec": "libvpx", "size": (63, 47)}),
        ("alpha.mov", {"codec": "png", "pixel_format": "rgba"}),
        ("forty_one_streams.mkv", {"extra_streams": 40}),
    ],
)
def test_every_common_kind_of_clip_is_read(
    tmp_path: Path, name: str, options: dict[str, Any]
) -> None:
    clip = write_clip(tmp_path / name, frames=12, **options)
    width, height = options.get("size", (WIDTH, HEIGHT))
    frames, warnings = read(clip)
    assert [frame.index for frame in frames] == list(range(12))
    assert [frame.time for frame in frames] == pytest.approx(np.arange(12) / 25)
    assert all(frame.image.shape == (height, width, 3) for frame in frames)
    assert is_red(frames[0].image, 2, 2)
    assert not is_red(frames[0].image, -3, -3)
    assert warnings == ()


@pytest.mark.withstands(row="H09")
def test_more_streams_than_a_film_has_are_refused(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mkv", extra_streams=70)
    with pytest.raises(VideoError, match="more streams than the limit of 64"):
        probe(clip)


def test_the_name_says_nothing(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mp4").rename(tmp_path / "http:--clip.txt|x")
    assert len(read(clip)[0]) == 12


def test_variable_frame_times_come_from_the_container(tmp_path: Path) -> None:
    times = [0, 0.04, 0.3, 0.31, 1.2, 1.25]
    clip = write_clip(tmp_path / "clip.mkv", frames=6, times=times)
    assert [frame.time for frame in read(clip)[0]] == pytest.approx(times)


def test_time_counts_from_the_first_frame_also_from_before_zero(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mkv", frames=4, times=[-0.2, -0.1, 0, 0.1])
    assert [frame.time for frame in read(clip)[0]] == pytest.approx([0, 0.1, 0.2, 0.3])


def test_a_repeated_timestamp_is_repaired_and_reported(tmp_path: Path) -> None:
    times = [0, 0.04, 0.04, 0.08, 0.12]
    clip = write_clip(tmp_path / "clip.mkv", frames=5, times=times, codec="ffv1")
    frames, warnings = read(clip)
    assert (np.diff([frame.time for frame in frames]) > 0).all()
    assert warnings == ("1 of 5 frames had no usable timestamp; their time is estimated",)


def test_joined_recordings_go_on_in_time(tmp_path: Path) -> None:
    long = [i / 25 for i in range(50)]
    parts = [write_clip(tmp_path / f"{i}.ts", frames=50, times=long) for i in range(2)]
    frames, warnings = read(joined(*parts))
    times = np.array([frame.time for frame in frames])
    assert len(frames) == 100
    assert (np.diff(times) > 0).all()
    assert times[-1] == pytest.approx(98 / 25 + SEAM, abs=0.1)
    assert any("begins again" in told for told in warnings)


def test_a_picture_that_turns_is_told_before_all_else(tmp_path: Path) -> None:
    parts = [write_clip(tmp_path / f"{size[0]}.ts", size=size) for size in ((96, 64), (64, 96))]
    _, warnings = read(joined(*parts))
    assert re.match(r"the picture turns at \d\.\d s, from 96 x 64 to 64 x 96;", warnings[0])


@pytest.mark.parametrize(
    ("rotation", "red_corner"),
    [(0, (2, 2)), (90, (-3, 2)), (180, (-3, -3)), (-90, (2, -3))],
)
@pytest.mark.withstands(row="H09")
def test_pictures_come_upright(tmp_path: Path, rotation: int, red_corner: tuple[int, int]) -> None:
    clip = write_clip(tmp_path / "clip.mp4", rotation=rotation)
    info = probe(clip)
    image = read(clip)[0][0].image
    assert info.rotation == rotation % 360
    assert image.shape == (info.height, info.width, 3)
    assert (info.width < info.height) == (rotation % 180 == 90)
    corners = [(row, column) for row in (2, -3) for column in (2, -3)]
    assert [corner for corner in corners if is_red(image, *corner)] == [red_corner]


@pytest.mark.parametrize("rotation", [0, 90])
@pytest.mark.parametrize(("turn", "red_corner"), [(90, (2, -3)), (180, (-3, -3)), (270, (-3, 2))])
def test_pictures_are_turned_clockwise_after_what_the_file_states(
    tmp_path: Path, turn: Turn, red_corner: tuple[int, int], rotation: int
) -> None:
    clip = write_clip(tmp_path / "clip.mp4", rotation=rotation)
    before, info = probe(clip), probe(clip, turn=turn)
    assert ((info.width, info.height) == (before.height, before.width)) == (turn != 180)
    with read_frames(clip, turn=turn) as frames:
        image = next(frames).image
    assert image.shape == (info.height, info.width, 3)
    with read_frames(clip) as frames:
        upright = next(frames).image
    assert np.array_equal(image, np.rot90(upright, -turn // 90))
    assert rotation or is_red(image, *red_corner)


def test_pixels_that_are_not_square_are_stretched(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mp4", pixel_aspect=Fraction(2, 1))
    assert (probe(clip).width, probe(clip).height) == (2 * WIDTH, HEIGHT)
    assert read(clip)[0][0].image.shape == (HEIGHT, 2 * WIDTH, 3)


def test_transparent_pixels_show_the_grey_background() -> None:
    image = np.array([[[200, 100, 0, 255], [200, 100, 0, 0]]], dtype=np.uint8)
    assert over_background(image).tolist() == [[[200, 100, 0], [128, 128, 128]]]


def test_the_probe_states_size_time_count_and_codec(tmp_path: Path) -> None:
    info = probe(write_clip(tmp_path / "clip.mp4", frames=12))
    assert (info.width, info.height, info.frames, info.codec) == (WIDTH, HEIGHT, 12, "h264")
    assert info.duration == pytest.approx(12 / 25)


@pytest.mark.parametrize("kind", IMPOSTORS)
@pytest.mark.withstands(row="H08")
def test_what_is_no_clip_is_refused_by_its_content(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "clip.mp4"
    path.write_bytes(IMPOSTORS[kind])
    with pytest.raises(VideoError, match=r"clip\.mp4"):
        probe(path)


@pytest.mark.parametrize("kind", PLAYLISTS)
@pytest.mark.parametrize("suffix", ["mp4", "m3u8", "ffconcat", "sdp"])
@pytest.mark.withstands(row="H07")
def test_a_playlist_opens_no_other_file(tmp_path: Path, kind: str, suffix: str) -> None:
    other = write_clip(tmp_path / "other.mp4")
    path = tmp_path / f"clip.{suffix}"
    path.write_text(PLAYLISTS[kind](other))
    with pytest.raises(VideoError):
        probe(path)


def test_a_data_reference_opens_no_other_file(tmp_path: Path) -> None:
    path = of_another_file(tmp_path / "clip.mov", write_clip(tmp_path / "other.mov"))
    # The frames are there for a program that follows such references.
    followed = {"enable_drefs": "1", "use_absolute_path": "1"}
    with av.open(str(path), options=followed) as container:
        assert len(list(container.decode(video=0))) == 12
    with pytest.raises(VideoError, match="no frame"):
        probe(path)


@pytest.mark.parametrize("name", ["http://127.0.0.1:9/clip.mp4", "concat:clip.mp4", "pipe:0", "."])
def test_an_address_is_not_a_file(name: str) -> None:
    with pytest.raises(VideoError, match="not a file"):
        probe(name)


@pytest.mark.withstands(row="H09")
def test_sound_without_a_picture_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(VideoError, match=r"no video, only.*audio"):
        probe(sound_only(tmp_path / "clip.mp4"))


def test_the_cover_of_a_song_is_no_video(tmp_path: Path) -> None:
    cover = cv2.imencode(".jpg", np.zeros((HEIGHT, WIDTH, 3), np.uint8))[1].tobytes()
    with pytest.raises(VideoError, match=r"holds no video, only \['audio'\]"):
        probe(sound_only(tmp_path / "song.mp4", cover))


@pytest.mark.parametrize("name", ["clip.mkv", "clip.mp4", "clip.mov", "clip.ts"])
def test_a_complete_recording_that_begins_late_is_not_cut_short(tmp_path: Path, name: str) -> None:
    times = [68.672 + 0.04 * index for index in range(50)]
    frames, warnings = read(write_clip(tmp_path / name, frames=50, times=times))
    assert (len(frames), warnings) == (50, ())
    assert frames[-1].time == pytest.approx(1.96, abs=1e-3)
    cut = cut_off(write_clip(tmp_path / "cut.mkv", frames=50, times=times), 0.5)
    assert "cut short" in read(cut)[1][0]
    assert "of the 2.0 s" in read(cut)[1][0]


@pytest.mark.parametrize(
    ("name", "jump"),
    [("clip.mkv", 300), ("clip.mkv", 1_700_000_000), ("clip.mp4", 3600), ("clip.ts", 3600)],
)
def test_a_clock_that_is_set_in_a_clip_is_told(tmp_path: Path, name: str, jump: int) -> None:
    times = [0.04 * index + (jump if index >= 25 else 0) for index in range(50)]
    frames, warnings = read(write_clip(tmp_path / name, frames=50, times=times))
    assert frames[-1].time == pytest.approx(1.92 + SEAM, abs=1e-3)
    assert [told.split(";")[0] for told in warnings] == [
        f"the clock was set while it was recorded, ahead by {jump} s"
    ]


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
@pytest.mark.withstands(row="H08")
def test_a_clip_without_its_index_is_refused(tmp_path: Path, share: float) -> None:
    clip = cut_off(write_clip(tmp_path / "clip.mp4", frames=100), share)
    with pytest.raises(VideoError, match=r"clip\.mp4.*(record|export)"):
        read(clip)


@pytest.mark.parametrize(
    ("name", "share", "options"),
    [
        ("clip.mp4", 0.5, {"options": {"movflags": "faststart"}}),
        ("clip.mp4", 0.9, {"options": {"movflags": "faststart"}}),
        ("clip.mp4", 0.99, {"options": {"movflags": "faststart"}}),
        ("clip.mkv", 0.5, {}),
    ],
)
@pytest.mark.withstands(row="H08")
def test_a_truncated_clip_gives_its_beginning_and_says_how_much(
    tmp_path: Path, name: str, share: float, options: dict[str, Any]
) -> None:
    clip = cut_off(write_clip(tmp_path / name, frames=100, **options), share)
    frames, (warning,) = read(clip)
    assert 0 < len(frames) < 100
    assert f"{len(frames)} of {'100' if name == 'clip.mp4' else 'an unknown number of'}" in warning


def test_a_truncated_stream_without_an_index_gives_its_beginning(tmp_path: Path) -> None:
    clip = cut_off(write_clip(tmp_path / "clip.ts", frames=100), 0.5)
    assert 20 < len(read(clip)[0]) < 60


@pytest.mark.parametrize(
    ("limits", "reason"),
    [
        (VideoLimits(pixels=WIDTH * HEIGHT - 1), "64 x 48 pixels"),
        (VideoLimits(frames=11), "frames, more than the limit of 11"),
        (VideoLimits(seconds=0.3), r"more than the limit of 0\.3 s"),
    ],
)
@pytest.mark.parametrize("name", ["clip.mp4", "clip.mkv", "clip.ts"])
@pytest.mark.withstands(row="H09")
def test_limits_hold_and_are_named(
    tmp_path: Path, limits: VideoLimits, reason: str, name: str
) -> None:
    clip = write_clip(tmp_path / name, frames=12)
    with pytest.raises(VideoError, match=reason):
        read(clip, limits)


def test_the_container_may_lie_about_its_length(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mkv", frames=30)
    content = clip.read_bytes()
    # The Matroska element Duration (4489), eight bytes of float: the clip claims a millisecond.
    place = content.index(bytes.fromhex("448988")) + 3
    clip.write_bytes(content[:place] + np.array(1.0, dtype=">f8").tobytes() + content[place + 8 :])
    assert (probe(clip).duration or 0) < 0.1
    with pytest.raises(VideoError, match="limit"):
        read(clip, VideoLimits(seconds=0.5))


@pytest.mark.slow
@pytest.mark.withstands(row="H09")
def test_a_frame_too_large_is_never_decoded(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mp4", frames=1, size=(4800, 4800))
    with pytest.raises(VideoError, match="4800 x 4800 pixels"):
        probe(clip)


@pytest.mark.parametrize("name", ["clip.avi", "clip.mov", "clip.mkv"])
@pytest.mark.parametrize("stated", [False, True])
@pytest.mark.parametrize("side", [8000, 16384])
def test_a_motion_jpeg_that_the_decoder_refuses_is_too_large_and_not_damaged(
    tmp_path: Path, name: str, side: int, stated: bool
) -> None:
    clip = huge_motion_jpeg(tmp_path / name, side, stated=stated)
    with pytest.raises(VideoError, match=f"{side} x {side} pixels, more than the limit"):
        probe(clip)


def test_a_damaged_motion_jpeg_of_a_fitting_size_is_damaged(tmp_path: Path) -> None:
    clip = huge_motion_jpeg(tmp_path / "clip.avi", 2000, stated=False)
    clip.write_bytes(clip.read_bytes().replace(b"\xff\xda", b"\xff\x00"))
    with pytest.raises(VideoError, match="damaged"):
        probe(clip)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "codec"), [("clip.mp4", "libx264"), ("clip.webm", "libvpx"), ("clip.avi", "mpeg4")]
)
@pytest.mark.parametrize("seed", range(4))
def test_flipped_bytes_give_frames_or_a_refusal(
    tmp_path: Path, name: str, codec: str, seed: int
) -> None:
    clip = write_clip(tmp_path / name, frames=20, codec=codec)
    flipped(clip, seed, bytes_changed=4**seed)
    try:
        frames, _ = read(clip)
    except VideoError:
        return
    times = np.array([frame.time for frame in frames])
    assert (np.diff(times) > 0).all()
    assert len({frame.image.shape for frame in frames}) == 1


def test_reading_stops_where_the_reader_is_closed(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mp4")
    with read_frames(clip) as reader:
        assert next(reader).index == 0
    clip.unlink()
    assert list(reader) == []
    assert reader.warnings == ()


@pytest.fixture
def no_collection() -> Iterator[None]:
    """Let Python free only what nothing refers to any more."""
    gc.disable()
    yield
    gc.enable()


@pytest.mark.usefixtures("no_collection")
@pytest.mark.parametrize("read_before", [0, 1, 5, 12])
def test_a_closed_reader_keeps_no_pictures_until_python_collects(
    tmp_path: Path, read_before: int
) -> None:
    reader = read_frames(write_clip(tmp_path / "clip.mp4", frames=12))
    for _ in range(read_before):
        next(reader)
    reader.close()
    alive = weakref.ref(reader)
    del reader
    assert alive() is None


@pytest.mark.usefixtures("no_collection")
def test_neither_does_one_that_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[weakref.ref[FrameReader]] = []

    class Watched(FrameReader):
        def __init__(self, path: Path, limits: VideoLimits) -> None:
            opened.append(weakref.ref(self))
            super().__init__(path, limits)

    # Only the first picture shows that it is too wide once its pixels are square.
    clip = write_clip(tmp_path / "clip.mp4", pixel_aspect=Fraction(2, 1))
    with pytest.raises(VideoError, match="pixels"):
        Watched(clip, VideoLimits(pixels=WIDTH * HEIGHT))
    assert [alive() for alive in opened] == [None]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "count", "seconds"),
    [("diver_follow_me.webm", 83, 6.0), ("pose2sim_single_cam02.mp4", 100, 1.65)],
)
def test_real_clips_keep_their_count_and_time(
    shared_data: Path, name: str, count: int, seconds: float
) -> None:
    reader = read_frames(shared_data / "clips" / name)
    times = [frame.time for frame in reader]
    assert len(times) == count
    assert times[-1] == pytest.approx(seconds, abs=0.005)
    assert reader.warnings == ()


def encoded(width: int, height: int) -> bytes:
    buffer = io.BytesIO()
    with av.open(buffer, "w", format="mjpeg") as container:
        stream = container.add_stream("mjpeg", rate=1)
        stream.width, stream.height, stream.pix_fmt = width, height, "yuvj420p"
        frame = av.VideoFrame.from_ndarray(np.zeros((height, width, 3), np.uint8), "rgb24")
        container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return buffer.getvalue()


@pytest.mark.parametrize("size", [(64, 48), (320, 16), (1, 1)])
def test_the_size_of_an_encoded_picture_is_read(size: tuple[int, int]) -> None:
    assert read_jpeg_size(encoded(*size)) == size


def test_padding_before_a_marker_is_skipped() -> None:
    picture = encoded(64, 48)
    assert read_jpeg_size(picture[:2] + b"\xff\xff" + picture[2:]) == (64, 48)


@given(st.binary(max_size=200))
def test_anything_else_is_read_to_its_end(content: bytes) -> None:
    size = read_jpeg_size(b"\xff\xd8" + content)
    assert size is None or all(0 <= side < 2**16 for side in size)
    assert read_jpeg_size(content.replace(b"\xff\xd8", b"")) is None


def test_a_program_stream_of_an_old_camcorder_is_read(tmp_path: Path) -> None:
    frames, warnings = read(write_program_stream(tmp_path / "dive.mpg"))
    assert [frame.time for frame in frames] == pytest.approx(np.arange(50) / 25)
    assert warnings == ()
