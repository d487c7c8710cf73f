"""Person tracker: follows one person where several are seen, or tells all of them apart."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.estimation.landmark_models.region import measure_overlaps
from app.recognition.poses.sequence import MAX_GAP_SECONDS, FloatArray

SAME_PERSON: Final = 0.3
"""Least intersection over union of a person's boxes in two frames. Stretching an arm halves it; two
people beside each other overlap less."""

PATIENCE_SECONDS: Final = MAX_GAP_SECONDS
"""Seconds after which an unseen person is given up: longer gaps are not bridged in trajectories
either, so the gesture is lost anyway."""

REUNION_SECONDS: Final = 10.0
"""Seconds after which a person who comes back to the same place counts as another one: somebody who
swims past hides a diver for less."""

MOST_GROWTH: Final = 1.5
"""How much larger a person can have become who is known again beside the former place."""

PLACE_SECONDS: Final = 3.0
"""Seconds for which a person's place is kept: who swims past in front of a diver takes less."""

SAME_PLACE: Final = 0.5
"""Least intersection over union of a box with one that was there before; above `SAME_PERSON`, since
a place is what tells them apart."""


class PersonTracker:
    """Selects the same person in every frame.

    First it is the most prominent person: the largest box, weighted by the detector's confidence.
    Then it is the person whose box overlaps the previous one, however large other boxes become.
    Frames must be in order of time.
    """

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Reset the tracking."""
        self._box: FloatArray | None = None
        self._since = -np.inf

    def choose(self, boxes: FloatArray, scores: FloatArray, time: float) -> int | None:
        """Return the index of the tracked person among N, or None where they are not seen.

        Parameters
        ----------
        boxes
            ``(N, 2, 2)`` corners (left, top) and (right, bottom), pixels.
        scores
            ``(N,)`` confidence of each, in [0, 1].
        time
            Seconds.

        """
        if not len(boxes):
            return None
        chosen = self._again(boxes)
        if chosen is None:
            if self._box is not None and 0 <= time - self._since <= PATIENCE_SECONDS:
                return None
            chosen = int(np.argmax(measure_prominence(boxes, scores)))
        self._box, self._since = boxes[chosen], time
        return chosen

    def _again(self, boxes: FloatArray) -> int | None:
        if self._box is None:
            return None
        shared = measure_overlaps(self._box, boxes)
        nearest = int(np.argmax(shared))
        return nearest if shared[nearest] >= SAME_PERSON else None


@dataclass(frozen=True)
class Exchange:
    """A track that went over to another person, found out when the first one was seen again.

    Attributes
    ----------
    track
        Number of the track; it is the first person's again.
    new
        Number of the other person from now on.
    since
        Seconds: when the track went over.

    """

    track: int
    new: int
    since: float


class PeopleTracks:
    """Tells who is who from frame to frame, by place and posture.

    Frames must be in order of time. A person who was hidden is known again at the same place, or
    else near it and about as large, within `REUNION_SECONDS`. Where a track has left its place and
    somebody appears there, it went over to another person who passed in front.

    Attributes
    ----------
    exchanged
        What the last frame showed of an earlier error; None where there was none.

    """

    def __init__(self) -> None:
        self._last: dict[int, tuple[float, FloatArray, FloatArray]] = {}
        self._places: dict[int, deque[tuple[float, FloatArray]]] = {}
        self._count = 0
        self.exchanged: Exchange | None = None

    @property
    def alive(self) -> frozenset[int]:
        """The tracks of people who can still be known again."""
        return frozenset(self._last)

    def assign(self, people: Sequence[FloatArray], time: float) -> tuple[int, ...]:
        """Return the number of each person's track; a new person gets a new one.

        Parameters
        ----------
        people
            ``(K, 2)`` keypoints of each, one of them at least seen; NaN: not seen.
        time
            Seconds, later than in every call before.

        """
        self.exchanged = None
        for track in [t for t, (seen, *_) in self._last.items() if time - seen > REUNION_SECONDS]:
            del self._last[track], self._places[track]
        if not people:
            return ()
        xy = np.stack(people)
        boxes = find_boxes(xy)
        tracks = self._match(xy, boxes, time)
        for place in range(len(people)):
            if place not in tracks:
                tracks[place] = self._name(boxes[place], tracks, boxes, time)
        for place, track in tracks.items():
            self._last[track] = time, xy[place], boxes[place]
            places = self._places.setdefault(track, deque())
            places.append((time, boxes[place]))
            while time - places[0][0] > PLACE_SECONDS:
                places.popleft()
        return tuple(tracks[place] for place in range(len(people)))

    def _match(self, xy: FloatArray, boxes: FloatArray, time: float) -> dict[int, int]:
        """Return the known tracks of people by their position, the surest ones first."""
        # The ordinary case of one person throughout, ten times as fast.
        if len(xy) == len(self._last) == 1:
            ((track, (_, _, box)),) = self._last.items()
            if measure_overlaps(box, boxes)[0] >= SAME_PERSON:
                return {0: track}
        pairs = []
        for track, (seen, last_xy, last_box) in self._last.items():
            apart = _measure_apart(last_xy, last_box, xy).tolist()
            same = measure_overlaps(last_box, boxes) >= SAME_PERSON
            near = _find_near(last_box, boxes)
            hidden = time - seen > PATIENCE_SECONDS
            for place in np.flatnonzero(same | near).tolist():
                # Who was just seen comes before who was hidden, even after a wide movement.
                pairs.append((hidden, not same[place], apart[place], track, place))
        tracks: dict[int, int] = {}
        for _, _, _, track, place in sorted(pairs):
            if place not in tracks and track not in tracks.values():
                tracks[place] = track
        return tracks

    def _name(self, box: FloatArray, tracks: dict[int, int], boxes: FloatArray, time: float) -> int:
        """Return the number of somebody who appears, and take it from who came away from there."""
        new = self._count
        self._count += 1
        for place, track in tracks.items():
            since = self._find_departure(track, box, boxes[place], time)
            if since is not None:
                self.exchanged = Exchange(track, new, since)
                tracks[place] = new
                self._places[new] = deque(each for each in self._places[track] if each[0] >= since)
                self._places[track] = deque(each for each in self._places[track] if each[0] < since)
                return track
        return new

    def _find_departure(
        self, track: int, box: FloatArray, now: FloatArray, time: float
    ) -> float | None:
        """Return when a track that is elsewhere now left the place of a box; None if it did not."""
        places = self._places.get(track)
        if not places or measure_overlaps(now, box[None])[0] >= SAME_PERSON:
            return None
        there = measure_overlaps(box, np.stack([each for _, each in places])) >= SAME_PLACE
        if not there.any():
            return None
        later = [seen for seen, _ in list(places)[int(np.flatnonzero(there)[-1]) + 1 :]]
        return later[0] if later else time


def measure_prominence(boxes: FloatArray, scores: FloatArray) -> FloatArray:
    """Return ``(N,)`` the prominence of each person: area of the box times confidence."""
    sides = np.clip(boxes[:, 1] - boxes[:, 0], 0, None)
    return np.asarray(sides.prod(axis=1) * scores, dtype=np.float64)


def find_boxes(xy: FloatArray) -> FloatArray:
    """Return ``(N, 2, 2)`` boxes around the seen points of N people ``(N, K, 2)``.

    Every person has at least one point that is not NaN.
    """
    return np.stack([np.nanmin(xy, axis=1), np.nanmax(xy, axis=1)], axis=1)


def _measure_apart(last: FloatArray, box: FloatArray, xy: FloatArray) -> FloatArray:
    """Return ``(N,)`` the median distance of N people's keypoints from the last, in body sizes."""
    size = max(float(np.linalg.norm(box[1] - box[0])), 1e-9)
    far = np.linalg.norm(xy - last, axis=2) / size
    return np.array([np.nanmedian(row) if np.isfinite(row).any() else np.inf for row in far])


def _find_near(box: FloatArray, boxes: FloatArray) -> npt.NDArray[np.bool_]:
    """Return ``(N,)`` which boxes are less than their size away from another one, and as large."""
    size = float(np.linalg.norm(box[1] - box[0]))
    sizes = np.linalg.norm(boxes[:, 1] - boxes[:, 0], axis=1)
    far = np.linalg.norm(boxes.mean(axis=1) - box.mean(axis=0), axis=1)
    larger, smaller = np.maximum(sizes, size), np.minimum(sizes, size)
    return np.asarray((far < smaller) & (larger < MOST_GROWTH * smaller))
