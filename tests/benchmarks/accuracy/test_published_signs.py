"""Published sets of divers' signs are read take by take, and other settings counted apart."""

from collections import Counter
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from app.evaluation.labelled_takes import ClipRecorder
from app.recognition import OsgError
from benchmarks.accuracy.hand_shapes import ask, count
from benchmarks.accuracy.published_signs import (
    READERS,
    draw_signs,
    make_gestures,
    measurements,
)
from tests.benchmarks.accuracy.sign_folders import write_caddy, write_scubanet, write_sdg11


@pytest.fixture
def keep(tmp_path: Path) -> Path:
    return tmp_path / "kept"


@pytest.fixture
def recorder(keep: Path) -> Iterator[ClipRecorder]:
    with closing(ClipRecorder(keep)) as opened:
        yield opened


def test_sdg11_has_one_take_a_clip_with_place_and_view(
    tmp_path: Path, keep: Path, recorder: ClipRecorder
) -> None:
    write_sdg11(tmp_path / "set", keep)
    takes = list(READERS["SDG11"](tmp_path / "set", recorder))
    assert Counter(take.label for take in takes) == {"LEFT": 2, "BUDDY_UP": 2, "STOP": 2}
    assert {take.setting for take in takes} == {"TANK VERTICAL", "SEA-LOWVIZ VERTICAL"}


def test_scubanet_has_one_take_a_run_of_labels_and_idle_is_no_sign(
    tmp_path: Path, keep: Path, recorder: ClipRecorder
) -> None:
    write_scubanet(tmp_path / "set", keep)
    takes = list(READERS["SCUBANetV2"](tmp_path / "set", recorder))
    assert Counter(take.label for take in takes) == {"Left": 2, "Right": 2, "Up": 2, None: 3}
    assert takes[0].setting == "left 1080p GX01"


def test_labels_of_another_form_are_named(
    tmp_path: Path, keep: Path, recorder: ClipRecorder
) -> None:
    write_scubanet(tmp_path / "set", keep)
    (tmp_path / "set" / "gestures" / "left 1080p GX01.json").write_text('{"labels": [1]}')
    with pytest.raises(OsgError, match=r"left 1080p GX01.json is no label file of SCUBANetV2"):
        list(READERS["SCUBANetV2"](tmp_path / "set", recorder))


@pytest.mark.usefixtures("installed_models")
def test_caddy_has_one_take_a_run_of_pictures_as_the_camera_gave_them(
    tmp_path: Path, sample_clips: Path, recorder: ClipRecorder
) -> None:
    write_caddy(tmp_path, sample_clips / "line-demonstration.mp4")
    takes = list(READERS["CADDY"](tmp_path, recorder))
    assert Counter((take.label, len(take.poses)) for take in takes) == {
        ("one", 2): 1,
        ("two", 1): 1,
        (None, 2): 1,
    }
    assert all(take.poses.seen.any() for take in takes)


def test_a_table_without_a_column_is_named(
    tmp_path: Path, sample_clips: Path, recorder: ClipRecorder
) -> None:
    write_caddy(tmp_path, sample_clips / "line-demonstration.mp4")
    (table,) = tmp_path.glob("*positives*.csv")
    table.write_text(table.read_text().replace("label name", "label"))
    with pytest.raises(OsgError, match="has no column label name"):
        list(READERS["CADDY"](tmp_path, recorder))


def test_takes_of_another_setting_and_without_a_sign_are_counted_apart(
    tmp_path: Path, keep: Path, recorder: ClipRecorder
) -> None:
    write_sdg11(tmp_path / "set", keep)
    takes = list(READERS["SDG11"](tmp_path / "set", recorder))
    drawn = draw_signs(takes, make_gestures(takes), draws=2, queries=10, seed=1)
    assert {each.name: each.n for each in count(ask(drawn))} == {
        "other/nearest": 6,
        "other/right": 6,
        "other/refused": 6,
    }
    write_scubanet(tmp_path / "other", keep)
    takes = list(READERS["SCUBANetV2"](tmp_path / "other", recorder))
    drawn = draw_signs(takes, make_gestures(takes), draws=2, queries=10, seed=1)
    found = {each.name: each.n for each in count(ask(drawn))}
    assert (found["alike/nearest"], found["no-sign/accepted"]) == (6, 6)


def test_a_set_that_is_not_there_is_named(tmp_path: Path) -> None:
    assert [each.missing() for each in measurements(tmp_path, ())] == [
        [str(tmp_path / name)] for name in READERS
    ]
