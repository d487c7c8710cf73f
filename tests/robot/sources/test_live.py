"""A live source gives the newest frame, and comes back when its camera does."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import closing
from datetime import datetime, timezone
from functools import partial
from itertools import islice
from pathlib import Path
from queue import Queue

import numpy as np
import pytest

from app.recognition.errors import SourceError
from app.recognition.poses.frame import Image
from app.recognition.recording.video import Turn
from app.robot import Frame, NoFrame, Notice, SourceLost, SourceRestored
from app.robot.sources.cameras import SILENT_SECONDS, NetworkStream
from app.robot.sources.live import LiveSource, TurnedCamera
from app.robot.sources.registry import open_source
from tests.recognition.damaged_clips import write_clip
from tests.robot.mjpeg_server import FRAME_SIZE, MjpegServer
from tests.robot.rtsp_server import RtspServer


def quick_to_return(address: str) -> LiveSource:
    """Open a stream that is retried soon after a failure."""
    return LiveSource("stream", partial(NetworkStream, address), first_wait=0.05)


def frames(given: Iterator[Frame | Notice]) -> Iterator[Frame]:
    return (each for each in given if isinstance(each, Frame))


def test_frames_of_a_stream_come_in_order_at_growing_times() -> None:
    before = datetime.now(timezone.utc)
    with MjpegServer(brightness=100) as server, closing(open_source(server.address)) as source:
        assert source.live
        assert source.began is not None
        assert before <= source.began <= datetime.now(timezone.utc)
        assert source.frame_size == FRAME_SIZE
        seen = list(islice(frames(iter(source)), 5))
    times = [frame.time for frame in seen]
    assert times == sorted(set(times))
    assert seen[0].image.shape == (FRAME_SIZE[1], FRAME_SIZE[0], 3)
    assert seen[0].image.mean() == pytest.approx(100, abs=2)


def test_a_camera_that_speaks_rtsp_is_watched_until_it_is_gone() -> None:
    with RtspServer(brightness=100) as server:
        source = quick_to_return(server.address)
        given = iter(source)
        seen = list(islice(frames(given), 3))
    with closing(source):
        lost = next(each for each in given if isinstance(each, SourceLost))
    assert source.frame_size == FRAME_SIZE
    assert [frame.image.mean() for frame in seen] == pytest.approx([100] * 3, abs=2)
    assert seen[0].time < seen[1].time < seen[2].time < lost.time
    assert "rtsp://" in lost.reason


class CameraOnDemand:
    """A camera whose pictures come when the test sends them; a `Camera`.

    Parameters
    ----------
    brightness
        Of the first picture.

    """

    def __init__(self, brightness: int) -> None:
        self._pictures: Queue[int | None] = Queue()
        self._pictures.put(brightness)
        self._sent, self._asked_for = 1, 0
        self._asked = threading.Condition()

    def send(self, *brightness: int) -> None:
        """Send a picture of each brightness, and wait until the source has them."""
        for each in brightness:
            self._pictures.put(each)
        self._sent += len(brightness)
        with self._asked:
            # A source that requests another picture has stored the previous one.
            assert self._asked.wait_for(lambda: self._asked_for > self._sent, timeout=60)

    def unplug(self) -> None:
        """Send nothing more."""
        self._pictures.put(None)

    def read(self) -> Image:
        with self._asked:
            self._asked_for += 1
            self._asked.notify_all()
        brightness = self._pictures.get()
        if brightness is None:
            raise SourceError("unplugged")
        return np.full((4, 6, 3), brightness, np.uint8)

    def close(self) -> None:
        pass


def test_a_slow_reader_gets_the_newest_frame_and_the_count_of_the_others() -> None:
    camera = CameraOnDemand(10)
    with closing(LiveSource("camera", lambda: camera)) as source:
        given = frames(iter(source))
        first = next(given)
        camera.send(20, 30, 40, 50)
        late = next(given)
        camera.send(60)
        following = next(given)
        camera.unplug()
    seen = [(int(each.image.mean()), each.dropped) for each in (first, late, following)]
    assert seen == [(10, 0), (50, 3), (60, 0)]
    assert first.time < late.time < following.time


def test_a_stream_that_breaks_is_told_once_and_opened_again() -> None:
    with MjpegServer(brightness=50) as server:
        source = quick_to_return(server.address)
        given = iter(source)
        before = next(frames(given))
    with closing(source):
        lost = next(each for each in given if isinstance(each, SourceLost))
        meanwhile = list(islice(given, 2))  # several attempts fail in this time
        with MjpegServer(server.port, brightness=200):
            restored, frame = islice((each for each in given if not isinstance(each, NoFrame)), 2)
    assert all(isinstance(each, NoFrame) for each in meanwhile)
    assert isinstance(restored, SourceRestored)
    assert isinstance(frame, Frame)
    assert before.time < lost.time < restored.time <= frame.time
    assert restored.attempts >= 1
    assert restored.time - lost.time <= restored.missing <= restored.time - before.time
    assert frame.image.mean() == pytest.approx(200, abs=2)


@pytest.mark.slow
def test_a_stream_that_falls_silent_counts_as_lost_and_is_opened_again() -> None:
    with MjpegServer(pictures=20) as server, closing(quick_to_return(server.address)) as source:
        notices = (each for each in source if isinstance(each, SourceLost | SourceRestored))
        lost, restored = islice(notices, 2)
    assert isinstance(lost, SourceLost)
    assert f"no frame for {SILENT_SECONDS:g} s" in lost.reason
    assert isinstance(restored, SourceRestored)
    assert restored.missing > SILENT_SECONDS


def test_a_closed_source_gives_nothing_more() -> None:
    with MjpegServer() as server:
        source = open_source(server.address)
        source.close()
        source.close()
        assert list(source) == []


def test_a_password_is_not_shown() -> None:
    with MjpegServer() as server, closing(open_source(server.address)) as source:
        assert source.name == f"http://127.0.0.1:{server.port}/"
        address = server.address
    with pytest.raises(SourceError, match="cannot be opened") as refused:
        open_source(address)
    assert "secret" not in str(refused.value)


@pytest.mark.parametrize("name", ["63", "/dev/video63"])
def test_a_camera_that_does_not_exist_is_refused_by_name(
    name: str, capfd: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SourceError, match=rf"camera {name} cannot be opened"):
        open_source(name)
    assert capfd.readouterr() == ("", "")  # OpenCV would complain of its own accord


@pytest.mark.parametrize("turn", [90, 180, 270])
def test_pictures_of_a_camera_that_is_mounted_turned_are_turned_upright(
    turn: Turn, tmp_path: Path
) -> None:
    stored = np.zeros((4, 6, 3), np.uint8)
    stored[0, 0] = 255

    class Sideways:
        def read(self) -> Image:
            return stored

        def close(self) -> None:
            pass

    upright = TurnedCamera(Sideways, turn).read()
    # The upper left corner goes to the upper right with a quarter clockwise.
    height, width = upright.shape[:2]
    corner = {90: (0, width - 1), 180: (height - 1, width - 1), 270: (height - 1, 0)}[turn]
    assert upright[corner].tolist() == [255, 255, 255]
    assert (width, height) == ((6, 4) if turn == 180 else (4, 6))
    clip = write_clip(tmp_path / "sideways.mp4", frames=3)
    plain, turned = open_source(str(clip)), open_source(str(clip), turn)
    with closing(plain), closing(turned):
        assert turned.frame_size == plain.frame_size[:: 1 if turn == 180 else -1]
    with MjpegServer() as server, closing(open_source(server.address, turn)) as source:
        assert source.frame_size == FRAME_SIZE[:: 1 if turn == 180 else -1]
