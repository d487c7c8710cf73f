"""Models of variation: all give takes comparable with ours."""

from typing import get_args

import numpy as np
import pytest

from app.recognition.poses.trajectory import Trajectory
from app.recognition.simulation.variation import Person
from benchmarks.sets.one_shot_draws import demonstrated
from benchmarks.sets.recorded_sets import RecordedSet
from benchmarks.simulation.take_comparison import FEATURES, TakeComparison, demonstration_of
from benchmarks.simulation.variation_models import MODELS, scaled


@pytest.fixture
def comparison(drawn: dict[str, RecordedSet]) -> TakeComparison:
    return TakeComparison(demonstrated(drawn["circles"], [0])[0])


def path_distances(comparison: TakeComparison, takes: tuple[Trajectory, ...]) -> list[float]:
    return [comparison.features(take)[FEATURES.index("path")] for take in takes]


@pytest.mark.parametrize("person", get_args(Person))
@pytest.mark.parametrize("name", MODELS)
def test_every_model_varies_a_demonstration_and_leaves_it_comparable(
    comparison: TakeComparison, name: str, person: Person
) -> None:
    shown = comparison.demonstration
    takes = MODELS[name](shown, 4, 1, person)
    assert [take.landmarks for take in takes] == [shown.landmarks] * 4
    assert all(np.isfinite(take.xy).all() and (np.diff(take.time) > 0).all() for take in takes)
    assert 0 < min(path_distances(comparison, takes)) < max(path_distances(comparison, takes)) < 1


def test_a_larger_scale_varies_more(comparison: TakeComparison) -> None:
    shown = comparison.demonstration
    small, large = (scaled(factor)(shown, 10, 1, "same") for factor in (0.5, 2.0))
    assert np.median(path_distances(comparison, small)) < 0.6 * np.median(
        path_distances(comparison, large)
    )


def test_the_demonstration_itself_lies_at_no_distance(
    drawn: dict[str, RecordedSet], comparison: TakeComparison
) -> None:
    gesture = demonstrated(drawn["circles"], [0])[0]
    away = comparison.features(demonstration_of(gesture))
    np.testing.assert_allclose(
        away[[FEATURES.index("path"), FEATURES.index("score")]], 0, atol=1e-9
    )
