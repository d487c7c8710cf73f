"""The clock: seeks, plays and pauses, one frame at a time."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator

import pytest

from app.ui.playback import Playback, Position
from tests.api.running import until


class Screen:
    """Records what was drawn, and can be made slow."""

    def __init__(self) -> None:
        self.drawn: list[int] = []
        self.gate = threading.Event()
        self.gate.set()

    def draw(self, frame: int) -> None:
        assert self.gate.wait(60)
        self.drawn.append(frame)


@pytest.fixture
def screen() -> Screen:
    return Screen()


@pytest.fixture
def playback(screen: Screen) -> Iterator[Playback]:
    playback = Playback(screen.draw)
    yield playback
    screen.gate.set()
    playback.close()


def shows(screen: Screen, frame: int) -> Callable[[], bool]:
    return lambda: bool(screen.drawn) and screen.drawn[-1] == frame


def test_seeking_shows_the_frame(playback: Playback, screen: Screen) -> None:
    playback.load([0.0, 0.1, 0.2, 0.3])
    playback.seek(2)
    until(shows(screen, 2))
    assert playback.frame == 2


@pytest.mark.parametrize(("wanted", "shown"), [(-3, 0), (99, 3)])
def test_seeking_beyond_the_ends_stops_at_them(
    playback: Playback, screen: Screen, wanted: int, shown: int
) -> None:
    playback.load([0.0, 0.1, 0.2, 0.3], frame=1)
    playback.seek(wanted)
    until(shows(screen, shown))


def test_of_many_seeks_only_the_newest_is_drawn_next(playback: Playback, screen: Screen) -> None:
    playback.load([float(second) for second in range(500)])
    until(shows(screen, 0))
    screen.gate.clear()
    for frame in range(1, 500):
        playback.seek(frame)
    screen.gate.set()
    until(shows(screen, 499))
    # One may have been under way when the others came.
    assert len(screen.drawn) <= 3


def test_playing_reaches_the_end_and_starts_over(playback: Playback, screen: Screen) -> None:
    playback.load([0.0, 0.01, 0.02, 0.03])
    playback.play(4)
    assert playback.playing
    until(lambda: 3 in screen.drawn and screen.drawn[-1] < 3)


def test_playing_begins_at_the_start_until_someone_has_chosen_a_frame(
    playback: Playback, screen: Screen
) -> None:
    hour = [0.0, 3600.0, 7200.0]
    playback.load(hour, frame=1)
    until(shows(screen, 1))
    playback.play(1)
    until(shows(screen, 0))
    playback.load(hour, frame=0)
    playback.seek(1)
    playback.play(1)
    until(shows(screen, 1))
    assert playback.playing


def test_pausing_keeps_the_frame(playback: Playback, screen: Screen) -> None:
    playback.load([0.0, 3600.0])
    playback.play(1)
    assert playback.playing
    playback.play(0)
    until(shows(screen, 0))
    assert not playback.playing


def test_one_frame_cannot_be_played(playback: Playback) -> None:
    playback.load([0.0])
    playback.play(1)
    assert not playback.playing


def test_a_clip_that_grows_plays_on_to_its_new_end(playback: Playback, screen: Screen) -> None:
    playback.load([0.0, 0.01], 1)
    playback.set_loop(False)
    playback.set_span((0, 4), [0.0, 0.01, 0.02, 0.03, 0.04])
    until(shows(screen, 1))
    assert playback.position.frames == 5
    playback.seek(1)
    playback.play(1.0)
    until(shows(screen, 4))


def test_another_recording_stops_the_last_one(playback: Playback) -> None:
    playback.load([0.0, 3600.0])
    playback.play(1)
    playback.load([0.0, 1.0, 2.0], frame=1)
    assert not playback.playing
    assert playback.frame == 1


@pytest.mark.slow
def test_a_loop_stays_in_the_range_on_display(playback: Playback, screen: Screen) -> None:
    playback.load([second / 100 for second in range(30)], frame=12, span=(10, 14))
    playback.play(16)
    until(lambda: 14 in screen.drawn and 10 in screen.drawn[screen.drawn.index(14) :])
    assert set(screen.drawn[1:]) <= set(range(10, 15))


def test_without_a_loop_it_plays_to_the_end_of_the_clip_and_stops(
    playback: Playback, screen: Screen
) -> None:
    playback.load([second / 100 for second in range(30)], frame=12, span=(10, 14))
    playback.set_loop(False)
    playback.play(2)
    until(shows(screen, 29))
    until(lambda: not playback.playing)


def test_backwards_it_plays_to_the_start(playback: Playback, screen: Screen) -> None:
    playback.load([second / 100 for second in range(30)])
    playback.set_loop(False)
    playback.seek(20)
    playback.play(-2)
    until(shows(screen, 0))
    until(lambda: not playback.playing)
    assert playback.position.speed == -2


def test_a_step_pauses_and_moves_by_whole_frames(playback: Playback, screen: Screen) -> None:
    playback.load([0.0, 3600.0, 7200.0, 7300.0])
    playback.play(1)
    playback.step(2)
    until(shows(screen, 2))
    assert not playback.playing
    playback.step(-1)
    until(shows(screen, 1))


def test_who_listens_hears_of_every_frame_until_it_ends(playback: Playback) -> None:
    heard: list[Position] = []
    end = playback.listen(heard.append)
    playback.load([0.0, 0.25, 0.5])
    playback.seek(2)
    until(lambda: bool(heard) and heard[-1].frame == 2)
    assert heard[-1] == Position(2, 3, 0.5, playing=False, speed=1.0, loop=True)
    end()
    playback.seek(0)
    until(lambda: playback.position.frame == 0)
    assert heard[-1].frame == 2


def test_a_picture_that_arrives_is_drawn_if_its_frame_is_on_display(
    playback: Playback, screen: Screen
) -> None:
    playback.load([0.0, 1.0, 2.0], frame=1)
    until(shows(screen, 1))
    playback.redraw(2)
    playback.redraw(1)
    until(lambda: screen.drawn[-2:] == [1, 1])
    assert 2 not in screen.drawn
