"""Shared sets: accuracy on recorded and drawn trajectories, one demonstration per class.

Per draw, one template of each class comes from one person, and queries from the same person (UD,
user-dependent) or from everyone else (UI, user-independent), through the public interface:
`Gesture.from_demonstration` and `Recognizer.recognize`. For a set without people's names all
results are in the first column. Draws are random with a fixed seed, the same for every method; the
interval is Wilson's. A take that profile ``full`` rejects counts here by its nearest gesture;
`reliability` measures rejections.

    python -m benchmarks.accuracy.shared_sets ../shared/data --methods paper dtw full
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import chain

import numpy as np
import numpy.typing as npt

from app.evaluation.proportion import Share
from app.recognition import (
    Gesture,
    Language,
    PoseError,
    PoseSequence,
    Recognizer,
)
from app.recognition.gestures.profile import PROFILES
from benchmarks.arguments import set_arguments
from benchmarks.methods import new_method
from benchmarks.methods.ours import gesture_of
from benchmarks.sets.drawn_sets import drawn_sets
from benchmarks.sets.one_shot_draws import draws as drawn
from benchmarks.sets.recorded_sets import RecordedSet, recorded_sets

Answer = Callable[[PoseSequence], str | None]


def evaluate(
    recorded: RecordedSet, method: str, draws: int, queries: int, seed: int
) -> tuple[Share, Share]:
    """Score a method, user-dependent and user-independent."""
    own, others = Share(0, 0), Share(0, 0)
    for draw in drawn(recorded, draws, queries, seed):
        answer = build_answerer(recorded, draw.templates, method)
        own += _named(recorded, draw.own, answer)
        others += _named(recorded, draw.others, answer)
    return own, others


def _named(recorded: RecordedSet, queries: npt.NDArray[np.intp], answer: Answer) -> Share:
    named = [answer(recorded.recordings[query]) == recorded.labels[query] for query in queries]
    return Share(sum(named), len(named))


def build_answerer(recorded: RecordedSet, templates: list[int], method: str) -> Answer:
    """Teach a method one template per class."""
    if method not in PROFILES:
        taught = new_method(method)
        for template in templates:
            taught.add(str(recorded.labels[template]), recorded.recordings[template])
        taught.prepare()
        return taught.answer
    recognizer = Recognizer(Language(recorded.name, demonstrated(recorded, templates)), method)

    def answer(poses: PoseSequence) -> str | None:
        try:
            return recognizer.recognize(poses).nearest
        except PoseError:
            return None

    return answer


def demonstrated(recorded: RecordedSet, templates: list[int]) -> list[Gesture]:
    """Make a gesture of each template."""
    return [
        gesture_of(str(recorded.labels[template]), recorded.recordings[template])
        for template in templates
    ]


def main() -> None:
    """Print one line per set and method."""
    methods = [*PROFILES, "dtw"]
    parser = set_arguments(__doc__, draws=60, queries=30)
    parser.add_argument("--methods", nargs="+", choices=methods, default=methods)
    given = parser.parse_args()
    print(f"one template a class, share correct (95 % interval), seed {given.seed}")
    print(f"{'set':12} {'method':7} {'UD':>18} {'n':>5} {'UI':>18} {'n':>5}")
    for recorded in chain(recorded_sets(given.data / "trajectories"), drawn_sets()):
        if given.sets and recorded.name not in given.sets:
            continue
        for method in given.methods:
            own, others = evaluate(recorded, method, given.draws, given.queries, given.seed)
            print(
                f"{recorded.name:12} {method:7} {own!s:>18} {own.asked:5} "
                f"{others!s:>18} {others.asked:5}",
                flush=True,
            )


if __name__ == "__main__":
    main()
