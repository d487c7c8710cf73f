"""Clips: what the pacing of the models saves, and what reading a clip costs beside the models.

`pace`: each clip is read twice, with every hand and body looked at in every frame, and as often as
they change (`arms.ArmPace`, `body.REST_SECONDS`). `bare`: a whole reading (decode, pose, hands,
salute) beside a loop that feeds the same tensors to the same models and does nothing else.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, closing
from functools import partial
from pathlib import Path
from time import perf_counter, process_time
from typing import Any
from unittest.mock import patch

import numpy as np
import onnxruntime  # type: ignore[import-untyped]

from app.recognition import Language, Recognizer, Recording, record, takes_in
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import create_estimator
from app.recognition.estimation.landmark_models import arms, body
from app.resources import samples_dir
from benchmarks.figures import Figure, Measurement, ratio, share

CLIPS = samples_dir() / "clips"

PAUSES = (
    (arms, "HELD_SECONDS"),
    (arms, "MOVING_SECONDS"),
    (arms, "HANGING_SECONDS"),
    (arms, "UNSEEN_SECONDS"),
    (body, "REST_SECONDS"),
)


def read_clip(clip: Path, estimator: PoseEstimator) -> tuple[Recording, float, float]:
    """Read a clip; return the recording, and seconds of processor and clock."""
    processor, wall = process_time(), perf_counter()
    recording = record(clip, estimator=estimator)
    return recording, process_time() - processor, perf_counter() - wall


def compare_paces(clips: list[Path], quick: bool) -> Iterator[Figure]:
    """Compare the two readings of clips: their time, and the labels of their takes."""
    recognizer = Recognizer(Language.load(samples_dir() / "osg-table-2.json"))
    processor, wall, same = [], [], []
    with closing(create_estimator()) as estimator:
        for clip in clips[: 1 if quick else None]:
            with ExitStack() as every_frame:
                for module, name in PAUSES:
                    every_frame.enter_context(patch.object(module, name, 0.0))
                full = read_clip(clip, estimator)
            paced = read_clip(clip, estimator)
            one, other = (
                [recognizer.recognize(take.poses).label for take in takes_in(each)]
                for each in (full[0], paced[0])
            )
            same.append(one == other)
            processor.append(paced[1] / full[1])
            wall.append(paced[2] / full[2])
    yield ratio("processor", processor)
    yield ratio("wall", wall)
    yield share("same-labels", sum(same), len(same))


def compare_bare(quick: bool) -> Iterator[Figure]:
    """Compare the speed of a reading with that of a bare loop over the models, one sample clip."""
    clip = CLIPS / "circle-demonstration.mp4"
    original = onnxruntime.InferenceSession.run
    calls: list[tuple[Any, list[str], dict[str, Any]]] = []

    def run(session: Any, outputs: list[str], feed: dict[str, Any], *rest: Any) -> Any:
        calls.append((session, outputs, {name: np.copy(each) for name, each in feed.items()}))
        return original(session, outputs, feed, *rest)

    ratios = []
    with closing(create_estimator()) as estimator:
        with patch.object(onnxruntime.InferenceSession, "run", run):
            record(clip, estimator=estimator)
        for _ in range(1 if quick else 5):
            start = perf_counter()
            for session, outputs, feed in calls:
                session.run(outputs, feed)
            middle = perf_counter()
            record(clip, estimator=estimator)
            ratios.append((middle - start) / (perf_counter() - middle))
    yield ratio("speed", ratios)


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield what reading clips costs."""
    samples = sorted(CLIPS.glob("*-test-*.mp4"))
    real = sorted(each for each in (folder / "clips").glob("*") if each.suffix != ".csv")
    paced = "looked at as often as it changes, to every hand and body in every frame"
    yield Measurement(
        "clips/pace", partial(compare_paces, samples), "sample clips", paced, alone=True
    )
    yield Measurement(
        "clips/pace-real",
        partial(compare_paces, real),
        "real clips",
        paced,
        reads=(folder / "clips",),
        alone=True,
    )
    yield Measurement(
        "clips/bare",
        compare_bare,
        "a sample clip",
        "speed of a reading, to a bare loop over the same models, pairs of runs",
        alone=True,
    )
