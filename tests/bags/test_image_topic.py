"""Pictures of a topic as frames: encodings, times, and what is damaged."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from app.bags.bag import open_bag
from app.bags.image_messages import raw_image
from app.bags.image_topic import BagFrames
from app.recognition.errors import BagError, VideoError
from app.recognition.poses.frame import Image
from app.recognition.recording.timestamps import LONGEST_PAUSE, SEAM
from app.recognition.recording.video import VideoFrame
from app.recognition.recording.video_limits import VideoLimits
from tests.bags.bag_files import DELAY, START, Row, compressed, header, message, raw, write_bag
from tests.recognition.damaged_clips import picture

TIMES = [0.0, 0.04, 0.0801, 0.35, 0.36, 2.0]
"""Seconds, not evenly spaced: as a camera that drops frames."""


def frames_of(
    path: Path, rows: list[Row], limits: VideoLimits | None = None
) -> tuple[list[VideoFrame], BagFrames]:
    """Write rows into a bag, and read its pictures back."""
    with open_bag(write_bag(path / "dive", rows)) as bag:
        reader = BagFrames(bag, bag.topic(), limits)
        return list(reader), reader


def moments(times: list[float]) -> list[int]:
    return [START + round(time * 1e9) for time in times]


def test_frames_have_the_stamps_of_their_headers_exactly(tmp_path: Path) -> None:
    jitter = np.random.default_rng(0).integers(0, 10**7, len(TIMES)).tolist()
    rows: list[Row] = [
        ("/camera", raw(picture(i), "rgb8", stamp), stamp + late)
        for i, (stamp, late) in enumerate(zip(moments(TIMES), jitter, strict=True))
    ]
    frames, reader = frames_of(tmp_path, rows)
    assert [frame.time for frame in frames] == TIMES
    assert [frame.index for frame in frames] == list(range(len(TIMES)))
    assert all(np.array_equal(frame.image, picture(frame.index)) for frame in frames)
    assert (reader.info.width, reader.info.height, reader.info.frames) == (64, 48, len(TIMES))
    assert reader.warnings == ()


def test_without_stamps_time_is_when_the_messages_were_received(tmp_path: Path) -> None:
    rows: list[Row] = [
        ("/camera", raw(picture(i), "rgb8", 0), stamp + DELAY)
        for i, stamp in enumerate(moments(TIMES))
    ]
    frames, reader = frames_of(tmp_path, rows)
    assert [frame.time for frame in frames] == TIMES
    assert "say not when the picture was taken" in reader.warnings[0]


def test_a_clock_that_jumps_back_is_repaired_and_told(tmp_path: Path) -> None:
    taken = moments([0.0, 0.1, 0.1, 0.3, -50.0, -49.9])
    rows: list[Row] = [
        ("/camera", raw(picture(i), "rgb8", stamp), START + i * 10**8)
        for i, stamp in enumerate(taken)
    ]
    frames, reader = frames_of(tmp_path, rows)
    times = [frame.time for frame in frames]
    assert len(times) == 6
    assert (np.diff(times) > 0).all()
    assert times[-1] < 1
    assert "set while it was recorded, back by 50 s; time goes on" in reader.warnings[-1]
    assert "1 of 6 messages had no timestamp, or one not later" in reader.warnings[0]


@pytest.mark.parametrize("jump", [20, 3600, 1_700_000_000])
@pytest.mark.parametrize("whole", [False, True], ids=["headers", "whole machine"])
def test_a_clock_that_is_set_while_recording_is_noticed_and_told(
    tmp_path: Path, jump: int, whole: bool
) -> None:
    times = [0.1 * place for place in range(8)]
    taken = [10**9 + round(time * 1e9) + (time > 0.35) * jump * 10**9 for time in times]
    rows: list[Row] = [
        ("/camera", raw(picture(place), "rgb8", stamp), stamp if whole else START + place * 10**8)
        for place, stamp in enumerate(taken)
    ]
    frames, reader = frames_of(tmp_path, rows)
    if whole and jump < LONGEST_PAUSE:  # The camera may as well have paused.
        assert frames[-1].time == pytest.approx(times[-1] + jump)
        assert reader.warnings == ()
        return
    # Without a second clock nobody knows how long the camera saw nothing.
    seam = SEAM - 0.1 if whole else 0.0
    later = [time + seam * (time > 0.35) for time in times]
    assert [frame.time for frame in frames] == pytest.approx(later)
    told = "no gesture is read across it" if whole else "time goes on"
    assert f"ahead by {jump} s; {told}" in " ".join(reader.warnings)


def test_messages_that_arrive_late_and_at_once_keep_their_stamps(tmp_path: Path) -> None:
    late = [0, 0, 5 * 10**9, 0, 0]
    rows: list[Row] = [
        (
            "/camera",
            raw(picture(place), "rgb8", START + place * 10**8),
            START + place * 10**8 + wait,
        )
        for place, wait in enumerate(late)
    ]
    frames, reader = frames_of(tmp_path, rows)
    assert sorted(frame.time for frame in frames) == pytest.approx(
        [0.0, 0.1, 0.2, 0.3, 0.4], abs=0.2
    )
    assert not any("clock" in told for told in reader.warnings)


def to_uyvy(image: Image) -> Image:
    return np.asarray(cv2.cvtColor(image, cv2.COLOR_RGB2YUV_UYVY), dtype=np.uint8)


def to_yuy2(image: Image) -> Image:
    return np.asarray(cv2.cvtColor(image, cv2.COLOR_RGB2YUV_YUY2), dtype=np.uint8)


def with_alpha(image: Image) -> Image:
    return np.dstack([image, np.full(image.shape[:2], 200, np.uint8)])


def deep(image: Image) -> Image:
    return np.asarray(image.astype("<u2") * 257, dtype="<u2")


def bayer(image: Image, pattern: str) -> Image:
    """Keep only the colour of each pixel that the sensor's 2 x 2 pattern lets through."""
    mosaic = np.zeros(image.shape[:2], np.uint8)
    for place, colour in enumerate(pattern):
        row, column = divmod(place, 2)
        mosaic[row::2, column::2] = image[row::2, column::2, "rgb".index(colour)]
    return mosaic


EXACT: dict[str, Callable[[Image], Image]] = {
    "rgb8": lambda image: image,
    "bgr8": lambda image: image[..., ::-1],
    "8UC3": lambda image: image[..., ::-1],
    "rgba8": with_alpha,
    "bgra8": lambda image: with_alpha(image[..., ::-1]),
    "rgb16": deep,
    "bgr16": lambda image: deep(image[..., ::-1]),
}
CLOSE: dict[str, Callable[[Image], Image]] = {
    "yuv422": to_uyvy,
    "yuv422_yuy2": to_yuy2,
    **{
        f"bayer_{pattern}8": lambda image, pattern=pattern: bayer(image, pattern)  # type: ignore[misc]
        for pattern in ("rggb", "bggr", "gbrg", "grbg")
    },
}


@pytest.mark.parametrize("padding", [0, 12])
@pytest.mark.parametrize("encoding", [*EXACT, *CLOSE])
def test_every_encoding_gives_the_same_colours(encoding: str, padding: int) -> None:
    image = picture(40)
    written = (EXACT | CLOSE)[encoding](image)
    read = raw_image(raw(written, encoding, START, padding), VideoLimits())
    assert read.shape == image.shape
    assert read.dtype == np.uint8
    # Compared inside areas of one colour, because at their edges pixels share a chroma or a colour.
    inside = [(slice(4, 20), slice(4, 28)), (slice(28, 44), slice(36, 60))]
    for area in inside:
        difference = np.abs(read[area].astype(int) - image[area].astype(int)).max()
        assert difference <= (0 if encoding in EXACT else 4)


@pytest.mark.parametrize("encoding", ["mono8", "mono16", "8UC1"])
def test_grey_pictures_become_grey(encoding: str) -> None:
    grey = picture(40)[..., 2]
    written = deep(grey) if encoding == "mono16" else grey
    read = raw_image(raw(written, encoding, START), VideoLimits())
    assert np.array_equal(read, np.dstack([grey] * 3))


@pytest.mark.parametrize(("ending", "tolerance"), [(".png", 0), (".jpg", 6)])
def test_compressed_pictures_are_read(tmp_path: Path, ending: str, tolerance: int) -> None:
    rows: list[Row] = [
        ("/camera", compressed(picture(i), ending, stamp), stamp)
        for i, stamp in enumerate(moments(TIMES))
    ]
    frames, _ = frames_of(tmp_path, rows)
    assert [frame.time for frame in frames] == TIMES
    for frame in frames:
        inside = (slice(28, 44), slice(36, 60))
        difference = frame.image[inside].astype(int) - picture(frame.index)[inside]
        assert np.abs(difference).max() <= tolerance


def test_packets_of_a_video_stream_are_read(tmp_path: Path) -> None:
    codec = av.CodecContext.create("libx264", "w")
    assert isinstance(codec, av.VideoCodecContext)
    codec.width, codec.height, codec.pix_fmt = 64, 48, "yuv420p"
    codec.options = {"preset": "ultrafast", "bf": "0", "tune": "zerolatency"}
    codec.time_base = Fraction(1, 25)
    packets: list[bytes] = []
    for index in range(len(TIMES)):
        frame = av.VideoFrame.from_ndarray(picture(index), format="rgb24")
        frame.pts = index
        packets += [bytes(packet) for packet in codec.encode(frame)]
    packets += [bytes(packet) for packet in codec.encode(None)]
    rows: list[Row] = []
    for stamp, data in zip(moments(TIMES), packets, strict=True):
        numbers = np.frombuffer(data, np.uint8)
        kind = "ffmpeg_image_transport_msgs/msg/FFMPEGPacket"
        fields = (header(stamp), 64, 48, "h264;yuv420p;bgr8", 0, 0, False, numbers)
        rows.append(("/camera", message(kind, *fields), stamp))
    frames, reader = frames_of(tmp_path, rows)
    assert [frame.time for frame in frames] == TIMES
    assert reader.warnings == ()
    with pytest.raises(BagError, match=r"can be read \(they cannot be decoded, as where a stream"):
        frames_of(tmp_path / "later", rows[1:])


def test_a_damaged_picture_among_others_is_left_out_and_counted(tmp_path: Path) -> None:
    rows: list[Row] = []
    for i, stamp in enumerate(moments(TIMES)):
        content = compressed(picture(i), ".png", stamp)
        if i == 2:
            content.data = np.zeros(50, np.uint8)
        rows.append(("/camera", content, stamp))
    frames, reader = frames_of(tmp_path, rows)
    assert [frame.time for frame in frames] == [t for i, t in enumerate(TIMES) if i != 2]
    assert "1 of 6 pictures of /camera were left out" in reader.warnings[0]


def test_odd_sizes_lose_their_last_row_and_column_and_changed_ones_are_scaled(
    tmp_path: Path,
) -> None:
    sizes = [(65, 49), (64, 48), (128, 96)]
    rows: list[Row] = [
        ("/camera", raw(picture(0, *size), "rgb8", stamp), stamp)
        for size, stamp in zip(sizes, moments(TIMES), strict=False)
    ]
    frames, reader = frames_of(tmp_path, rows)
    assert {frame.image.shape for frame in frames} == {(48, 64, 3)}
    assert "1 of 3 pictures had another size" in reader.warnings[0]


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        (VideoLimits(pixels=3000), "64 x 48 pixels"),
        (VideoLimits(frames=3), "at least 6 frames"),
        (VideoLimits(seconds=1.0), "at least 2 s"),
    ],
)
def test_limits_hold(tmp_path: Path, limits: VideoLimits, words: str) -> None:
    rows: list[Row] = [
        ("/camera", raw(picture(i), "rgb8", stamp), stamp) for i, stamp in enumerate(moments(TIMES))
    ]
    with pytest.raises(VideoError, match=words):
        frames_of(tmp_path, rows, limits)


def test_a_step_that_is_left_out_is_that_of_whole_rows(tmp_path: Path) -> None:
    content = raw(picture(0), "rgb8", START)
    content.step = 0
    (frame,), _ = frames_of(tmp_path, [("/camera", content, START)])
    np.testing.assert_array_equal(frame.image, picture(0))


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("encoding", "32FC1", "encoded as '32FC1', which is not known; record them as one of"),
        ("height", 480, "the recording is damaged"),
        ("step", 3, "the recording is damaged"),
        ("width", 0, "the recording is damaged"),
    ],
)
def test_a_topic_of_unreadable_pictures_is_refused(
    tmp_path: Path, field: str, value: object, words: str
) -> None:
    content = raw(picture(0), "rgb8", START)
    setattr(content, field, value)
    with pytest.raises(BagError, match=f"no picture of topic /camera can be read .*{words}"):
        frames_of(tmp_path, [("/camera", content, START)])


@pytest.mark.parametrize("stated", ["compressedDepth", "", "theora"])
def test_unknown_compression_is_refused(tmp_path: Path, stated: str) -> None:
    content = message(
        "sensor_msgs/msg/CompressedImage", header(START), stated, np.zeros(9, np.uint8)
    )
    with pytest.raises(BagError, match="which is not known; record JPEG, PNG"):
        frames_of(tmp_path, [("/camera", content, START)])


@settings(max_examples=60, deadline=None)
@example(height=1, width=1, step=2, size=2, encoding="yuv422")
@given(
    height=st.integers(0, 40),
    width=st.integers(0, 40),
    step=st.integers(0, 200),
    size=st.integers(0, 6000),
    encoding=st.sampled_from([*EXACT, *CLOSE, "mono8", "mono16", "x"]),
)
def test_whatever_a_raw_picture_claims_it_is_read_or_refused(
    height: int, width: int, step: int, size: int, encoding: str
) -> None:
    data = np.zeros(size, np.uint8)
    fields = (header(START), height, width, encoding, 0, step, data)
    content = message("sensor_msgs/msg/Image", *fields)
    try:
        image = raw_image(content, VideoLimits())
    except BagError:
        return
    assert image.shape == (height, width, 3)


def test_pictures_of_a_topic_are_turned_clockwise(tmp_path: Path) -> None:
    rows: list[Row] = [("/camera", raw(picture(0), "rgb8", START), START)]
    with open_bag(write_bag(tmp_path / "dive", rows)) as bag:
        reader = BagFrames(bag, bag.topic(), turn=90)
        (frame,) = reader
    assert (reader.info.width, reader.info.height) == (48, 64)
    assert np.array_equal(frame.image, np.rot90(picture(0), -1))
