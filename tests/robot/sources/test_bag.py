"""A dive recording as a robot's source."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from app.recognition.errors import BagError, TopicError
from app.robot.events import SourceWarned
from app.robot.sources.registry import open_source
from app.robot.sources.source import Frame
from tests.api.recordings import recording_of
from tests.bags.bag_files import START, Row, published_rows, raw, write_bag
from tests.recognition.damaged_clips import picture


def stereo(folder: Path) -> Path:
    """Write a bag with two cameras, whose pictures tell them apart."""
    rows: list[Row] = [
        (topic, raw(picture(index + shade), "rgb8", stamp), stamp)
        for index in range(5)
        for topic, shade, stamp in (
            ("/left", 0, START + index * 10**8),
            ("/right", 50, START + index * 10**8 + 1),
        )
    ]
    return write_bag(folder, rows)


def test_every_picture_of_the_named_topic_is_given_at_its_stamp(tmp_path: Path) -> None:
    source = open_source(f"{stereo(tmp_path / 'dive')}@/right")
    assert (source.live, source.frame_size) == (False, (64, 48))
    frames = [frame for frame in source if isinstance(frame, Frame)]
    assert np.allclose([frame.time for frame in frames], [0, 0.1, 0.2, 0.3, 0.4], atol=1e-9)
    assert all(
        np.array_equal(frame.image, picture(index + 50)) for index, frame in enumerate(frames)
    )
    source.close()
    source.close()
    assert [each for each in source if isinstance(each, Frame)] == []


def test_what_is_wrong_with_it_is_told_at_the_end(tmp_path: Path) -> None:
    rows: list[Row] = [("/camera", raw(picture(i), "rgb8", 0), START + i) for i in range(2)]
    source = open_source(str(write_bag(tmp_path / "dive", rows)))
    *_, last = source
    assert isinstance(last, SourceWarned)
    assert "when they were received" in last.reason


def test_a_recording_without_pictures_or_with_too_many_is_refused(tmp_path: Path) -> None:
    with pytest.raises(TopicError, match="2 topics to choose from: /left"):
        open_source(str(stereo(tmp_path / "stereo")))
    keypoints = write_bag(tmp_path / "keypoints", published_rows(recording_of("line")))
    with pytest.raises(BagError, match="holds keypoints, and a robot looks at pictures"):
        open_source(str(keypoints))
