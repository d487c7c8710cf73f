"""Pictures with boxed hands: folders of stills, and of a team's own photographs."""

from importlib.util import find_spec
from pathlib import Path

import cv2
import numpy as np
import pytest

from release.hand_finder.pictures import read_joints, read_pictures, write_pictures

rendered = pytest.mark.skipif(
    find_spec("anny") is None or find_spec("numba") is None,
    reason="the renderer is not installed (languages/render/requirements.txt)",
)


def photograph(folder: Path, name: str, width: int = 1280) -> None:
    (folder / "images").mkdir(exist_ok=True)
    cv2.imwrite(str(folder / "images" / name), np.full((width * 3 // 4, width, 3), 90, np.uint8))


def test_a_teams_own_boxes_need_no_joints(tmp_path: Path) -> None:
    photograph(tmp_path, "lake_1.jpg")
    (tmp_path / "boxes.csv").write_text(
        "image,what,x0,y0,x1,y1\nlake_1.jpg,Hand,100,200,300,400\nlake_1.jpg,Unclear,0,0,40,40\n"
    )
    (picture,) = read_pictures(tmp_path)
    assert picture.image.shape == (480, 640, 3)
    assert picture.hands[:, :4].tolist() == [[50, 100, 150, 200]]
    assert np.isnan(picture.hands[:, 4:]).all()
    assert len(picture.unclear) == 1


def test_a_dive_can_be_left_out(tmp_path: Path) -> None:
    rows = ["image,what,x0,y0,x1,y1"]
    for name in ("lake_1.jpg", "sea_1.jpg"):
        photograph(tmp_path, name, 320)
        rows.append(f"{name},Picture,0,0,0,0")
    (tmp_path / "boxes.csv").write_text("\n".join(rows) + "\n")
    assert len(read_pictures(tmp_path)) == 2
    assert len(read_pictures(tmp_path, ["lake"])) == 1


@rendered
def test_drawn_stills_are_the_same_again_with_their_hands_in_the_frame(tmp_path: Path) -> None:
    for name in ("one", "other"):
        write_pictures(tmp_path / name, [5])
    one, other = (read_pictures(tmp_path / name) for name in ("one", "other"))
    assert len(one) == 2
    for still, again in zip(one, other, strict=True):
        assert (still.image == again.image).all()
        boxes = np.concatenate([still.hands, still.unclear])[:, :4]
        assert (boxes >= 0).all()
        assert (boxes[:, 2:] <= (640, 480)).all()


@rendered
def test_joints_of_drawn_hands_lie_in_their_boxes(tmp_path: Path) -> None:
    write_pictures(tmp_path, [5], salutes=1.0)
    stills, pictures = read_joints(tmp_path), read_pictures(tmp_path)
    assert len(stills) == len(pictures) == 2
    for still, picture in zip(stills, pictures, strict=True):
        assert (still.image == picture.image).all()
        boxes = np.concatenate([picture.hands, picture.unclear])
        for joints in still.joints[still.seen > 0]:
            inside = (joints[0] >= boxes[:, :2] - 1) & (joints[0] <= boxes[:, 2:4] + 1)
            assert inside.all(axis=1).any()
