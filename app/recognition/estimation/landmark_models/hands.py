"""Hand tracker: finds hands with the palm detector or at the ends of arms, then tracks them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
from typing_extensions import Self

from app.recognition.estimation.landmark_models.arms import (
    FOREARM_REACH,
    REACH,
    Arm,
    ArmPace,
    ArmPaces,
    region_of_wrist,
    regions_of_forearm,
    wrist_distance,
)
from app.recognition.estimation.landmark_models.detector import Detector
from app.recognition.estimation.landmark_models.hand_regions import (
    box_of,
    palm_size,
    region_of_hand,
    region_of_palm,
)
from app.recognition.estimation.landmark_models.onnx_session import ModelSession, Signature
from app.recognition.estimation.landmark_models.region import REPLICATED_BORDER, Region
from app.recognition.estimation.landmark_models.suppression import measure_overlaps
from app.recognition.poses.frame import SIDES, Body, Hand, Image, Side
from app.recognition.poses.landmarks import HAND_LANDMARKS

INPUT_SIZE: Final = 224
"""Side of the landmark model's input in pixels."""

HAND_SIGNATURE: Final = Signature(
    INPUT_SIZE, outputs=((1, 3 * len(HAND_LANDMARKS)), (1, 1), (1, 1))
)
"""Landmarks (x, y, z), probability of a hand, probability that it is a right one."""

MOST_HANDS: Final = 2
"""Most hands of one person; each costs a run of the landmark model per frame."""

LEAST_PRESENCE: Final = 0.5
"""Least probability of a hand; MediaPipe's default minimum presence confidence."""

WORTH_A_SECOND_LOOK: Final = 0.1
"""Presence from which an arm's region is corrected by the landmarks in it and evaluated again: a
hand that is off centre scores between this and 0.5, no hand below 0.01. Replaces the re-crop model
of MediaPipe Holistic."""

SAME_REGION: Final = 0.5
"""Overlap above which a candidate is a hand that is tracked already (MediaPipe's default)."""

PALM_PAUSE: Final = 10
"""Frames between palm detections while a body is seen, whose arms are searched in every frame. Palm
detection costs as much as the body model."""

FOREARM_SECONDS: Final = 0.4
"""Seconds between searches at the end of a forearm, which cost up to four looks."""

SURE: Final = 0.8
"""Presence from which a hand is certain. Below it, most results at the end of a forearm, or of the
palm detector away from the body's arms, are no hands. While a tracked hand is below it, palms are
detected even with two tracked hands, because one of them may be false."""

DUPLICATE_DISTANCE: Final = 0.2
DUPLICATE_LANDMARKS: Final = 10
DUPLICATE_OVERLAP: Final = 0.2
"""Two hands are one if at least this number of landmarks lies within this share of the palm's size
of each other and their boxes overlap by more than this; MediaPipe found the three values by
experiment."""

HandSearch = Literal["pose", "palm"]
"""Search for untracked hands: at the ends of the body's arms and, every few frames, with the palm
detector; or with the palm detector alone, as MediaPipe's hand landmarker."""


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

    """

    hand: Hand
    following: Region
    fresh: bool = False
    arm: ArmPace | None = None
    carried: bool = False

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
    """The hand landmark model (Zhang et al. 2020, MediaPipe Hands).

    Parameters
    ----------
    session
        The model, loaded with `HAND_SIGNATURE`.

    """

    def __init__(self, session: ModelSession) -> None:
        self._session = session

    def look(self, image: Image, region: Region) -> SeenHand | None:
        """Return the hand in a usable `region` of `image`, or None where the model finds none."""
        seen = self._landmarks(image, region)
        return seen if seen.hand.score >= LEAST_PRESENCE else None

    def look_twice(self, image: Image, region: Region) -> SeenHand | None:
        """Return the hand near a `region`, which need not fit it well.

        If the first run finds something, a second one at the region of its landmarks decides.
        """
        first = self._landmarks(image, region)
        if not first.hand.score >= WORTH_A_SECOND_LOOK or not first.following.usable:
            return None
        return self.look(image, first.following)

    def _landmarks(self, image: Image, region: Region) -> SeenHand:
        region.crop(image, INPUT_SIZE, REPLICATED_BORDER, out=self._session.pixels)
        raw, presence, right = self._session.run()
        points = raw.reshape(len(HAND_LANDMARKS), 3)[:, :2].astype(np.float64)
        xy = region.to_image(points, INPUT_SIZE)
        # The model was trained on mirrored selfies and renamed since: in an unmirrored image
        # this output is the probability of the person's own right hand.
        side: Side = "right" if right[0, 0] > 0.5 else "left"
        return SeenHand(Hand(xy, side, min(float(presence[0, 0]), 1.0)), region_of_hand(xy))


class HandTracker:
    """Tracks up to two hands of each person through the frames of a clip.

    Palms are detected only while fewer hands than `MOST_HANDS` a person are tracked with a presence
    of `SURE` or more; the landmarks of a frame give the regions of the next. Where there are more
    hands than that, or two at one arm, those with the highest scores are kept. Hands are not
    smoothed: the model's own output is steady, and fingers are fast.

    The palm detector works on the whole frame at 192 pixels a side, in which the hands of a distant
    diver are too small. With ``search="pose"`` a hand is searched in the full frame at each arm
    that has none (after MediaPipe Holistic, Grishchenko and Bazarevsky 2020), every few frames also
    at the end of the forearm, for gloves, and no arm has two hands. How often a hand is looked at
    depends on its arm (`ArmPaces`); between, it is where the arm's wrist carries it.

    Parameters
    ----------
    palms
        The palm detector.
    model
        The hand landmark model.
    search
        How to find untracked hands.

    """

    def __init__(self, palms: Detector, model: HandModel, search: HandSearch) -> None:
        self._palms = palms
        self._model = model
        self._search = search
        self._spares = False
        self.reset()

    def reset(self) -> None:
        """Reset the tracking."""
        self._tracked: tuple[SeenHand, ...] = ()
        self._most = MOST_HANDS
        self._until_palms = 0
        self._paces = ArmPaces(spares=self._spares)

    def spare(self, *, spares: bool) -> None:
        """Look at hands less often, or as often as usual; see `ArmPaces`."""
        self._spares = self._paces.spares = spares

    def renew(self) -> Self:
        """Return a tracker with the same models that has seen nothing yet."""
        return type(self)(self._palms, self._model, self._search)

    def follow(self, image: Image, time: float = 0.0) -> tuple[SeenHand, ...]:
        """Return the hands in `image`, taken at `time` seconds, by tracking and palm detection.

        It needs no body, so it can run in parallel with the body's models.
        """
        kept: list[SeenHand] = []
        for tracked in self._tracked:
            if tracked.arm is not None and not tracked.arm.is_due(time):
                kept.append(replace(tracked, carried=True, fresh=False))
                continue
            seen = self._model.look(image, tracked.following)
            if seen is not None and not _known(seen, kept):
                kept.append(seen)
        for region in self._detect_palms(image):
            seen = self._model.look(image, region)
            if seen is not None and not _known(seen, kept):
                kept.append(replace(seen, fresh=True))
        return tuple(kept)

    def complete(
        self,
        image: Image,
        followed: tuple[SeenHand, ...],
        bodies: Sequence[Body],
        time: float = 0.0,
    ) -> tuple[Hand, ...]:
        """Return the hands in `image`, larger first.

        Parameters
        ----------
        image
            The image of `followed`.
        followed
            What `follow` returned.
        bodies
            The bodies in the image, if any are seen.
        time
            Seconds.

        """
        self._most = MOST_HANDS * max(1, len(bodies))
        if self._search == "pose" and bodies:
            seen = self._on_arms(image, followed, bodies, time)
        else:
            alone = [replace(one, arm=None, carried=False) for one in followed]
            seen, self._until_palms = self._most_believed(alone), 0
        self._tracked = tuple(one for one in seen if one.following.usable)
        return tuple(sorted((one.hand for one in seen), key=lambda hand: -hand.size))

    def _detect_palms(self, image: Image) -> list[Region]:
        """Return the regions of palms that are not tracked yet, where some may be."""
        tracked = [one.following for one in self._tracked]
        if sum(one.hand.score >= SURE for one in self._tracked) >= self._most:
            return []
        if self._until_palms > 0:
            self._until_palms -= 1
            return []
        self._until_palms = PALM_PAUSE - 1
        proposals = [region_of_palm(palm) for palm in self._palms.detect(image)[: self._most]]
        return [
            proposal
            for proposal in proposals
            if proposal.usable
            and not any(proposal.overlap(region) > SAME_REGION for region in tracked)
        ]

    def _on_arms(
        self, image: Image, followed: tuple[SeenHand, ...], bodies: Sequence[Body], time: float
    ) -> tuple[SeenHand, ...]:
        """Assign each arm the hand at its end, searching there if none was followed.

        Of two hands at one arm, the one with the lower score is dropped. Hands at no arm (of
        people whose body is not seen, or where the pose is wrong) compete with those at the arms by
        score.
        """
        free = [(body, side) for body in bodies for side in SIDES]
        paces = self._paces.update(free, time)
        carried = [one.carry() if one.carried else one for one in followed]
        arms, elsewhere = _sort_by_arm(carried, free)
        for place, ((body, side), pace) in enumerate(zip(free, paces, strict=True)):
            if place in arms:
                pace.read = pace.read if arms[place].carried else time
                pace.misses = 0
            elif pace.is_due(time):
                pace.read = time
                with_forearm = time - pace.forearm_searched >= FOREARM_SECONDS
                if with_forearm:
                    pace.forearm_searched = time
                seen = self._search_arm(image, body, side, with_forearm=with_forearm)
                if seen is not None and not _known(seen, arms.values()):
                    arms[place] = seen
                pace.misses = 0 if place in arms else pace.misses + 1
        at_arms = [replace(one, arm=paces[place], carried=False) for place, one in arms.items()]
        alone = [replace(one, arm=None, carried=False) for one in elsewhere]
        return self._most_believed((*at_arms, *alone))

    def _most_believed(self, seen: Iterable[SeenHand]) -> tuple[SeenHand, ...]:
        return tuple(_by_belief(seen)[: self._most])

    def _search_arm(
        self, image: Image, body: Body, side: Side, *, with_forearm: bool
    ) -> SeenHand | None:
        """Return the hand at the end of an arm, from the pose's fingers, or from its forearm."""
        region = region_of_wrist(body, side)
        if region is not None:
            seen = self._model.look_twice(image, region)
            if seen is not None and wrist_distance(seen.hand, body, side) <= REACH:
                return seen
        for region in regions_of_forearm(body, side) if with_forearm else ():
            seen = self._model.look_twice(image, region)
            if seen is None or seen.hand.score < SURE:
                continue
            if wrist_distance(seen.hand, body, side) <= FOREARM_REACH:
                return seen
        return None


def _sort_by_arm(
    followed: Iterable[SeenHand], free: Sequence[Arm]
) -> tuple[dict[int, SeenHand], list[SeenHand]]:
    """Assign hands to arms, the highest score first, each to the nearest free one within `REACH`.

    Returns
    -------
    Hands by the position of their arm in `free`, and those that are away from all arms.

    """
    arms: dict[int, SeenHand] = {}
    elsewhere = []
    for one in _by_belief(followed):
        far = [wrist_distance(one.hand, body, side) for body, side in free]
        near = [place for place, distance in enumerate(far) if distance <= REACH]
        if vacant := [place for place in near if place not in arms]:
            arms[min(vacant, key=lambda place: far[place])] = one
        if not near and (one.hand.score >= SURE or not one.fresh):
            elsewhere.append(one)
    return arms, elsewhere


def _by_belief(seen: Iterable[SeenHand]) -> list[SeenHand]:
    return sorted(seen, key=lambda one: -one.hand.score)


def _known(seen: SeenHand, others: Iterable[SeenHand]) -> bool:
    return any(find_duplicates(seen.hand, one.hand) for one in others)


def find_duplicates(one: Hand, other: Hand) -> bool:
    """Return whether two results show the same hand."""
    near = DUPLICATE_DISTANCE * max(palm_size(one.xy), palm_size(other.xy))
    distances = np.linalg.norm(one.xy - other.xy, axis=1)
    if np.count_nonzero(distances < near) < DUPLICATE_LANDMARKS:
        return False
    return bool(measure_overlaps(box_of(one.xy), box_of(other.xy)[None])[0] > DUPLICATE_OVERLAP)
