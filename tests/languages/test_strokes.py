"""Strokes: the tracked palette is what the script draws, and strokes suit a language."""

from pathlib import Path

import numpy as np
import pytest

from app.recognition import Language, check_health
from app.recognition.health.choice import measure_confusions
from app.resources import known_signs_file
from languages.strokes import FIGURES, FILE, draw_stroke, main


@pytest.fixture(scope="module")
def palette() -> Language:
    return Language.load(FILE)


def test_drawing_again_gives_the_tracked_file(palette: Language, tmp_path: Path) -> None:
    main(tmp_path / "strokes.json")
    drawn = Language.load(tmp_path / "strokes.json")
    assert drawn.labels == palette.labels == tuple(FIGURES)
    for one, other in zip(drawn.gestures, palette.gestures, strict=True):
        assert one.trajectory is not None
        assert other.trajectory is not None
        assert np.allclose(one.trajectory.xy, other.trajectory.xy, atol=1e-3, equal_nan=True)


def test_no_arm_is_longer_than_its_bones() -> None:
    for figure in FIGURES.values():
        poses = draw_stroke(figure)
        shoulder, elbow, wrist = (
            poses.column(f"right_{part}") for part in ("shoulder", "elbow", "wrist")
        )
        upper, fore = (
            np.linalg.norm(end - start, axis=1)
            for start, end in ((shoulder, elbow), (elbow, wrist))
        )
        assert np.allclose(upper, upper[0], atol=0.1)
        assert np.allclose(fore, upper[0], atol=0.1)


def test_no_stroke_has_a_fault_or_looks_like_a_sign_of_divers(palette: Language) -> None:
    report = check_health(palette, known_signs=Language.load(known_signs_file()))
    assert [each.message for each in report.findings] == []
    nearest = measure_confusions(palette).list_pairs()[0]
    assert nearest.distance > 0.5
