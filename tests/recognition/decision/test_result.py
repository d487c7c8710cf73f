"""A result is plain data that cannot be changed afterwards."""

import json
from typing import Any

import numpy as np
import pytest

from app.recognition import Recognition


def result(label: str | None = "circle") -> Recognition:
    return Recognition(
        label=label,
        nearest="circle",
        confidence=0.75,
        profile="paper",
        voters=("hu", "zernike"),
        gestures=("circle", "line"),
        distances=np.array([[0.5, 2.0], [0.1, np.inf]]),
        votes={"hu": "circle", "zernike": "circle"},
        scores=np.array([0.4, np.inf]),
        novelty=np.array([0.2, np.nan]),
        novelty_by_view={"figure": np.array([0.2, np.nan]), "wrist": np.array([0.1, np.nan])},
    )


def test_a_result_becomes_plain_json_with_null_where_nothing_can_be_compared() -> None:
    text = json.dumps(result().to_dict(), allow_nan=False)
    assert json.loads(text) == {
        "profile": "paper",
        "label": "circle",
        "pair": None,
        "nearest": "circle",
        "confidence": 0.75,
        "votes": {"hu": "circle", "zernike": "circle"},
        "weights": {"hu": 0.5, "zernike": 0.5},
        "findings": [],
        "fault": None,
        "fault_kind": None,
        "unseen": [],
        "voters": ["hu", "zernike"],
        "gestures": ["circle", "line"],
        "distances": [[0.5, 2.0], [0.1, None]],
        "scores": [0.4, None],
        "novelty": [0.2, None],
        "novelty_by_view": {"figure": [0.2, None], "wrist": [0.1, None]},
        "facing": None,
        "views": [],
    }


def test_a_result_comes_back_from_its_plain_form() -> None:
    there = result(label=None).model_copy(update={"weights": {"hu": 0.0, "zernike": 1.0}})
    back = Recognition.from_dict(json.loads(json.dumps(there.to_dict())))
    assert back.to_dict() == there.to_dict()
    np.testing.assert_array_equal(back.distances, there.distances)
    assert back.counted == {"zernike": "circle"}


def test_a_record_of_an_earlier_version_weighs_all_voters_the_same() -> None:
    content = result().to_dict()
    del content["weights"]
    assert Recognition.from_dict(content).weights == {"hu": 0.5, "zernike": 0.5}


def between(*scores: float, **change: Any) -> Recognition:
    there = result(label=None).model_copy(
        update={"scores": np.array(scores), "novelty": np.full(len(scores), 0.5)}
    )
    gestures = ("circle", "line", "wedge")[: len(scores)]
    return there.model_copy(update={"gestures": gestures, **change})


@pytest.mark.parametrize(
    ("answer", "outcome"),
    [
        (result(), "recognized"),
        (between(1.0, 1.1, pair=("circle", "line")), "pair"),
        (result(label=None), "rejected"),
    ],
)
def test_one_property_says_what_the_outcome_is(answer: Recognition, outcome: str) -> None:
    assert answer.outcome == outcome
    assert Recognition.from_dict(json.loads(json.dumps(answer.to_dict()))).outcome == outcome


def test_a_pair_comes_back_from_its_plain_form_and_earlier_records_have_none() -> None:
    content = between(1.0, 1.1, pair=("circle", "line")).to_dict()
    assert content["pair"] == ["circle", "line"]
    assert Recognition.from_dict(content).pair == ("circle", "line")
    del content["pair"]
    assert Recognition.from_dict(content).pair is None


def test_a_rejection_between_three_gestures_names_them() -> None:
    assert between(1.1, 1.0, 1.05).between == ("line", "wedge", "circle")
    assert between(1.1, 1.0, 1.05, fault="no hand is seen").between == ()
    assert between(1.0, 1.1, 9.0, pair=("circle", "line")).between == ("circle", "line")
    assert result().between == ()
    far = between(1.1, 1.0, 1.05, novelty=np.full(3, 1.5))
    assert far.between == ()


def test_the_distances_of_a_result_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="read-only"):
        result().distances[0, 0] = 9.0


@pytest.mark.parametrize(
    ("scores", "margin"),
    [([0.4, 1.0], 0.6), ([0.4, np.inf], np.inf), ([1.0, 0.4], -0.6), ([], np.nan)],
)
def test_the_margin_is_to_the_nearest_other_gesture(scores: list[float], margin: float) -> None:
    scored = result().model_copy(update={"scores": np.array(scores)})
    assert scored.margin == pytest.approx(margin, nan_ok=True)
