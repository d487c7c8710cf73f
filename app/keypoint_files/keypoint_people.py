"""Keypoints by number: their names by their known set, and the one of several people to follow."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePath
from typing import Final

import numpy as np
from typing_extensions import Unpack

from app.keypoint_files.keypoint_table import (
    MOST_PEOPLE,
    Facts,
    KeypointOptions,
    KeypointTable,
    Times,
    hands_of,
    mask_unseen,
    visibility_of,
)
from app.recognition.errors import KeypointFileError
from app.recognition.poses.frame import Hand, Side
from app.recognition.poses.landmarks import HAND_LANDMARKS, HIPS, POSE_LANDMARKS, SHOULDERS
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.skeletons import (
    KEYPOINT_SETS,
    KeypointSet,
    find_keypoint_set,
)
from app.recognition.recording.people import Choice, People, SeenPerson
from app.recognition.recording.salute import best_salute

FACE: Final = frozenset(POSE_LANDMARKS[:11])
"""Landmarks that are close together, on every body: nose, eyes, ears and mouth."""

LARGEST_FACE: Final = 0.35
"""Largest share of a body's extent that is within a face, also without legs in view."""

LARGEST_SLIP: Final = 0.25
"""Largest distance of a neck from the middle of the shoulders, in their width and a quarter of the
body's extent: models find it a few hundredths off, and the width is small from the side. Of a hand
from its wrist, in half of the body's extent: the other wrist is further away."""

LEAST_HAND: Final = 0.3
"""Least mean score of a hand among a whole body's keypoints: its model places both hands always."""


@dataclass(frozen=True, eq=False)
class Person:
    """One person in one frame.

    Attributes
    ----------
    points
        ``(N, 3)`` x, y and score; NaN, or a score of 0: not seen. A score of NaN is unknown.
    hands
        ``(21, 3)`` of each hand that the file has beside the body.

    """

    points: FloatArray
    hands: Mapping[Side, FloatArray] = field(default_factory=dict)

    @property
    def xy(self) -> FloatArray:
        """``(N, 2)``; NaN: not seen."""
        return mask_unseen(self.points[:, :2], visibility_of(self.points))

    @property
    def score(self) -> float:
        """Mean score of the keypoints."""
        return float(visibility_of(self.points).mean())

    def find_hands(self, kind: KeypointSet) -> tuple[Hand, ...]:
        """Return the hands of which all keypoints are seen, larger first."""
        within = {side: self.points[first:] for side, first in kind.hands.items()}
        found = {
            side: points[: len(HAND_LANDMARKS)] for side, points in {**within, **self.hands}.items()
        }
        whole = [
            side
            for side, points in found.items()
            if len(points) == len(HAND_LANDMARKS)
            and (side in self.hands or visibility_of(points).mean() >= LEAST_HAND)
        ]
        if not whole:
            return ()
        hands = hands_of(np.concatenate([found[side] for side in whole])[None], whole)
        return () if hands is None else hands[0]


def name_points(
    numbers: Sequence[str],
    path: Path,
    options: KeypointOptions,
    called: str = "",
    names: Sequence[str] = (),
) -> KeypointSet:
    """Return the set of a file's keypoints, whose numbers the user's own names replace.

    Parameters
    ----------
    numbers
        Numbers of the keypoints.
    path, options
        The file, for messages, and the names given by the user.
    called, names
        Name of the set and of its keypoints, if the file gives them.

    Raises
    ------
    KeypointFileError
        When nothing tells which keypoints these are: an order is never guessed.

    """
    count = len(numbers)
    if set(options.landmarks) & set(numbers):
        return KeypointSet("", tuple(numbers))
    if names and len(names) != count:
        raise KeypointFileError(
            f"{path} names {len(names)} keypoints and has {count}; export it again"
        )
    found = find_keypoint_set(count, options.keypoint_set or called, names)
    if options.keypoint_set is not None:
        words = re.sub(r"[^a-z0-9]", "", options.keypoint_set.lower())
        if found is None or words not in found.words:
            known = ", ".join(sorted({word for each in KEYPOINT_SETS for word in each.words}))
            raise KeypointFileError(
                f"{path}: no set of {count} keypoints is called {options.keypoint_set!r}; there "
                f"are {known}"
            )
        return replace(found, by_count=False)  # the user is believed
    if names and (found is None or not found.hands):
        return KeypointSet("", tuple(names))
    if found is None or not is_numbered(numbers):
        known = ", ".join(
            f"{len(each.landmarks)} ({each.title})" for each in KEYPOINT_SETS if each.by_count
        )
        raise _unnamed(path, count, f"and their order is known only of {known}")
    return found


def is_numbered(names: Sequence[str]) -> bool:
    """Return whether names are the numbers from 0 or 1 on, in order."""
    return any(
        list(names) == [str(first + place) for place in range(len(names))] for first in (0, 1)
    )


def _unnamed(path: Path, count: int, why: str) -> KeypointFileError:
    return KeypointFileError(
        f"{path} has {count} keypoints without names, {why}; name them in the file (categories, or "
        'meta_info with "dataset_name": "h36m" or "crowdpose"), or say which they are, as in '
        "--keypoints body25 or --landmark 10=right_wrist"
    )


def table_of(
    kind: KeypointSet,
    points: FloatArray,
    times: Times,
    path: Path,
    hands: tuple[tuple[Hand, ...], ...] | None = None,
    *,
    named: bool = False,
    **facts: Unpack[Facts],
) -> KeypointTable:
    """Create the table of one person.

    Parameters
    ----------
    kind
        Set of the keypoints.
    points
        ``(T, N, 3)``: x, y and visibility; NaN: unknown.
    times
        Times of the frames.
    path
        The file, for messages.
    hands
        Hands of each frame; None: those of the set, if it has some.
    named
        Whether the file names the set.
    facts
        What else the table tells.

    Raises
    ------
    KeypointFileError
        When the keypoints are not in the order of their set.

    """
    kind = _verify(kind, points, path, named=named)
    if hands is None and kind.hands:
        hands = tuple(Person(row).find_hands(kind) for row in points)
    kept = [place for place, name in enumerate(kind.landmarks) if name is not None]
    known = bool(np.isfinite(points[..., 2]).any())
    confidence = visibility_of(points[:, kept]) if known else None
    return KeypointTable(
        names=tuple(name for name in kind.landmarks if name is not None),
        xy=mask_unseen(points[:, kept, :2], confidence),
        confidence=confidence,
        times=times,
        hands=hands,
        **facts,
    )


def _verify(kind: KeypointSet, points: FloatArray, path: Path, *, named: bool) -> KeypointSet:
    """Return the set of which keypoints without names are, by where they lie.

    Raises
    ------
    KeypointFileError
        When they do not lie as in the set, or in neither of two sets of their number.

    """
    if not kind.title or not kind.by_count:
        return kind
    count = len(kind.landmarks)
    sets = [each for each in KEYPOINT_SETS if each.by_count and len(each.landmarks) == count]
    agreeing = [each for each in sets if _agrees(each, points)]
    if agreeing:
        return kind if kind in agreeing else agreeing[0]
    # A file that names its set, as OpenPose's do, is believed unless its keypoints contradict.
    if (named or len(sets) == 1) and _agrees(kind, points) is None:
        return kind
    titles = " or ".join(each.title for each in sets)
    raise _unnamed(path, count, f"and they do not lie as those of {titles} do")


def _agrees(kind: KeypointSet, points: FloatArray) -> bool | None:
    """Return whether keypoints lie as in a set; None where nothing that decides is seen.

    A face is small, the neck is between the shoulders, the middle of the hips
    between these, and hands begin at their wrists.
    """
    xy = mask_unseen(points[..., :2], visibility_of(points))
    place = {name: at for at, name in enumerate(kind.landmarks) if name}
    xy = xy[2 * np.isfinite(xy[:, list(place.values()), 0]).sum(axis=1) > len(place)]
    if not len(xy):
        return None
    body, face = xy[:, list(place.values())], xy[:, [place[name] for name in place if name in FACE]]
    extent = np.linalg.norm(np.nanmax(body, axis=1) - np.nanmin(body, axis=1), axis=1)
    apart = [np.linalg.norm(np.ptp(face, axis=1), axis=1) - LARGEST_FACE * extent]
    for middle, pair in zip(kind.middles, (SHOULDERS, HIPS), strict=False):
        one, other = (xy[:, place[name]] for name in pair)
        off = np.linalg.norm(xy[:, middle] - (one + other) / 2, axis=1)
        allowed = LARGEST_SLIP * (np.linalg.norm(one - other, axis=1) + extent / 4)
        apart.append(off - allowed)
    for side, first in kind.hands.items():
        off = np.linalg.norm(xy[:, first] - xy[:, place[f"{side}_wrist"]], axis=1)
        apart.append(off - LARGEST_SLIP * extent / 2)
    known = [each[np.isfinite(each)] for each in apart]
    judged = [bool(np.median(each) <= 0) for each in known if len(each)]
    return all(judged) if judged else None


def table_of_people(
    everybody: Sequence[Sequence[Person]],
    times: Times,
    path: Path,
    options: KeypointOptions,
    called: str = "",
    names: Sequence[str] = (),
    **facts: Unpack[Facts],
) -> KeypointTable:
    """Create the table of the person who salutes, or stands out most.

    Parameters
    ----------
    everybody
        People of each frame.
    times
        Times of the frames.
    path, options, called, names
        See `name_points`.
    facts
        What else the table tells; notes about the choice of the person come before its notes.

    Raises
    ------
    KeypointFileError
        When nobody is seen, people have different numbers of keypoints, or `name_points` or
        `table_of` refuse.

    """
    if not any(everybody):
        raise KeypointFileError(f"{path}: nobody is seen in any of {len(everybody)} frames")
    sizes = sorted({len(one.points) for persons in everybody for one in persons})
    if len(sizes) > 1:
        raise KeypointFileError(
            f"{path} mixes people of {' and '.join(map(str, sizes))} keypoints; find them with one "
            "model in all frames"
        )
    kind = name_points([*map(str, range(sizes[0]))], path, options, called, names)
    beside = bool(kind.hands) or any(one.hands for persons in everybody for one in persons)
    nobody = Person(np.full((sizes[0], 3), np.nan))
    if max(map(len, everybody)) > 1:
        everybody, choice = _choose_person(everybody, kind, times, options)
        facts["notes"] = choice.notes + facts.get("notes", ())
        facts.setdefault("people", choice.count)
    followed = [persons[0] if persons else nobody for persons in everybody]
    points = np.stack([one.points for one in followed])
    hands = tuple(one.find_hands(kind) for one in followed) if beside else None
    return table_of(kind, points, times, path, hands, named=bool(called), **facts)


def _choose_person(
    everybody: Sequence[Sequence[Person]],
    kind: KeypointSet,
    times: Times,
    options: KeypointOptions,
) -> tuple[list[list[Person]], Choice]:
    """Return the one person in each frame, if they are seen, and the choice of them."""
    people, seen = People(), []
    seconds = times.values / (options.nominal_rate if times.counted else 1.0)
    for persons, time in zip(everybody, seconds.tolist(), strict=True):
        # By score, so that the work for a frame is bounded.
        shown = [one for one in persons if np.isfinite(one.xy).any()]
        seen.append(sorted(shown, key=lambda one: -one.score)[:MOST_PEOPLE])
        people.add(
            time,
            [SeenPerson(one.xy, one.score, best_salute(one.find_hands(kind))) for one in seen[-1]],
        )
    choice = people.choose()
    followed = [
        [] if place is None else [persons[place]]
        for persons, place in zip(seen, choice.index, strict=True)
    ]
    return followed, choice


def tell_track(count: int, name: str) -> tuple[str, ...]:
    """Return a note on the track that is followed, if there are several."""
    followed = f"of {count} people track {name!r} stands out most and is followed"
    return (followed,) if count > 1 else ()


def frame_number(name: str) -> int | None:
    """Return the number of a frame in the name of its file or image: the last one; else None."""
    digits = re.search(r"(\d{1,15})\D*$", PurePath(name).stem)
    return None if digits is None else int(digits[1])
