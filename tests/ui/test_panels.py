"""Panels of the inspector: the curves beside the scene."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from app.recognition.triggers.trigger import SALUTE
from app.ui.panels import draw_trigger
from app.ui.workspace import Range
from tests.posed import BY_BELLY, posed_language, posed_recording
from tests.ui.views import view_in


def test_the_curve_is_that_of_the_languages_trigger(tmp_path: Path) -> None:
    posed = posed_recording("circle-by-belly")
    view = replace(view_in(tmp_path), recording=posed, start=None, end=None)
    assert view.trigger == SALUTE
    assert Range.of(view).held.max() < 0.5
    by_arms = replace(view, language=posed_language())
    assert by_arms.trigger == BY_BELLY
    shown = Range.of(by_arms)
    assert shown.held.max() > 0.9
    assert "Pose of the arms, confidence" in draw_trigger(shown.poses.time, shown.held, BY_BELLY)
    assert "Vulcan salute, confidence" in draw_trigger(shown.poses.time, shown.held, SALUTE)
