"""Hand tracker: finds hands with the palm detector or at the ends of arms, then tracks them."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Final, Literal

import numpy as np
from typing_extensions import Self

from app.recognition.estimation.landmark_models.arms import (
    FOREARM_REACH,
    REACH,
    Arm,
    ArmPace,
    ArmPaces,
    find_far_arm,
    is_doubtful,
    move_wrists,
    region_of_wrist,
    regions_of_forearm,
    wrist_distance,
)
from app.recognition.estimation.landmark_models.detector import Detector
from app.recognition.estimation.landmark_models.hand_model import (
    GLOVED_PRESENCE,
    GLOVED_SURE,
    SURE,
    HandFinder,
    HandModel,
    HandPlace,
    SeenHand,
    find_duplicates,
    parts_of,
)
from app.recognition.estimation.landmark_models.region import Region, region_of_palm
from app.recognition.poses.frame import SIDES, Body, FrameLandmarks, Image, Side

MOST_HANDS: Final = 2
"""Most hands of one person; each costs a run per frame."""

SAME_REGION: Final = 0.5
"""Overlap above which a candidate is a hand that is tracked already (MediaPipe's default)."""

PALM_PAUSE: Final = 10
"""Frames between palm detections, which cost as much as the body model, while a body is seen."""

FOREARM_SECONDS: Final = 0.4
"""Seconds between searches at the end of a forearm, which cost up to four looks."""

LONG_LOST, LOST_FACTOR = 8, 2
"""Searches in vain after which the forearm is searched less often by this factor: the time goes
to the finder."""

PROPOSED_SCORE: Final = 0.4
"""Least score of a place of a hand that is new."""

KEPT_SCORE: Final = 0.3
"""Least score of a place at which a hand was in the frame before."""

MOST_PLACES: Final = 3
"""Places at which fingers are looked for in a search."""

MOST_NOTED: Final = 16
"""Hands of examinations that are kept until they are followed."""

SAME_PLACE: Final = 0.5
"""Distance of the middles of two hands, over the larger one's size, below which they are one; for
hands of which only the place is seen."""

FINGERS_SECONDS: Final = 0.3
"""Seconds between two looks for the fingers of a hand of which only the place is seen."""

FINGERS_SCALE: Final = 1.1
"""Side of the region in which fingers are looked for, over the side of the place's box."""

TURNS: Final = 8
"""Number of turns in which fingers are looked for, as a glove does not show which way it points: an
examination tries all, tracking the next one at each look."""

GLOVE_SCORE: Final = 0.6
"""Least score of a place at which the model of gloved hands looks."""

AGREEING_TURNS: Final = 5
"""Least number of `TURNS` in which the model of gloved hands must see a hand at a place."""

MOST_JUDGED: Final = 3
"""First frames of a hand in which it is judged; it stays with the word of most of them."""

GLOVE_SCALE: Final = 1.3
"""Side of the region in which it looks, over that of the place's box."""

HandSearch = Literal["pose", "palm"]
"""Search for untracked hands: at the ends of the body's arms and, every few frames, with the palm
detector; or with the palm detector alone, as MediaPipe's hand landmarker."""


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
    finder
        Finds hands whose fingers need not be seen; None: only hands with fingers are found. It
        looks where an image is examined, and in turn with the palm detector.

    """

    def __init__(
        self,
        palms: Detector,
        model: HandModel,
        search: HandSearch,
        finder: HandFinder | None = None,
    ) -> None:
        self._palms = palms
        self.model = model
        self._search = search
        self.finder = finder
        self._spares = False
        self._noted: deque[SeenHand] = deque(maxlen=MOST_NOTED)
        self.reset()

    def reset(self) -> None:
        """Reset the tracking; what `examine` has noted stays for `adopt`."""
        self._tracked: tuple[SeenHand, ...] = ()
        self._most = MOST_HANDS
        self._until_palms = 0
        self._turn = self._turned = 0
        self._bodies: tuple[Body, ...] = ()
        self._free: list[Arm] = []
        self._arms: list[ArmPace] = []
        self._time = 0.0
        self._paces = ArmPaces(spares=self._spares)

    def spare(self, *, spares: bool) -> None:
        """Look at hands less often, or as often as usual; see `ArmPaces`."""
        self._spares = self._paces.spares = spares

    def renew(self) -> Self:
        """Return a tracker with the same models that has seen nothing yet."""
        return type(self)(self._palms, self.model, self._search, self.finder)

    def examine(self, image: Image, bodies: Sequence[Body]) -> FrameLandmarks:
        """Return the hands in `image` alone; tracking is left as it is until `adopt`."""
        alone = self.renew()
        found = alone.complete(image, alone.follow(image), bodies)
        places = alone._find_places(image, parts_of(image))
        # Without the model of gloves: under some correction it always sees one.
        seen = [alone._look_for_fingers(image, place, TURNS, gloved=False) for place in places[:1]]
        self._noted.extend((*alone._tracked, *(one for one in seen if one is not None)))
        return found

    def adopt(self, image: Image) -> FrameLandmarks:
        """Return the last frame with what examinations of it, and the finder in it, have found.

        It is followed from now on.

        Parameters
        ----------
        image
            The last frame, corrected as the next ones will be.

        """
        tracked = list(self._tracked)
        for one in (*_by_belief(self._noted), *self._search_places(image, parts_of(image))):
            if not _known(one, tracked):
                tracked.append(replace(one, arm=None, fresh=False))
        self._noted.clear()
        return self._finish(None, tuple(tracked))

    def follow(self, image: Image, time: float = 0.0) -> tuple[SeenHand, ...]:
        """Return the hands in `image`, taken at `time` seconds, by tracking and palm detection.

        It needs no body, so it can run in parallel with the body's models.
        """
        kept: list[SeenHand] = []
        for tracked in self._tracked:
            if tracked.arm is not None and not tracked.arm.is_due(time):
                kept.append(replace(tracked, carried=True, fresh=False))
                continue
            seen = self._look_again(image, tracked, time)
            if seen is not None and not _known(seen, kept):
                kept.append(seen)
        for seen in self._detect(image):
            if not _known(seen, kept):
                kept.append(replace(seen, fresh=True))
        return tuple(kept)

    def _look_again(self, image: Image, tracked: SeenHand, time: float) -> SeenHand | None:
        """Return a tracked hand in the next frame; without its fingers where these are lost."""
        if tracked.shows_fingers:
            seen = self.model.look(image, tracked.following, gloved=tracked.gloved)
            if seen is not None:
                return self._judge_again(image, tracked, replace(seen, box=tracked.box))
        if tracked.box is None or self.finder is None:
            return None
        box = replace(tracked.box, x=tracked.following.x, y=tracked.following.y)
        place = self.finder.look(image, box, KEPT_SCORE)
        if place is None:
            return None
        if time - tracked.looked < FINGERS_SECONDS:
            return SeenHand.at(place, tracked.looked)
        return self._look_for_fingers(image, place) or SeenHand.at(place, time)

    def _judge_again(self, image: Image, tracked: SeenHand, seen: SeenHand) -> SeenHand | None:
        """Return a hand with its judgement; None where most of its frames speak against it."""
        judged, doubted = tracked.judged, tracked.doubted
        lasting = seen.gloved or not self.model.judges or not seen.following.usable
        if not lasting and judged < MOST_JUDGED:
            judged += 1
            doubted += not self.model.believes(image, seen)
        believed = doubted <= MOST_JUDGED // 2
        return replace(seen, judged=judged, doubted=doubted) if believed else None

    def _look_for_fingers(
        self, image: Image, place: HandPlace, turns: int = 1, *, gloved: bool = True
    ) -> SeenHand | None:
        """Return the hand at a place with its landmarks, None where they are not seen."""
        box = place.box
        for _ in range(turns):
            self._turned = (self._turned + 1) % TURNS
            rotation = box.rotation + self._turned * 2 * np.pi / TURNS
            region = replace(box, side=FINGERS_SCALE * box.side, rotation=rotation)
            seen = self.model.find(image, region)
            if seen is not None and _known(seen, [SeenHand.at(place)]):
                return replace(seen, box=box)
        return self._look_for_glove(image, place) if gloved else None

    def _look_for_glove(self, image: Image, place: HandPlace) -> SeenHand | None:
        """Return the gloved hand at a place, None where it is not seen in most turns.

        Where certain fingers are seen already, the others are no gloves.
        """
        fingers = any(
            one.shows_fingers and not one.gloved and one.hand.score >= SURE for one in self._tracked
        )
        if fingers or place.hand.score < GLOVE_SCORE:
            return None
        side, turns = GLOVE_SCALE * place.box.side, np.linspace(0, 2 * np.pi, TURNS, endpoint=False)
        regions = [
            replace(place.box, side=side, rotation=place.box.rotation + turn) for turn in turns
        ]
        looks = [
            self.model.see_twice(image, region, gloved=True, least=GLOVED_PRESENCE)
            for region in regions
        ]
        seen = [one for one in looks if one and _known(one, [SeenHand.at(place)])]
        best = max(seen, key=lambda one: one.hand.score, default=None)
        if best is None or len(seen) < AGREEING_TURNS or best.hand.score < GLOVED_SURE:
            return None
        return replace(best, box=place.box)

    def _find_places(self, image: Image, regions: Iterable[Region]) -> list[HandPlace]:
        """Return the places that the finder proposes in regions, best first."""
        if self.finder is None:
            return []
        places = self.finder.search(image, regions, PROPOSED_SCORE)
        fitting = [one for one in places if all(one.fits(body) for body in self._bodies)]
        return fitting[:MOST_PLACES]

    def _search_places(self, image: Image, regions: Iterable[Region]) -> list[SeenHand]:
        """Return the hands, with or without fingers, that the finder finds in regions."""
        found = []
        for place in self._find_places(image, regions):
            believed = self.model.believes_place(image, place)
            seen = self._look_for_fingers(image, place, gloved=believed)
            if seen is not None or believed:
                found.append(seen or SeenHand.at(place))
        return found

    def _detect(self, image: Image) -> Iterator[SeenHand]:
        """Yield untracked hands: every few frames, by the palm detector or the finder in turn."""
        if not self._is_due():
            return
        self._turn += 1
        if self.finder is not None and not self._tracked and self._turn % 2 == 0:
            parts = parts_of(image)
            yield from self._search_places(image, [parts[self._turn // 2 % len(parts)]])
            return
        look = self.model.find if self._search == "pose" else self.model.look
        for region in self._detect_palms(image):
            seen = look(image, region)
            if seen is not None:
                yield seen

    def complete(
        self,
        image: Image,
        followed: tuple[SeenHand, ...],
        bodies: Sequence[Body],
        time: float = 0.0,
    ) -> FrameLandmarks:
        """Return the hands in `image`, and the bodies with their wrists at these hands.

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
        self._bodies, self._time = tuple(bodies), time
        self._free = (
            [(body, side) for body in bodies for side in SIDES] if self._search == "pose" else []
        )
        self._arms = self._paces.update(self._free, time) if self._free else []
        return self._finish(image, followed)

    def _finish(self, image: Image | None, followed: tuple[SeenHand, ...]) -> FrameLandmarks:
        """Assign hands to the arms of this frame; without an image nothing is searched."""
        if self._free:
            seen = self._on_arms(image, followed)
        else:
            alone = [replace(one, arm=None, carried=False) for one in followed]
            seen, self._until_palms = self._most_believed(alone), 0
        self._tracked = tuple(one for one in seen if one.following.usable)
        bodies = [
            move_wrists(body, self._arms[2 * place : 2 * place + 2])
            for place, body in enumerate(self._bodies)
        ]
        hands = sorted(seen, key=lambda one: -one.hand.size)
        return FrameLandmarks(
            bodies[0] if bodies else None,
            tuple(one.hand for one in hands if one.shows_fingers),
            tuple(bodies[1:]),
            tuple(one.hand for one in hands if not one.shows_fingers),
        )

    def _is_due(self) -> bool:
        """Return whether untracked hands are looked for in this frame, where some may be."""
        if sum(one.hand.score >= SURE for one in self._tracked) >= self._most:
            return False
        self._until_palms -= 1
        if self._until_palms >= 0:
            return False
        self._until_palms = PALM_PAUSE - 1
        return True

    def _detect_palms(self, image: Image) -> list[Region]:
        """Return the regions of palms that are not tracked yet."""
        tracked = [one.following for one in self._tracked]
        proposals = [region_of_palm(palm) for palm in self._palms.detect(image)[: self._most]]
        return [
            proposal
            for proposal in proposals
            if proposal.usable
            and not any(proposal.overlap(region) > SAME_REGION for region in tracked)
        ]

    def _on_arms(self, image: Image | None, followed: tuple[SeenHand, ...]) -> tuple[SeenHand, ...]:
        """Assign each arm the hand at its end, searching there if none with fingers was followed.

        Of two hands at one arm, the one with the lower score is dropped. Hands at no arm (of
        people whose body is not seen, or where the pose is wrong) compete with those at the arms by
        score; such an arm's wrist goes to its hand.
        """
        free, paces = self._free, self._arms
        carried = [one.carry() if one.carried else one for one in followed]
        arms, elsewhere = _sort_by_arm(carried, free)
        self._search_arms(image, arms)
        elsewhere = [one for one in elsewhere if not _known(one, arms.values())]
        at_arms = [replace(one, arm=paces[place], carried=False) for place, one in arms.items()]
        alone = [replace(one, arm=None, carried=False) for one in elsewhere]
        far = _find_far_arms(elsewhere, free, arms, paces)
        for place, pace in enumerate(paces):
            found = arms.get(place) or far.get(place)
            pace.steer(found.hand if found else None, self._paces.seconds, parted=place in far)
        return self._most_believed((*at_arms, *alone))

    def _most_believed(self, seen: Iterable[SeenHand]) -> tuple[SeenHand, ...]:
        return tuple(_by_belief(seen)[: self._most])

    def _search_arms(self, image: Image | None, arms: dict[int, SeenHand]) -> None:
        """Search the arms that are due, and add what is found to the hands by their arm."""
        time = self._time
        for place, ((body, side), pace) in enumerate(zip(self._free, self._arms, strict=True)):
            one = arms.get(place)
            if one is not None and one.shows_fingers:
                pace.read = pace.read if one.carried else time
                pace.misses = 0
            elif image is not None and pace.is_due(time):
                pace.read = time
                rarer = LOST_FACTOR if pace.misses > LONG_LOST else 1
                with_forearm = time - pace.forearm_searched >= rarer * FOREARM_SECONDS
                if with_forearm:
                    pace.forearm_searched = time
                with_glove = pace.is_held_up and (with_forearm or rarer == 1)
                seen = self._search_arm(image, body, side, with_forearm, with_glove)
                others = [hand for at, hand in arms.items() if at != place]
                if seen is not None and not _known(seen, others):
                    arms[place] = seen
                    pace.misses = 0
                else:
                    pace.misses += 1

    def _search_arm(
        self, image: Image, body: Body, side: Side, with_forearm: bool, with_glove: bool
    ) -> SeenHand | None:
        """Return the hand at the end of an arm, from the pose's fingers, or from its forearm."""
        region = region_of_wrist(body, side)
        if region is not None:
            for gloved in (False, True) if with_glove and not is_doubtful(body, side) else (False,):
                seen = self.model.find(image, region, gloved=gloved)
                if seen is not None and wrist_distance(seen.hand, body, side) <= REACH:
                    return seen
        for region in regions_of_forearm(body, side) if with_forearm else ():
            seen = self.model.find(image, region)
            if seen is not None and wrist_distance(seen.hand, body, side) <= FOREARM_REACH:
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
        if not near:
            elsewhere.append(one)
    return arms, elsewhere


def _find_far_arms(
    elsewhere: Iterable[SeenHand],
    free: Sequence[Arm],
    arms: Mapping[int, SeenHand],
    paces: Sequence[ArmPace],
) -> dict[int, SeenHand]:
    """Assign hands that are away from all arms to arms without a hand, whose pose is then wrong.

    An arm keeps the hand that it had in the frame before, where that one is still the nearest to
    its wrist as it was.
    """
    far: dict[int, SeenHand] = {}
    for one in elsewhere:
        vacant = [place for place in range(len(free)) if place not in arms and place not in far]
        if not one.shows_fingers:
            vacant = [place for place in vacant if is_doubtful(*free[place])]
        kept = [place for place in vacant if paces[place].has(one.hand)]
        among = kept or vacant
        found = find_far_arm(one.hand, [free[place] for place in among])
        if found is not None:
            far[among[found]] = one
    return far


def _by_belief(seen: Iterable[SeenHand]) -> list[SeenHand]:
    """Return hands with their fingers before those without, and each by score."""
    return sorted(seen, key=lambda one: (not one.shows_fingers, -one.hand.score))


def _known(seen: SeenHand, others: Iterable[SeenHand]) -> bool:
    return any(_is_same(seen, one) for one in others)


def _is_same(one: SeenHand, other: SeenHand) -> bool:
    if one.shows_fingers and other.shows_fingers:
        return find_duplicates(one.hand, other.hand)
    apart = np.nanmean(one.hand.xy, axis=0) - np.nanmean(other.hand.xy, axis=0)
    return bool(np.linalg.norm(apart) < SAME_PLACE * max(one.hand.size, other.hand.size))
