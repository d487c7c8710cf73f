"""Detectors: their grids of candidates."""

from __future__ import annotations

import numpy as np
import pytest

from app.recognition.estimation.landmark_models.detector import (
    PALM_LAYOUT,
    PERSON_LAYOUT,
    DetectorLayout,
)


@pytest.mark.parametrize(("layout", "count"), [(PERSON_LAYOUT, 2254), (PALM_LAYOUT, 2016)])
def test_there_are_as_many_anchors_as_the_model_has_outputs(
    layout: DetectorLayout, count: int
) -> None:
    anchors = layout.anchors()
    assert anchors.shape == (count, 2)
    assert ((anchors > 0) & (anchors < 1)).all()


@pytest.mark.parametrize("layout", [PERSON_LAYOUT, PALM_LAYOUT])
def test_anchors_lie_evenly_around_the_middle(layout: DetectorLayout) -> None:
    np.testing.assert_allclose(layout.anchors().mean(axis=0), 0.5, atol=1e-6)


def test_anchors_run_along_rows_then_down_then_to_the_coarser_grid() -> None:
    layout = DetectorLayout(
        input_size=4, strides=(2, 4), anchors_per_cell=(1, 2), keypoints=1, lowest=0, overlap=0.3
    )
    np.testing.assert_allclose(
        layout.anchors(),
        [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75], [0.5, 0.5], [0.5, 0.5]],
    )
