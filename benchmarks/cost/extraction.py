"""Extraction: time of all code around the pose models.

A whole-clip extraction (decode, pose, hands, salute) is compared with a bare loop that feeds the
very same tensors to the very same models and does nothing else. 1.00 would mean that decoding,
cropping, tracking and the salute test are free.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
import onnxruntime  # type: ignore[import-untyped]

from app.recognition import record
from app.recognition.estimation import create_estimator
from app.resources import samples_dir

ROUNDS = 5
"""Pairs of runs; the median of their ratios is reported, since other programs may run too."""


@dataclass(frozen=True, eq=False)
class ModelCall:
    """One run of one model: the session, the requested outputs, a copy of its inputs."""

    session: Any
    outputs: list[str]
    feed: dict[str, Any]


@contextmanager
def recorded_calls() -> Iterator[list[ModelCall]]:
    """Record every model run inside the context."""
    original = onnxruntime.InferenceSession.run
    calls: list[ModelCall] = []

    def run(session: Any, outputs: list[str], feed: dict[str, Any], *rest: Any) -> Any:
        copies = {name: np.copy(tensor) for name, tensor in feed.items()}
        calls.append(ModelCall(session, outputs, copies))
        return original(session, outputs, feed, *rest)

    onnxruntime.InferenceSession.run = run
    try:
        yield calls
    finally:
        onnxruntime.InferenceSession.run = original


def main() -> None:
    """Print the ratio for one sample clip."""
    clip = samples_dir() / "clips" / "circle-demonstration.mp4"
    with closing(create_estimator()) as estimator:
        with recorded_calls() as calls:
            frames = len(record(clip, estimator=estimator).poses)
        ratios = []
        for _ in range(ROUNDS):
            start = perf_counter()
            for call in calls:
                call.session.run(call.outputs, call.feed)
            middle = perf_counter()
            record(clip, estimator=estimator)
            ratios.append((middle - start) / (perf_counter() - middle))
    print(
        f"extraction / bare loop over the same models: {median(ratios):.2f} of its speed "
        f"({min(ratios):.2f} to {max(ratios):.2f}, {ROUNDS} pairs, {frames} frames, "
        f"{len(calls)} model runs)"
    )
