"""Labelled files: the sources of the labels and people in a folder."""

from pathlib import Path

import pytest

from app.evaluation.labelled_takes import labelled_files
from app.recognition import OsgError


def found(folder: Path, names: list[str], layout: str | None = None) -> dict[str, tuple[str, str]]:
    for name in names:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    files = labelled_files(folder, layout)
    return {f.path.relative_to(folder).as_posix(): (f.label, f.person) for f in files}


@pytest.mark.parametrize(
    ("name", "label", "person"),
    [
        ("circle-1.mp4", "circle", ""),
        ("circle_anna 2.MOV", "circle", ""),
        ("circle.npz", "circle", ""),
        ("not clear/take 1.webm", "not clear", ""),
        ("anna/not clear/take 1.webm", "not clear", "anna"),
        ("anna/circle/take 1.csv", "circle", "anna"),
    ],
)
def test_the_place_of_a_file_tells_what_it_shows(
    tmp_path: Path, name: str, label: str, person: str
) -> None:
    assert found(tmp_path, [name]) == {name: (label, person)}


@pytest.mark.parametrize(
    ("layout", "name", "label", "person"),
    [
        ("{label}_#", "not_clear_12.mp4", "not_clear", ""),
        ("{person}/{label}-*", "anna/circle-test-1.mp4", "circle", "anna"),
        ("{label}/{person}_*", "circle/anna_2.mp4", "circle", "anna"),
        ("session (1)/{person} {label}", "session (1)/anna circle.mp4", "circle", "anna"),
    ],
)
def test_a_layout_says_where_label_and_person_stand(
    tmp_path: Path, layout: str, name: str, label: str, person: str
) -> None:
    assert found(tmp_path, [name], layout) == {name: (label, person)}


def test_other_files_and_hidden_ones_are_passed_over(tmp_path: Path) -> None:
    names = ["a/1.mp4", "a/notes.txt", ".trash/2.mp4", "a/.3.mp4", "too/deep/for/this/4.mp4"]
    assert found(tmp_path, names) == {"a/1.mp4": ("a", "")}


def test_a_folder_of_openpose_is_one_take(tmp_path: Path) -> None:
    frames = [f"circle/dive 1/dive_{number:012}_keypoints.json" for number in range(3)]
    assert found(tmp_path, frames) == {"circle/dive 1": ("circle", "")}


def test_a_folder_in_which_nothing_fits_says_what_would(tmp_path: Path) -> None:
    with pytest.raises(OsgError, match=r"\{person\}/\{label\}.*--layout"):
        labelled_files(tmp_path)


def test_a_layout_without_a_label_is_refused(tmp_path: Path) -> None:
    with pytest.raises(OsgError, match=r"has no \{label\}"):
        labelled_files(tmp_path, "{person}/*")
