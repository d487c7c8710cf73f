"""Body tracker: finds people with the person detector, then tracks them from frame to frame.

Its smoothing filters, `OneEuroFilter` and `ExponentialFilter`, remove the jitter of landmarks over
time.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from app.recognition.estimation.landmark_models.body_model import (
    LEAST_PRESENCE,
    MARGIN,
    TORSO,
    WEAK_SCORE,
    BodyModel,
    BodySearch,
    SeenBody,
)
from app.recognition.estimation.landmark_models.detector import LEAST_SCORE, Detector
from app.recognition.estimation.landmark_models.region import Region
from app.recognition.poses.frame import SIDES, Body, FrameLandmarks, Image
from app.recognition.poses.landmarks import POSE_LANDMARKS, WRISTS
from app.recognition.poses.sequence import FloatArray


@dataclass
class _Memory:
    """State of the one-euro filter between two calls."""

    time: float
    raw: FloatArray
    filtered: FloatArray
    speed: FloatArray


class OneEuroFilter:
    """The one-euro filter (Casiez, Roussel, Vogel 2012): a low pass that opens with speed.

    Each value is smoothed with a cutoff of ``minimum_cutoff + beta * |speed|``: strongly at
    rest, where jitter is seen, hardly in motion, where lag is seen. The speed itself is the
    low-passed difference of the raw values. Every element of the array is its own signal.

    Parameters
    ----------
    minimum_cutoff
        Hz, the cutoff at rest.
    beta
        Growth of the cutoff in Hz per unit of scaled speed (``values * scale`` per second).
    speed_cutoff
        Hz, the cutoff of the speed's own low pass. One, as in the paper.

    """

    def __init__(self, minimum_cutoff: float, beta: float, speed_cutoff: float = 1.0) -> None:
        self._minimum_cutoff = minimum_cutoff
        self._beta = beta
        self._speed_cutoff = speed_cutoff
        self._memory: _Memory | None = None

    def apply(self, values: FloatArray, time: float, scale: float = 1.0) -> FloatArray:
        """Smooth the next values of the signal.

        Parameters
        ----------
        values
            Array of any shape, the same in every call.
        time
            Seconds. A time not after the previous one restarts the filter, since there is no
            speed.
        scale
            Factor on speeds before `beta`: one over the object's size makes the filter independent
            of the distance. Filtering ``k * values`` with ``scale / k`` gives ``k`` times the
            result.

        Returns
        -------
        The filtered values, a new array.

        """
        memory = self._memory
        if memory is None or not time > memory.time:
            self._memory = _Memory(time, values.copy(), values.copy(), np.zeros_like(values))
            return values.copy()
        step = time - memory.time
        speed = (values - memory.raw) * (scale / step)
        memory.speed += _weight(self._speed_cutoff, step) * (speed - memory.speed)
        cutoff = self._minimum_cutoff + self._beta * np.abs(memory.speed)
        weight = 1 / (1 + 1 / (2 * math.pi * step * cutoff))
        filtered = memory.filtered + weight * (values - memory.filtered)
        memory.time, memory.raw, memory.filtered = time, values.copy(), filtered
        return filtered.copy()


class ExponentialFilter:
    """Exponential smoothing: each result is `weight` of the new and the rest of the old value."""

    def __init__(self, weight: float) -> None:
        self._weight = weight
        self._filtered: FloatArray | None = None

    def apply(self, values: FloatArray) -> FloatArray:
        """Smooth the next values (any shape, the same in every call); return a new array."""
        old = values if self._filtered is None else self._filtered
        self._filtered = old + self._weight * (values - old)
        return self._filtered.copy()


def _weight(cutoff: float, step: float) -> float:
    """Return the weight of a new value in a first-order low pass of `cutoff` Hz, `step` seconds."""
    return 1 / (1 + 1 / (2 * math.pi * cutoff * step))


SEARCH_PAUSE: Final = 10
"""Consecutive frames without a person before another search; the first frame is searched at once.
The detector finds most people within these frames, and they are tracked from then on. A search
costs as much as five detections, so frames without a person cost half as much again, and others no
more."""

MOST_PEOPLE: Final = 3
"""Most people tracked at once: a diver, a buddy and somebody who passes. Each beyond the first
costs a run of the body model per frame."""

WATCH_PAUSE: Final = 25
"""Frames between two looks for further people, a second. A look costs less than half a frame, so
while one person is seen all of them cost a sixtieth. Each is at one part of the image
(`_list_parts`): in the whole of it the detector often sees one person of two."""

FIRST_PAUSE: Final = 8
FIRST_FRAMES: Final = 100
"""The same in the first frames, four seconds, in which divers take their places: a salute is held
for longer than both parts of an image take."""

HURRIED_PAUSE: Final = 5
"""The same while a hand is seen that belongs to nobody, and after somebody was lost: a salute is
held for three such pauses."""

HURRY: Final = 75
"""Frames for which somebody who was lost is looked for, three seconds: who swims past hides a diver
for less."""

REST_SECONDS: Final = 0.06
"""Least seconds between two looks at a person who keeps still: every second frame of a camera."""

STILL: Final = 0.5
"""Speed of the fastest joint of a person who keeps still, at most, in torso sizes a second: what
the model's result varies by without any movement."""

STILL_SECONDS: Final = 0.3
"""Time for which a person has kept still by then: the model's regions and results have settled."""

SAME_TORSO: Final = 0.5
"""Mean distance of two torsos' corners, in the larger torso's size, below which two results show
one person: two people so near hide each other."""

SAME_REGION: Final = 0.2
"""Distance of the hips in a detection from those of a tracked person, in sides of the larger
region, below which no look is needed to know who it is: the detector errs by 0.07 to 0.22, and two
people beside each other are at least 0.23 apart."""

VISIBILITY_WEIGHT: Final = 0.1
"""Weight of a new visibility in MediaPipe's smoothing, which lags by about ten frames."""

_WRISTS: Final = [POSE_LANDMARKS.index(name) for name in WRISTS]

_ARMS: Final = [
    POSE_LANDMARKS.index(f"{side}_{joint}")
    for side in SIDES
    for joint in ("shoulder", "elbow", "wrist")
]


@dataclass(eq=False)
class _Person:
    """A person who is tracked: the newest result, and the filters of the landmarks."""

    seen: SeenBody
    position: OneEuroFilter = field(
        default_factory=lambda: OneEuroFilter(minimum_cutoff=0.05, beta=80.0)
    )
    visibility: ExponentialFilter = field(
        default_factory=lambda: ExponentialFilter(VISIBILITY_WEIGHT)
    )

    looked: float = -math.inf
    moved: float = math.inf

    def rests(self, time: float) -> bool:
        """Return whether nothing has to be looked at in a frame taken at `time` seconds."""
        return 0 < time - self.looked < REST_SECONDS and time - self.moved > STILL_SECONDS

    def note(self, seen: SeenBody, time: float) -> None:
        """Note a new result, and whether a joint of the arms has moved since the last one."""
        far = np.linalg.norm(seen.xy[_ARMS] - self.seen.xy[_ARMS], axis=1).max()
        if not 0 <= far < STILL * _measure_torso(seen) * (time - self.looked) < math.inf:
            self.moved = time
        self.looked = time

    def smooth(self, time: float) -> Body:
        """Return the newest result, smoothed."""
        seen = self.seen
        return Body(
            xy=self.position.apply(seen.xy, time, scale=1 / seen.following.side),
            visibility=self.visibility.apply(seen.visibility),
            score=seen.score,
            world=seen.world,
        )


class BodyTracker:
    """Tracks the people in the frames of a clip, a `BodyFinder`; the one found first is followed.

    Detection runs on frames where no body is tracked; where it finds nobody in the first frame, or
    in `SEARCH_PAUSE` frames in a row, a `BodySearch` follows. The landmarks of a frame give the
    region of the next (Bazarevsky et al. 2020, BlazePose). Their cutoffs are MediaPipe's: 0.05 Hz
    at rest (weight about 0.01 at 30 frames a second), opening to a weight of about 0.94 when a
    landmark moves fast against the size of the body. Every `WATCH_PAUSE` frames the detector looks
    for further people.

    Parameters
    ----------
    detector
        Finds persons.
    model
        The pose landmark model.
    searches
        Whether a search follows, and further people are tracked; MediaPipe's own library does
        neither.

    """

    def __init__(self, detector: Detector, model: BodyModel, *, searches: bool = True) -> None:
        self._detector = detector
        self._model = model
        self._search = BodySearch(detector, model) if searches else None
        self.reset()

    def reset(self) -> None:
        """Reset the tracking; the next frame is the first."""
        self._people: list[_Person] = []
        self._until_search = 1
        self._since_watch = 0
        self._watches = 0
        self._frames = 0
        self._hurry = 0
        self._sought: FloatArray | None = None

    def examine(self, image: Image) -> FrameLandmarks:
        """Return the body in `image` alone, searched at once; tracking is left as it is."""
        seen = self._detect(image)
        if seen is None and self._search:
            seen = self._search.find(image)
        body = Body(seen.xy, seen.visibility, seen.score, seen.world) if seen else None
        return FrameLandmarks(body, ())

    def track(self, image: Image, time: float) -> FrameLandmarks:
        """Return the bodies in `image`, taken at `time` seconds."""
        followed = self._follow(image, time)
        lost = 0 < len(followed) < len(self._people)
        self._hurry = HURRY if lost else max(0, self._hurry - 1)
        # As in MediaPipe, the frame in which everybody is lost is not searched.
        if not self._people and (found := self._find(image)) is not None:
            followed.append(_Person(found))
        self._people = followed
        if followed:
            self._until_search = SEARCH_PAUSE
            self._watch(image)
        bodies = tuple(person.smooth(time) for person in self._people)
        return FrameLandmarks(bodies[0] if bodies else None, (), bodies[1:])

    def seek(self, wrist: FloatArray | None) -> None:
        """Look soon for the person of a hand that belongs to nobody.

        Parameters
        ----------
        wrist
            ``(2,)`` pixels of the hand's wrist; None where there is no such hand.

        """
        self._sought = wrist

    def _follow(self, image: Image, time: float) -> list[_Person]:
        """Return the people who are still seen; who keeps still is looked at in every second frame.

        Where two results show one person, the track that came there by a jump is lost.
        """
        moved: list[tuple[float, int, SeenBody]] = []
        for place, person in enumerate(self._people):
            if self._search is not None and person.rests(time):
                moved.append((0.0, place, person.seen))
                continue
            seen = self._look(image, person.seen.following)
            if seen is not None:
                person.note(seen, time)
                moved.append((_measure_distance(person.seen, seen), place, seen))
        kept: dict[int, SeenBody] = {}
        for _, place, seen in sorted(moved, key=lambda one: one[0]):
            if not _is_among(seen, kept.values()):
                kept[place] = seen
        for place, seen in kept.items():
            self._people[place].seen = seen
        return [person for place, person in enumerate(self._people) if place in kept]

    def _look(self, image: Image, region: Region) -> SeenBody | None:
        seen = self._model.look(image, region)
        return seen if seen.believed else None

    def _find(self, image: Image) -> SeenBody | None:
        seen = self._detect(image)
        if seen is not None or self._search is None:
            return seen
        self._until_search -= 1
        if self._until_search > 0:
            return None
        self._until_search = SEARCH_PAUSE
        return self._search.find(image)

    def _detect(self, image: Image) -> SeenBody | None:
        for person in self._detector.detect(image)[:1]:
            region = Region.aligned(person.keypoints[0], person.keypoints[1], MARGIN)
            return self._look(image, region) if region.usable else None
        return None

    def _watch(self, image: Image) -> None:
        """Track further people, where it is time to look for them."""
        self._since_watch += 1
        parts = _list_parts(image)
        hurried = self._hurry or self._sought is not None
        self._frames += 1
        pause = FIRST_PAUSE if self._frames < FIRST_FRAMES else WATCH_PAUSE
        pause = HURRIED_PAUSE if hurried else pause
        due = self._since_watch >= pause or self._watches < len(parts)
        if self._search is None or not due or len(self._people) >= MOST_PEOPLE:
            return
        part = parts[self._watches % len(parts)]
        self._since_watch, self._watches = 0, self._watches + 1
        least = LEAST_SCORE
        if self._sought is not None:
            part, least = replace(part, x=self._sought[0], y=self._sought[1]), WEAK_SCORE
        for found in self._detector.detect_in(image, part, least=least)[: MOST_PEOPLE + 1]:
            seen = self._look_twice(
                image, Region.aligned(found.keypoints[0], found.keypoints[1], MARGIN)
            )
            if seen is None or len(self._people) >= MOST_PEOPLE:
                continue
            if any(_hides(person.seen, seen) for person in self._people):
                continue
            if found.score >= LEAST_SCORE or self._reaches(seen):
                self._people.append(_Person(seen))

    def _look_twice(self, image: Image, region: Region) -> SeenBody | None:
        """Return the body near a region of the detector, where two looks together believe in it.

        The detector's region is seldom centred on the body, so the first one alone decides nothing.
        """
        if not region.usable or any(_covers(person.seen, region) for person in self._people):
            return None
        first = self._model.look(image, region)
        if not first.following.usable:
            return None
        second = self._look(image, first.following)
        return second if second and first.score * second.score >= LEAST_PRESENCE**2 else None

    def _reaches(self, seen: SeenBody) -> bool:
        """Return whether a body has a wrist at the hand that is sought."""
        assert self._sought is not None
        far = np.linalg.norm(seen.xy[_WRISTS] - self._sought, axis=1).min()
        return bool(far < SAME_TORSO * _measure_torso(seen))


def _list_parts(image: Image) -> list[Region]:
    """Return the squares that cover an image, one after the other along its longer side."""
    height, width = image.shape[:2]
    side, longer = min(height, width), max(height, width)
    count = math.ceil(longer / side)
    middles = np.linspace(side / 2, longer - side / 2, count).tolist()
    if width >= height:
        return [Region(middle, side / 2, side) for middle in middles]
    return [Region(side / 2, middle, side) for middle in middles]


def _measure_torso(seen: SeenBody) -> float:
    """Return the diagonal of the box around shoulders and hips, pixels."""
    return float(np.linalg.norm(np.ptp(seen.xy[TORSO], axis=0)))


def _measure_distance(one: SeenBody, other: SeenBody) -> float:
    """Return the mean distance of the torsos' corners, in the larger torso's size."""
    apart = np.linalg.norm(one.xy[TORSO] - other.xy[TORSO], axis=1).mean()
    return float(apart / max(_measure_torso(one), _measure_torso(other), 1e-9))


def _is_among(seen: SeenBody, others: Iterable[SeenBody]) -> bool:
    return any(_measure_distance(seen, other) < SAME_TORSO for other in others)


def _hides(seen: SeenBody, other: SeenBody) -> bool:
    """Return whether a torso lies on another one: mostly one person, taken for two."""
    middles = (one.xy[TORSO].mean(axis=0) for one in (seen, other))
    apart = np.linalg.norm(np.subtract(*middles))
    return bool(apart < SAME_TORSO * max(_measure_torso(seen), _measure_torso(other)))


def _covers(seen: SeenBody, region: Region) -> bool:
    """Return whether a detected region is that of a person who is tracked already."""
    here = seen.following
    apart = np.hypot(here.x - region.x, here.y - region.y)
    return bool(apart < SAME_REGION * max(here.side, region.side))
