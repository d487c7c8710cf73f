"""Times of frames: the container's, repaired where they cannot be true."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.recording.timestamps import FALLBACK_STEP, SEAM, FrameClock

stamps = st.lists(st.none() | st.floats(-1e5, 1e5, allow_nan=False), min_size=1, max_size=60)


def times(given_stamps: list[float | None], step: float = 0.04) -> tuple[list[float], int]:
    clock = FrameClock(step=step)
    return [clock.seconds(stamp) for stamp in given_stamps], clock.repaired


@given(stamps)
@pytest.mark.withstands(row="H09")
def test_time_begins_at_zero_and_always_increases(given_stamps: list[float | None]) -> None:
    seconds, _ = times(given_stamps)
    assert seconds[0] == 0
    assert (np.diff(seconds) > 0).all()


@given(
    st.lists(st.integers(1, 5000), min_size=1, max_size=40),
    st.floats(-1000, 1000, allow_nan=False),
)
def test_good_timestamps_are_kept_whatever_the_rate(gaps: list[int], origin: float) -> None:
    expected = np.concatenate([[0], np.cumsum(gaps)]) / 1000
    seconds, repaired = times([origin + value for value in expected.tolist()])
    assert np.allclose(seconds, expected, atol=1e-9)
    assert repaired == 0


def test_a_missing_timestamp_is_one_step_after_the_frame_before() -> None:
    seconds, repaired = times([0, 0.1, 0.2, None, 0.4])
    assert seconds == pytest.approx([0, 0.1, 0.2, 0.3, 0.4])
    assert repaired == 1


def test_no_timestamps_at_all_give_the_nominal_rate() -> None:
    seconds, repaired = times([None] * 4, step=0.02)
    assert seconds == pytest.approx([0, 0.02, 0.04, 0.06])
    assert repaired == 4


def test_a_repeated_timestamp_does_not_delay_the_frames_after_it() -> None:
    seconds, repaired = times([0, 0.04, 0.04, 0.08, 0.12])
    assert seconds == pytest.approx([0, 0.04, 0.05, 0.08, 0.12])
    assert repaired == 1


def test_frames_out_of_order_do_not_shift_the_clock() -> None:
    seconds, _ = times([0, 0.08, 0.04, 0.12, 0.16])
    assert seconds[-2:] == pytest.approx([0.12, 0.16])


def test_a_clock_that_starts_anew_goes_on_where_it_was() -> None:
    seconds, repaired = times([100, 100.04, 100.08, 0, 0.04, 0.08])
    assert seconds == pytest.approx([0, 0.04, 0.08, *(SEAM + 0.08 + np.arange(3) * 0.04)])
    assert repaired == 1


@pytest.mark.parametrize("jump", [90.0, 3600.0, 1.7e9, -3600.0])
def test_a_clock_that_is_set_leaves_a_seam_that_is_told(jump: float) -> None:
    clock = FrameClock(step=0.02)
    stamps = [0.0, 0.04, 0.08, jump + 0.12, jump + 0.16]
    found = [clock.seconds(each) for each in stamps]
    assert found == pytest.approx([0, 0.04, 0.08, SEAM + 0.08, SEAM + 0.12])
    assert clock.jumps == ([pytest.approx(jump)] if jump > 0 else [])
    assert clock.restarts == ([] if jump > 0 else [0.08])
    (told,) = clock.sentences
    assert "ahead by" in told if jump > 0 else "begins again at 0.08 s" in told


def test_a_pause_of_the_camera_stays_a_pause() -> None:
    clock = FrameClock()
    assert [clock.seconds(each) for each in (0.0, 0.04, 40.0)] == [0.0, 0.04, 40.0]
    assert not clock.jumps


@pytest.mark.parametrize("rate", [0.0, -1.0, 1e-9, 90000.0])
def test_an_absurd_nominal_step_is_not_believed(rate: float) -> None:
    assert FrameClock(step=rate).step == FALLBACK_STEP
