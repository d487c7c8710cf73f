"""Hand model and hand finder: landmarks of one hand in a region, and places of hands in an image.

`HandFinder` finds whole hands of divers, in gloves too, where no fingers need to be seen. Its model
is MediaPipe's palm detector, taught further on rendered divers (`release/hand_finder`). Its boxes
are of whole hands; of its keypoints the first is the wrist and the third the middle finger's
knuckle.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Final, TypeGuard

import numpy as np
from typing_extensions import Self

from app.recognition.estimation.landmark_models.arms import ArmPace, measure_body
from app.recognition.estimation.landmark_models.detector import Detector
from app.recognition.estimation.landmark_models.onnx_session import ModelSession, Signature, Tensor
from app.recognition.estimation.landmark_models.region import (
    KNUCKLES,
    REPLICATED_BORDER,
    WRIST,
    Detection,
    Region,
    box_of,
    measure_overlaps,
    palm_size,
    region_of_hand,
    up_of,
    upright,
)
from app.recognition.poses.frame import Body, Hand, Image, Side
from app.recognition.poses.landmarks import HAND_LANDMARKS, POSE_LANDMARKS

INPUT_SIZE: Final = 224
"""Side of the landmark model's input in pixels."""

HAND_SIGNATURE: Final = Signature(
    INPUT_SIZE, outputs=((1, 3 * len(HAND_LANDMARKS)), (1, 1), (1, 1))
)
"""Landmarks (x, y, z), probability of a hand, probability that it is a right one."""

LEAST_PRESENCE: Final = 0.5
"""Least probability of a hand; MediaPipe's default minimum presence confidence."""

GLOVED_SIGNATURE: Final = Signature(INPUT_SIZE, outputs=(*HAND_SIGNATURE.outputs, (1, 1)))
"""The same of the model of gloved hands, and its judgement: the logarithm of the odds that what a
landmark model has seen is a hand."""

GLOVED_PRESENCE: Final = 0.8
"""Least probability of a hand for the model of gloved hands, which sees more, and more that is
none."""

SURE: Final = 0.8
"""Presence from which MediaPipe's model is certain; where there is no other model, a new hand needs
as much."""

OF_SCORE: Final = 3.7
"""What a model's own score from 0 to 1 adds to the judgement: as much as the judgement itself tells
(ratio of their deviations in a third of the photographs)."""

BELIEVED: Final = 1.2
"""Least judgement of a hand whose fingers are seen, with its presence: chosen on the curve of hands
found against strays (`benchmarks/studies/hands-and-water.md`)."""

PLACE_BELIEVED: Final = 0.0
"""The same for a place alone, with the finder's score."""

GLOVED_SURE: Final = 0.995
"""Presence from which the model of gloved hands finds a new hand."""

PLACE_TURNS: Final = 4
PLACE_SCALE: Final = 1.4
"""Number of turns in which a place is judged, and side of the region over that of its box."""

WORTH_A_SECOND_LOOK: Final = 0.1
"""Presence from which an arm's region is corrected by the landmarks in it and evaluated again: a
hand that is off centre scores between this and 0.5, no hand below 0.01. Replaces the re-crop model
of MediaPipe Holistic."""

DUPLICATE_DISTANCE: Final = 0.2
DUPLICATE_LANDMARKS: Final = 10
DUPLICATE_OVERLAP: Final = 0.2
"""Two hands are one if at least this number of landmarks lies within this share of the palm's size
of each other and their boxes overlap by more than this; MediaPipe found the three values by
experiment."""


@dataclass(frozen=True, eq=False)
class SeenHand:
    """A hand of this frame.

    Attributes
    ----------
    hand
        Its landmarks.
    following
        Its region in the next frame.
    fresh
        Whether it was not tracked from the frame before.
    arm
        The arm that it is at the end of; None: none, or not known yet.
    carried
        Whether it was not looked at in this frame, but is where its arm carried it.
    box
        The box of a hand that the finder found; it is looked for there when its landmarks are
        lost.
    looked
        Time of the last look for the fingers of a hand of which only the place is seen.
    gloved
        Whether the model of gloved hands sees its landmarks.
    judged, doubted
        In how many of its frames it was judged, and not believed in.

    """

    hand: Hand
    following: Region
    fresh: bool = False
    arm: ArmPace | None = None
    carried: bool = False
    box: Region | None = None
    looked: float = -np.inf
    gloved: bool = False
    judged: int = 1
    doubted: int = 0

    @classmethod
    def at(cls, place: HandPlace, looked: float = -np.inf) -> Self:
        """Return a hand of which only the place is seen."""
        return cls(place.hand, place.box, box=place.box, looked=looked)

    @property
    def shows_fingers(self) -> bool:
        """Whether its landmarks are seen, and not its place alone."""
        return bool(np.isfinite(self.hand.xy).all())

    def carry(self) -> SeenHand:
        """Return the hand where the movement of its arm in the last frame has carried it."""
        if self.arm is None:
            return self
        dx, dy = self.arm.shift
        moved = replace(self.hand, xy=self.hand.xy + self.arm.shift)
        region = self.following
        return replace(
            self, hand=moved, following=replace(region, x=region.x + dx, y=region.y + dy)
        )


class HandModel:
    """The hand landmark model (Zhang et al. 2020, MediaPipe Hands), and one taught on gloves.

    Parameters
    ----------
    session
        The model, loaded with `HAND_SIGNATURE`.
    gloved
        The model of gloved hands; None: there is none, and nothing is seen with ``gloved=True``.

    """

    def __init__(self, session: ModelSession, gloved: ModelSession | None = None) -> None:
        self._session = session
        self._gloved = gloved

    @property
    def judges(self) -> bool:
        """Whether there is a model that judges; without it presence decides what is new."""
        return self._gloved is not None

    def look(self, image: Image, region: Region, *, gloved: bool = False) -> SeenHand | None:
        """Return the hand in a usable `region` of `image`, or None where the model finds none."""
        seen = self._landmarks(image, region, gloved=gloved)
        least = GLOVED_PRESENCE if gloved else LEAST_PRESENCE
        return seen if seen is not None and seen.hand.score >= least else None

    def find(self, image: Image, region: Region, *, gloved: bool = False) -> SeenHand | None:
        """Return the new hand near a `region`, which need not fit it well, None without one.

        What MediaPipe's model sees is judged. The judgement cannot tell among what only the other
        model sees: there its presence decides.
        """
        least = GLOVED_SURE if gloved else WORTH_A_SECOND_LOOK
        seen = self.see_twice(image, region, gloved=gloved, least=least)
        return seen if seen is not None and (gloved or self.believes(image, seen)) else None

    def see_twice(
        self, image: Image, region: Region, *, gloved: bool, least: float
    ) -> SeenHand | None:
        """Return what a model sees near a `region`; its own region is usable.

        If the first run sees something, a second one at the region of its landmarks tells its
        presence.
        """
        first = self._landmarks(image, region, gloved=gloved)
        if not _has(first, WORTH_A_SECOND_LOOK):
            return None
        seen = self._landmarks(image, first.following, gloved=gloved)
        return seen if _has(seen, least) else None

    def believes(self, image: Image, seen: SeenHand) -> bool:
        """Return whether MediaPipe's landmarks are believed to be a hand's.

        Without the model of gloved hands, which judges their region, their presence decides.
        """
        if self._gloved is None:
            return seen.hand.score >= SURE
        judgement = self._judge(self._gloved, image, seen.following)
        return judgement + OF_SCORE * seen.hand.score >= BELIEVED

    def believes_place(self, image: Image, place: HandPlace) -> bool:
        """Return whether a place is believed to be a hand's, whichever way it points."""
        if self._gloved is None:
            return True
        box = replace(place.box, side=PLACE_SCALE * place.box.side)
        judgements = [
            self._judge(self._gloved, image, replace(box, rotation=turn))
            for turn in np.linspace(0, 2 * np.pi, PLACE_TURNS, endpoint=False)
        ]
        return bool(np.mean(judgements) + OF_SCORE * place.hand.score >= PLACE_BELIEVED)

    @staticmethod
    def _judge(session: ModelSession, image: Image, region: Region) -> float:
        return float(_run(session, image, region)[-1][0, 0])

    def _landmarks(self, image: Image, region: Region, *, gloved: bool) -> SeenHand | None:
        session = self._gloved if gloved else self._session
        if session is None:
            return None
        raw, presence, right, *_ = _run(session, image, region)
        points = raw.reshape(len(HAND_LANDMARKS), 3)[:, :2].astype(np.float64)
        xy = region.to_image(points, INPUT_SIZE)
        # The model was trained on mirrored selfies and renamed since: in an unmirrored image
        # this output is the probability of the person's own right hand.
        side: Side = "right" if right[0, 0] > 0.5 else "left"
        hand = Hand(xy, side, min(float(presence[0, 0]), 1.0))
        return SeenHand(hand, region_of_hand(xy), gloved=gloved)


def _run(session: ModelSession, image: Image, region: Region) -> list[Tensor]:
    region.crop(image, INPUT_SIZE, REPLICATED_BORDER, out=session.pixels)
    return session.run()


def _has(seen: SeenHand | None, presence: float) -> TypeGuard[SeenHand]:
    """Return whether a hand of this presence was seen, with a usable region."""
    return seen is not None and seen.following.usable and seen.hand.score >= presence


def find_duplicates(one: Hand, other: Hand) -> bool:
    """Return whether two results show the same hand."""
    near = DUPLICATE_DISTANCE * max(palm_size(one.xy), palm_size(other.xy))
    distances = np.linalg.norm(one.xy - other.xy, axis=1)
    if np.count_nonzero(distances < near) < DUPLICATE_LANDMARKS:
        return False
    return bool(measure_overlaps(box_of(one.xy), box_of(other.xy)[None])[0] > DUPLICATE_OVERLAP)


PART: Final = 0.62
"""Side of the four parts of an image that are searched, over its longer side: a hand of a
distant diver is too small in the whole."""

CENTRES: Final = (0.3, 0.7)
"""Centres of these parts, across and down, as shares of the image."""

PALM: Final = 0.35
"""Distance from the wrist to the knuckles, over the side of a place; the finder tells the way from
one to the other, not the distance."""

LARGEST: Final = 2.5
"""Side of the largest hand, in body sizes: in dark water, of near divers, the pose is too small."""

HEAD: Final = 0.4
"""Distance of the nose from the middle of a place that is a head in its hood, over its side."""

_NOSE: Final = POSE_LANDMARKS.index("nose")

AROUND: Final = 3.5
"""Side of the region in which a place is looked for again, over the side of its box."""

SAME_PLACE: Final = 0.5
"""Distance of two places, over the larger one's side, below which they are the same hand."""


@dataclass(frozen=True, eq=False)
class HandPlace:
    """Where a hand is.

    Attributes
    ----------
    hand
        Its wrist and, at the middle finger's, its knuckles; fingers are NaN.
    box
        The square around the hand, turned so that the middle knuckle is straight above the wrist.

    """

    hand: Hand
    box: Region

    def fits(self, body: Body) -> bool:
        """Return whether it is no head, and not too large for a hand of a body in the image."""
        far = float(np.linalg.norm(body.xy[_NOSE] - (self.box.x, self.box.y)))
        is_head = far < HEAD * self.box.side
        return not is_head and not self.box.side > LARGEST * measure_body(body)


class HandFinder:
    """Finds the places of hands in images, each by itself.

    Parameters
    ----------
    detector
        The taught detector.

    """

    def __init__(self, detector: Detector) -> None:
        self._detector = detector

    def search(
        self, image: Image, regions: Iterable[Region], least: float
    ) -> tuple[HandPlace, ...]:
        """Return the places with a score from `least` in regions of `image`, best first."""
        return _distinct(
            _place(found)
            for region in regions
            if region.usable
            for found in self._detector.detect_in(image, region, least=least)
        )

    def look(self, image: Image, box: Region, least: float) -> HandPlace | None:
        """Return the place nearest to where a hand was, None where its score is below `least`."""
        around = Region(box.x, box.y, AROUND * box.side)
        places = [_place(found) for found in self._detector.detect_in(image, around, least=least)]
        near = [place for place in places if _distance(place.box, box) < 1]
        return min(near, key=lambda place: _distance(place.box, box), default=None)


def parts_of(image: Image) -> tuple[Region, ...]:
    """Return the whole of an image, and four overlapping parts of it."""
    height, width = image.shape[:2]
    whole = Region.around(image)
    parts = (
        Region(across * width, down * height, PART * whole.side)
        for across in CENTRES
        for down in CENTRES
    )
    return (whole, *parts)


def _place(found: Detection) -> HandPlace:
    x, y = found.box.mean(axis=0)
    side = float((found.box[1] - found.box[0]).max())
    rotation = upright(found.keypoints[0], found.keypoints[2])
    xy = np.full((len(HAND_LANDMARKS), 2), np.nan)
    xy[WRIST] = found.keypoints[0]
    xy[list(KNUCKLES)] = found.keypoints[0] + PALM * side * up_of(rotation)
    return HandPlace(Hand(xy, "right", found.score), Region(float(x), float(y), side, rotation))


def _distinct(places: Iterable[HandPlace]) -> tuple[HandPlace, ...]:
    """Return the places without those that show the hand of a better one, best first."""
    kept: list[HandPlace] = []
    for place in sorted(places, key=lambda one: -one.hand.score):
        if place.box.usable and all(_distance(place.box, one.box) > SAME_PLACE for one in kept):
            kept.append(place)
    return tuple(kept)


def _distance(one: Region, other: Region) -> float:
    """Return how far two boxes are apart, in the side of the larger one."""
    return float(np.hypot(one.x - other.x, one.y - other.y)) / max(one.side, other.side)
