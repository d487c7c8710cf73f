"""Health check: what a language's own demonstrations tell about it before the dive.

`check_health` makes the report. Its parts are

- findings about single demonstrations, duplicates and forecasts (`find_forecast_findings`),
- a map of the gestures in the plane, similar ones close together (`embed_gestures`),
- gestures that look like a sign which divers already know with another meaning
  (`find_known_signs`), and
- angles from where a gesture looks like another one, or is not seen to move (`find_blind_angles`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import count
from typing import Final

import numpy as np

from app.recognition.decision.result import Recognition
from app.recognition.errors import PoseError
from app.recognition.explanation.causes import ALIKE
from app.recognition.features.trajectory_image import draw_hands
from app.recognition.gestures.demonstration import condense
from app.recognition.gestures.profile import PROFILES
from app.recognition.health.finding import (
    DUPLICATE,
    Finding,
    check_demonstration,
    measure_visible_share,
)
from app.recognition.health.forecast import Forecast, make_forecast, measure_curve
from app.recognition.health.phrase_ambiguity import find_ambiguities
from app.recognition.health.report import (
    GestureHealth,
    HealthReport,
    LandmarkHealth,
    LimitHealth,
    check_trigger,
    list_trigger_findings,
)
from app.recognition.language.language import Language
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.salience import measure_displacements
from app.recognition.recognizer import Recognizer
from app.recognition.text.look_alikes import are_confusable, list_look_alikes
from app.recognition.text.wording import ask_twins

MOST_MISSED = 0.5
"""Share of other people's demonstrations that are not read right from which it is an error."""

MOST_DUPLICATES = 100
"""Pairs of duplicates that are named."""

SAME = ("movement", "hand shape", "sequence of hand shapes")
"""Common property of duplicates, by the number of held hand shapes."""

Progress = Callable[[str, int, int], None]
"""Called with the stage, the steps done and their number (0: unknown); an exception that it raises
ends the check."""


def check_health(
    language: Language,
    *,
    progress: Progress = lambda _stage, _done, _total: None,
    known_signs: Language | None = None,
) -> HealthReport:
    """Check a language before the dive; the same language gives the same report.

    Parameters
    ----------
    language
        The language. Its tuning applies; the profile is always ``full``, since ``paper`` rejects
        nothing.
    progress
        Called with stage, steps done and their number; may raise to cancel.
    known_signs
        Signs that divers know, with their meaning; gestures that look like one become findings.
        None: there is no such search.

    """
    if not language.gestures:
        nothing = Finding("empty", (), "the language has no gestures yet: add one", True)
        name, revision = language.name, language.revision
        return HealthReport(
            language=name, revision=revision, forecast=Forecast(0), findings=(nothing,)
        )
    shown = sum(len(gesture.trajectories) for gesture in language.gestures)
    forecast = make_forecast(
        language, advance=_count_steps(progress, "other people's demonstrations", shown)
    )
    advance = _count_steps(progress, "numbers of people", shown * max(0, forecast.people - 2))
    forecast = replace(forecast, curve=measure_curve(language, forecast, advance=advance))
    recognizer = Recognizer(language, "full")
    compare = _count_steps(progress, "distances", len(language.gestures))
    distances = _measure_distances(recognizer, compare)
    gestures = tuple(_describe_gestures(recognizer, distances))
    findings = [
        *find_forecast_findings(language, forecast),
        *_duplicate_findings(recognizer, distances),
        *_demonstration_findings(language),
        *_twin_findings(recognizer),
        *find_blind_angles(recognizer, _count_steps(progress, "turned divers", 0)),
    ]
    if known_signs is not None:
        compare = _count_steps(progress, "known signs", len(gestures))
        findings += find_known_signs(language, known_signs, compare)
    trigger = check_trigger(language.trigger)
    findings += list_trigger_findings(language.trigger, trigger, language.gestures)
    findings += _label_findings(language.labels)
    findings += _profile_findings(language)
    if language.grammar is not None:
        findings += [each.finding() for each in find_ambiguities(language.grammar)]
    return HealthReport(
        language=language.name,
        revision=language.revision,
        forecast=forecast,
        gestures=gestures,
        findings=tuple(sorted(findings, key=lambda finding: not finding.error)),
        places=embed_gestures(distances),
        trigger=trigger,
        limit=LimitHealth.measure(recognizer),
    )


def _count_steps(progress: Progress, stage: str, total: int) -> Callable[[], None]:
    """Return a function that reports one more step of a stage; a total of 0 is unknown."""
    steps = count(1)
    return lambda: progress(stage, next(steps), total)


def _measure_distances(recognizer: Recognizer, advance: Callable[[], None]) -> FloatArray:
    """Return the fused distances of each gesture's demonstration to all gestures, ``(G, G)``.

    Infinite where they are not comparable.
    """
    gestures = recognizer.language.gestures
    distances = np.full((len(gestures), len(gestures)), np.inf)
    for index, gesture in enumerate(gestures):
        if gesture.trajectory is not None:
            distances[index] = recognizer.compare(condense(gesture.trajectory)).scores
            advance()
    return distances


def rank_others(labels: Sequence[str], distances: FloatArray, own: int) -> list[tuple[str, float]]:
    """Return the labels and distances of the other comparable gestures, the nearest first.

    Parameters
    ----------
    labels
        Of G gestures.
    distances
        ``(G,)`` of the gesture `own` to all.
    own
        Its index.

    """
    return [
        (labels[other], float(distances[other]))
        for other in np.argsort(distances, kind="stable").tolist()
        if other != own and np.isfinite(distances[other])
    ]


def _describe_gestures(recognizer: Recognizer, distances: FloatArray) -> Iterator[GestureHealth]:
    for index, gesture in enumerate(recognizer.language.gestures):
        shown = gesture.trajectory
        moved = {} if shown is None else measure_displacements(shown)
        others = rank_others(recognizer.language.labels, distances[index], index)
        yield GestureHealth(
            label=gesture.label,
            seconds=None if shown is None else float(shown.time[-1] - shown.time[0]),
            landmarks=tuple(
                LandmarkHealth(name, moved[name], measure_visible_share(shown, name))
                for name in gesture.salient
                if shown is not None
            ),
            counts=recognizer.sensitivity(gesture.label),
            nearest=others[0] if others else None,
        )


def find_forecast_findings(language: Language, forecast: Forecast) -> Iterator[Finding]:
    """Yield a finding for each gesture of which demonstrations are not read right by others'."""
    for label in language.labels:
        failed, right = forecast.failed(label), forecast.count("right", label)
        if not failed or right is None:
            continue
        wrong = [each for each in failed if each.outcome == "wrong"]
        others = dict.fromkeys(name for each in wrong for name in each.read_as if name != label)
        yield Finding(
            "misread" if wrong else "missed",
            (label, *others),
            f"{label}: {right.happened} of {right.n} demonstrations are read right by other "
            f"people's; {', '.join(each.words for each in failed)}",
            error=bool(wrong) or 1 - right.rate >= MOST_MISSED,
        )


def _duplicate_findings(recognizer: Recognizer, distances: FloatArray) -> Iterator[Finding]:
    """Yield a finding for every two gestures whose demonstrations are the same, nearest first.

    None for undecided twins, whose author is asked first.
    """
    language = recognizer.language
    shapes = [len(gesture.held_shapes) for gesture in language.gestures]
    apart = (distances + distances.T) / 2
    for pair in recognizer.vote.undecided_twins:
        apart[pair] = np.inf
    pairs = np.argwhere(np.triu(apart < DUPLICATE, 1))
    pairs = pairs[np.argsort(apart[tuple(pairs.T)], kind="stable")]
    for first, second in pairs[:MOST_DUPLICATES].tolist():
        one, other = language.labels[first], language.labels[second]
        yield Finding(
            "duplicate",
            (one, other),
            f"{one} and {other} are the same {SAME[shapes[first]]}, so the robot cannot "
            "distinguish them: change or remove one of them",
            error=True,
        )
    if (more := len(pairs) - MOST_DUPLICATES) > 0:
        yield Finding("duplicate", (), f"{more} further pairs are the same as well", error=True)


def _demonstration_findings(language: Language) -> Iterator[Finding]:
    """Yield the findings about each gesture's demonstration by itself."""
    for gesture in language.gestures:
        yield from check_demonstration(gesture, salutes=language.trigger.kind == "salute")


def _twin_findings(recognizer: Recognizer) -> Iterator[Finding]:
    """Yield the pairs that the hand shape alone tells apart, or would if that were on purpose."""
    for twins in recognizer.undecided_twins:
        shown = [recognizer.language.gesture(label).trajectory for label in twins]
        yield Finding(
            "hand_shape_undecided",
            twins,
            ask_twins(twins),
            error=True,
            drawings=tuple(draw_hands(each.moving_hands) for each in shown if each is not None),
        )
    labels = recognizer.language.labels
    for pair in sorted(recognizer.vote.shape_twins):
        first, second = (labels[index] for index in pair)
        yield Finding(
            "hand_shape_only",
            (first, second),
            f"{first} and {second} are the same movement, told apart by the hand shape alone: "
            "where the hand is not seen, the robot refuses both",
        )


def _label_findings(labels: Sequence[str]) -> Iterator[Finding]:
    for one, other in list_look_alikes(labels):
        yield Finding(
            "look_alike",
            (one, other),
            f"the labels {one} and {other} look alike, so a slate does not tell which is meant; "
            "rename one of the two gestures",
            error=are_confusable(one, other),
        )


def _profile_findings(language: Language) -> Iterator[Finding]:
    if not PROFILES[language.profile].rejects:
        message = (
            f"the language uses the profile {language.profile}, which rejects nothing, while this "
            "report is for the profile full: choose the profile full before a dive"
        )
        yield Finding("unrejecting", (), message, error=True)


def embed_gestures(distances: FloatArray) -> FloatArray:
    """Embed gestures in the plane by classical multidimensional scaling (Torgerson 1952).

    Parameters
    ----------
    distances
        ``(G, G)`` >= 0, of each gesture (row) to each other one. Both directions are averaged;
        infinite ones count as the largest finite one.

    Returns
    -------
    ``(G, 2)`` in the unit of the distances, centred at 0, the wider spread along x; the best
    approximation in two dimensions. The sign of an axis is such that its farthest gesture is
    positive, so that the same distances give the same map.

    """
    finite = np.isfinite(distances)
    far = float(distances[finite].max(initial=0.0)) or 1.0
    known = np.where(finite, distances, far)
    even = (known + known.T) / 2
    np.fill_diagonal(even, 0.0)
    count = len(even)
    centring = np.eye(count) - 1 / max(count, 1)
    values, vectors = np.linalg.eigh(-centring @ even**2 @ centring / 2)
    place = np.zeros((count, 2))
    for axis, index in enumerate(range(count - 1, max(count - 3, -1), -1)):
        along = vectors[:, index] * np.sqrt(max(float(values[index]), 0.0))
        place[:, axis] = along * (np.sign(along[np.abs(along).argmax()]) or 1.0)
    return place


def find_known_signs(
    language: Language, known: Language, advance: Callable[[], None] = lambda: None
) -> Iterator[Finding]:
    """Yield one finding for each gesture that is much like one of the known signs.

    Each demonstration is recognised by profile ``full`` among the known signs, as if it were a
    take. A gesture with the label of the sign is meant to be that sign.

    Parameters
    ----------
    language
        The language to check.
    known
        The signs that divers know, each with its meaning as description.
    advance
        Called after each gesture; an exception that it raises ends the work.

    """
    if not known.gestures:
        return
    recognizer = Recognizer(known, "full")
    meanings = {gesture.label: gesture.description for gesture in known.gestures}
    for gesture in language.gestures:
        read = [_recognize(recognizer, shown) for shown in gesture.trajectories]
        # Whether it is accepted does not matter: a pair looks like a sign too, and of gestures that
        # a language lacks every second one is accepted.
        signs = [each.nearest for each in read if each and each.nearest_novelty < ALIKE]
        own = gesture.label.casefold()
        sign = next((each for each in signs if each.casefold() != own), None)
        if sign is not None:
            meaning = f' ("{meanings[sign]}")' if meanings[sign] else ""
            yield Finding(
                "known_sign",
                (gesture.label,),
                f"{gesture.label} looks like the divers' sign {sign}{meaning}: a diver may show "
                "that sign to another one, and the robot acts on it; choose another movement, or "
                "give the gesture the sign's meaning",
            )
        advance()


def _recognize(recognizer: Recognizer, shown: Trajectory) -> Recognition | None:
    try:
        return recognizer.recognize_trajectory(condense(shown))
    except PoseError:  # no landmark that a sign needs moves
        return None


ANGLES: Final = (-60, -30, 30, 60)
"""Degrees by which the diver is turned from the demonstration, positive to the diver's own left.
Beyond, the far arm is hidden in any language."""


def find_blind_angles(
    recognizer: Recognizer, advance: Callable[[], None] = lambda: None
) -> Iterator[Finding]:
    """Yield a finding for each gesture that is another one, or lost, when the diver is turned.

    The demonstration itself is turned by its depth; gestures without depth cannot be turned.

    Parameters
    ----------
    recognizer
        Of the language, profile ``full``.
    advance
        Called after each comparison; an exception that it raises ends the work.

    """
    labels = recognizer.language.labels
    for own, gesture in enumerate(recognizer.language.gestures):
        shown = gesture.trajectory
        if shown is None or shown.facing is None or gesture.is_held:
            continue
        lost: list[int] = []
        like: dict[str, list[int]] = {}
        ahead = recognizer.compare(condense(shown)).scores
        for degrees in ANGLES:
            scores = recognizer.compare(condense(shown.turn(degrees))).scores
            advance()
            if not np.isfinite(scores[own]):
                lost.append(degrees)
            # Of gestures that are the same straight ahead, the duplicate is the finding.
            for other in np.flatnonzero((scores < DUPLICATE) & (ahead >= DUPLICATE)).tolist():
                like.setdefault(labels[other], []).append(degrees)
        if lost:
            yield _blind((gesture.label,), "is not seen to move", lost)
        for name, turns in like.items():
            yield _blind((gesture.label, name), f"is the same movement as {name}", turns)


def _blind(gestures: tuple[str, ...], what: str, turns: Sequence[int]) -> Finding:
    message = (
        f"{gestures[0]} {what} when the diver is turned by {list_turns(turns)}: face the camera, "
        "or change the gesture"
    )
    return Finding("blind_angle", gestures, message)


def list_turns(turns: Sequence[int]) -> str:
    """Return turns in words, such as ``30 or 60 degrees to the left``."""
    sides = {
        side: sorted(abs(turn) for turn in turns if (turn > 0) == (side == "left"))
        for side in ("left", "right")
    }
    if sides["left"] == sides["right"]:
        return f"{' or '.join(map(str, sides['left']))} degrees to either side"
    return " and ".join(
        f"{' or '.join(map(str, degrees))} degrees to the {side}"
        for side, degrees in sides.items()
        if degrees
    )
