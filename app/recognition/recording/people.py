"""People: whose body counts where several are seen.

The body belongs to the hand that salutes: the person is chosen over the whole recording, take by
take. Where nobody salutes, it is the person who stands out most. `live_segmentation` chooses where
the future is not known.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.estimation.landmark_models.arms import find_owner
from app.recognition.estimation.person_tracker import (
    PATIENCE_SECONDS,
    PeopleTracks,
    find_boxes,
    measure_prominence,
)
from app.recognition.poses.frame import FrameLandmarks, Hand
from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.salute import (
    LONGEST_TAKE,
    SHORTEST_TAKE,
    HeldTrigger,
    best_salute,
)

TOGETHER_SECONDS: Final = PATIENCE_SECONDS
"""Seconds that several people must be seen at once for a choice; for less, one of them is an error
of the detector."""

STILL: Final = 0.1
"""Movement, in sizes of the body, that a person who keeps still counts with: more than the jitter
of keypoints, less than any gesture."""

_NUMBERS: Final = {2: "two", 3: "three", 4: "four"}


@dataclass(frozen=True, eq=False)
class SeenPerson:
    """One person in one frame.

    Attributes
    ----------
    xy
        ``(K, 2)`` keypoints, one of them at least seen; NaN: not seen.
    score
        Confidence in [0, 1] that it is a person.
    salute
        Score in [0, 1] of the better of this person's hands (`best_salute`).

    """

    xy: FloatArray
    score: float
    salute: float = 0.0


@dataclass(frozen=True, eq=False)
class Choice:
    """Whose body counts in each of T frames.

    Attributes
    ----------
    index
        T positions among the people of the frame; None where the chosen one is not seen.
    salute
        ``(T,)`` in [0, 1]: salute score of the chosen person.
    count
        ``(T,)`` number of people seen.
    notes
        Sentences for the user about the choice; none where one person is seen.

    """

    index: tuple[int | None, ...]
    salute: FloatArray
    count: npt.NDArray[np.int64]
    notes: tuple[str, ...]


@dataclass(frozen=True)
class _Salutes:
    """What one person's held salutes enclose: a take, or, of a single one, nothing."""

    track: int
    start: float
    end: float


class People:
    """The people of a whole recording, frame by frame; memory grows with those seen."""

    def __init__(self) -> None:
        self._tracks = PeopleTracks()
        self._time: list[float] = []
        self._seen: list[tuple[SeenPerson, ...]] = []
        self._who: list[tuple[int, ...]] = []
        self._joined: list[tuple[int, ...]] = []
        self._stray: list[float] = []

    def add(self, time: float, people: Sequence[SeenPerson], stray: float = 0.0) -> None:
        """Add the next frame.

        Parameters
        ----------
        time
            Seconds, later than in every call before.
        people
            Everybody in the frame, in any order.
        stray
            Salute score in [0, 1] of the hands that belong to none of them.

        """
        self._time.append(time)
        self._seen.append(tuple(people))
        self._who.append(self._tracks.assign([person.xy for person in people], time))
        if (mixed := self._tracks.exchanged) is not None:
            for row in range(len(self._time) - 2, -1, -1):
                if self._time[row] < mixed.since:
                    break
                self._who[row] = tuple(
                    mixed.new if track == mixed.track else track for track in self._who[row]
                )
        self._stray.append(stray)

    def choose(self) -> Choice:
        """Choose whose body counts, over all frames so far."""
        self._join_tracks()
        count = np.array([len(people) for people in self._seen], dtype=np.int64)
        tracks = sorted({track for who in self._joined for track in who})
        marks, notes = list[_Salutes](), list[str]()
        if len(tracks) > 1:
            marks, notes = self._find_marks({track: self._find_held(track) for track in tracks})
        if not marks and tracks:
            always = [_Salutes(track, -np.inf, np.inf) for track in tracks]
            marks = [max(always, key=self._measure_prominence)]
            notes = ["the body is that of the person who stands out most"]
        index, salute = [], []
        for time, who, people, stray in zip(
            self._time, self._joined, self._seen, self._stray, strict=True
        ):
            owner = _find_owner_at(marks, time)
            index.append(who.index(owner) if owner in who else None)
            own = people[who.index(owner)].salute if owner in who else 0.0
            salute.append(max(own, stray))
        number = self._count_together(count)
        if number < 2:
            return Choice(tuple(index), np.array(salute), np.minimum(count, 1), ())
        seen = f"{_NUMBERS.get(number, number)} people are seen"
        return Choice(
            tuple(index), np.array(salute), count, tuple(f"{seen}; {note}" for note in notes)
        )

    def _join_tracks(self) -> None:
        """Join tracks that are never seen together.

        They are of one person who was lost, or of people who follow each other, whose takes the
        salutes tell apart.
        """
        together = {frozenset(pair) for who in self._who for pair in combinations(who, 2)}
        people: list[list[int]] = []
        names: dict[int, int] = {}
        for track in sorted({track for who in self._who for track in who}):
            free = [
                one
                for one in reversed(people)
                if not any(frozenset((track, other)) in together for other in one)
            ]
            joined = free[0] if free else []
            if not free:
                people.append(joined)
            joined.append(track)
            names[track] = joined[0]
        self._joined = [tuple(names[track] for track in who) for who in self._who]

    def _count_together(self, count: npt.NDArray[np.int64]) -> int:
        """Return how many people are seen at once, for a while or in most frames."""
        steps = np.append(np.diff(self._time), 0.0)
        return next(
            number
            for number in range(int(count.max(initial=0)), -1, -1)
            if number < 2
            or steps[count >= number].sum() >= TOGETHER_SECONDS
            or 2 * np.count_nonzero(count >= number) > len(count)
        )

    def _find_held(self, track: int) -> list[tuple[float, float]]:
        """Return when a person's held salutes begin and end; short interruptions do not count."""
        scores = [
            people[who.index(track)].salute if track in who else 0.0
            for who, people in zip(self._joined, self._seen, strict=True)
        ]
        trigger, held = HeldTrigger(), list[tuple[float, float]]()
        for time, score in zip(self._time, scores, strict=True):
            if not trigger.update(time, score):
                continue
            since, until = trigger.since, trigger.until
            assert since is not None
            assert until is not None
            if held and since - held[-1][1] < SHORTEST_TAKE:
                since = held.pop()[0]
            held.append((since, until))
        return held

    def _find_marks(
        self, held: dict[int, list[tuple[float, float]]]
    ) -> tuple[list[_Salutes], list[str]]:
        """Return who salutes when, in order of time, and what to say of it.

        A take is enclosed by two salutes of one person. Where takes of two people overlap, the one
        who moves more and is nearer counts. Single salutes count where no take is near.
        """
        takes = [
            _Salutes(track, first[0], last[1])
            for track, spans in held.items()
            for first, last in zip(spans[::2], spans[1::2], strict=False)
            if last[0] - first[1] <= LONGEST_TAKE
        ]
        enclosed = {(take.track, time) for take in takes for time in (take.start, take.end)}
        single = [
            _Salutes(track, start, end)
            for track, spans in held.items()
            for start, end in spans
            if not {(track, start), (track, end)} & enclosed
        ]
        kept = self._keep_apart(takes)
        last = max((take.end for take in kept), default=-np.inf)
        marks = sorted(
            [*kept, *self._keep_apart([each for each in single if each.start > last])],
            key=lambda mark: mark.start,
        )
        return marks, _describe(marks, kept, [each for each in single if each not in marks])

    def _keep_apart(self, marks: list[_Salutes]) -> list[_Salutes]:
        """Return marks that do not overlap, the most prominent ones first."""
        kept: list[_Salutes] = []
        for mark in sorted(marks, key=lambda mark: -self._measure_prominence(mark)):
            if all(mark.end < other.start or other.end < mark.start for other in kept):
                kept.append(mark)
        return kept

    def _measure_prominence(self, mark: _Salutes) -> float:
        """Return the prominence of a person between two moments, for each frame between them."""
        rows = [row for row, time in enumerate(self._time) if mark.start <= time <= mark.end]
        seen = [
            self._seen[row][self._joined[row].index(mark.track)]
            for row in rows
            if mark.track in self._joined[row]
        ]
        if not seen:
            return 0.0
        xy = np.stack([person.xy for person in seen])
        scores = np.array([person.score for person in seen])
        return prominence_over(xy, np.broadcast_to(scores[:, None], xy.shape[:2])) / len(rows)


def prominence_over(xy: FloatArray, confidence: FloatArray | None = None) -> float:
    """Return the prominence of one person over T frames.

    It is the area of the box around the seen keypoints, times the mean confidence, summed over the
    frames, times the way that the keypoint with the largest movement covers within the body:
    highest for a person who is near, well seen, long in view and gestures.

    Parameters
    ----------
    xy
        ``(T, K, 2)``; NaN: not seen.
    confidence
        ``(T, K)`` in [0, 1], or None.

    """
    seen = np.asarray(np.isfinite(xy).all(axis=2))
    frames = seen.any(axis=1)
    if not frames.any():
        return 0.0
    belief = np.where(seen, 1.0 if confidence is None else confidence, 0.0).mean(axis=1)
    boxes = find_boxes(xy[frames])
    size = float(np.median(np.linalg.norm(boxes[:, 1] - boxes[:, 0], axis=1)))
    moved = _measure_movement(xy[frames]) / size if size > 0 else 0.0
    return float(measure_prominence(boxes, belief[frames]).sum()) * (STILL + min(moved, 1.0))


def split_hands(found: FrameLandmarks) -> tuple[tuple[tuple[Hand, ...], ...], tuple[Hand, ...]]:
    """Return the hands of each body in a frame, and those that belong to none."""
    owners = [find_owner(hand, found.bodies) for hand in found.hands]

    def list_hands(place: int | None) -> tuple[Hand, ...]:
        return tuple(hand for hand, of in zip(found.hands, owners, strict=True) if of == place)

    return tuple(map(list_hands, range(len(found.bodies)))), list_hands(None)


def keep_person(found: FrameLandmarks, place: int | None) -> FrameLandmarks:
    """Return a frame with one of its bodies, the hands of that body and those of nobody.

    Parameters
    ----------
    found
        The frame.
    place
        Position among its bodies; None: the person is not seen.

    """
    bodies = found.bodies
    if len(bodies) < 2 and (place is not None or not bodies):
        return found
    shared, stray = split_hands(found)
    own = () if place is None else shared[place]
    hands = tuple(sorted((*own, *stray), key=lambda hand: -hand.size))
    return FrameLandmarks(
        None if place is None else bodies[place],
        hands,
        tuple(body for each, body in enumerate(bodies) if each != place),
    )


def see_people(found: FrameLandmarks) -> tuple[tuple[SeenPerson, ...], float]:
    """Return the people of a frame with their salutes, and the salute of nobody's hands."""
    shared, stray = split_hands(found)
    # An infinite place, as a user's own model may give, is not seen either.
    people = tuple(
        SeenPerson(np.where(np.isfinite(body.xy), body.xy, np.nan), body.score, best_salute(hands))
        for body, hands in zip(found.bodies, shared, strict=True)
    )
    return people, best_salute(stray)


def _describe(marks: list[_Salutes], takes: list[_Salutes], left_out: list[_Salutes]) -> list[str]:
    """Say whose body is taken."""
    if not marks:
        return []
    tracks = {mark.track for mark in marks}
    if len(tracks) == 1:
        notes = ["the body is that of the diver who salutes"]
    elif len(takes) == len(marks):
        notes = ["more than one salutes; the body of each take is that of the diver who begins it"]
    else:
        first, second = next(
            (one, other) for one, other in pairwise(marks) if one.track != other.track
        )
        notes = [
            f"the salutes at {first.start:.1f} s and {second.start:.1f} s are of different divers; "
            "the body is that of the one who salutes first"
        ]
    if left_out:
        times = ", ".join(f"{each.start:.1f}" for each in sorted(left_out, key=lambda m: m.start))
        notes.append(f"another diver's salute at {times} s is left out")
    return notes


def _find_owner_at(marks: Sequence[_Salutes], time: float) -> int:
    """Return the track whose body counts: of the last one who has saluted, or else the first."""
    begun = [mark.track for mark in marks if mark.start <= time]
    return begun[-1] if begun else marks[0].track if marks else -1


def _measure_movement(xy: FloatArray) -> float:
    """Return the way in pixels across which the most mobile keypoint moves within the body."""
    seen = np.isfinite(xy).all(axis=2)
    often = seen.mean(axis=0) >= 0.5
    if len(xy) < 2 or not often.any():
        return 0.0
    within = xy[:, often] - np.nanmedian(xy[:, often], axis=1, keepdims=True)
    low, high = np.nanpercentile(within, (10, 90), axis=0)
    return float(np.linalg.norm(high - low, axis=1).max())
