"""The public surface: exactly the documented names."""

import app.recognition

PROMISED = {
    "EstimatorError",
    "Gesture",
    "GestureError",
    "Language",
    "LanguageError",
    "ModelError",
    "OsgError",
    "PhraseParser",
    "PoseError",
    "PoseSequence",
    "Recognition",
    "RecognitionContext",
    "RecognitionError",
    "Recognizer",
    "Recording",
    "Spotter",
    "Take",
    "Tuning",
    "VideoError",
    "check_health",
    "create_estimator",
    "draw_variants",
    "explain",
    "extract_poses",
    "find_ambiguities",
    "find_takes",
    "record",
    "takes_in",
}


def test_the_public_names_are_the_promised_ones_in_order() -> None:
    assert app.recognition.__all__ == sorted(PROMISED)


def test_every_public_name_is_there_and_documented() -> None:
    for name in app.recognition.__all__:
        assert getattr(app.recognition, name).__doc__
