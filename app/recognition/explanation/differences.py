"""Differences: the ways in which a query differs from the expected gesture, with time and joint.

Each kind is tested by undoing it: the query is reversed, shown with the other hand, cut short, and
compared again. The share of a difference is the part of the path distance that this removes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from app.recognition.decision.motion_references import CLEARLY_SLOWER
from app.recognition.explanation.divergence import find_divergence
from app.recognition.explanation.pairing import ALIKE, Pairing
from app.recognition.features.motion import STEPS, build_movement, list_limbs
from app.recognition.features.trajectory_image import MIN_EXTENT
from app.recognition.poses.gaps import MAX_GAP_SECONDS
from app.recognition.poses.landmarks import other_side
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.side_swaps import find_side_swaps, swap_sides
from app.recognition.text.wording import humanize
from app.recognition.voters.motion.wrist_bend import WristBend

Kind = Literal[
    "exchanged_sides", "direction", "hand", "side", "missing", "extra", "shape",
    "tempo", "place", "size", "wrist", "unseen", "hand_shape",
]  # fmt: skip
"""Kinds: left and right exchanged by the pose model; opposite direction; other hand; mirror image;
a part missing or added; another shape; slower or quicker; another place beside the body; larger or
smaller; another bend of the wrist; not seen for a while; a finger, or the turn of a held
hand."""

DIFFERENT = 1.4 * ALIKE
"""Least path distance of a difference: clearly beyond that of two people's takes of one figure."""

LEAST_SHARE = 0.5
"""Least share of the distance that a difference must explain to be reported."""

CUTS = tuple(range(STEPS // 8, STEPS // 2 + 1, 2))
"""Steps of 32 that may be missing or added at either end: from an eighth, the shortest stroke, to a
half, beyond which the rest is no longer most of the gesture."""

AS_GOOD = 1.07
"""Factor on the least distance up to which a smaller cut is preferred."""

ELSEWHERE = 0.5
"""Torso lengths between the mean positions from which the place differs: half a forearm, twice the
difference between two people's takes."""

CLEARLY_LARGER = 1.0
"""Doublings of the size from which it differs; two people differ by a third of one."""

BENT_OTHERWISE = 1.5
"""Distance by `WristBend` from which the bend differs: three times
the difference between two people's takes of one gesture."""


@dataclass(frozen=True, kw_only=True)
class Difference:
    """One way in which a query differs from the expected gesture.

    Attributes
    ----------
    kind
        See `Kind`.
    share
        In [0, 1]: the part of the path distance, beyond that between takes of one figure, that
        undoing the difference removes; for a hand shape, the part of the distance between the
        shapes. 0 for differences that change no path: tempo, place, size, the wrist, not seen.
    landmark
        The landmark that differs most; None: all of them.
    start, end
        Seconds in the query's clock; None: throughout. For a missing part, `start` equals `end`.
    words
        The difference as a clause.

    """

    kind: Kind
    share: float
    landmark: str | None
    start: float | None
    end: float | None
    words: str

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        return dict(vars(self))


def find_differences(pairing: Pairing, *, sees_direction: bool) -> tuple[Difference, ...]:
    """Find the differences between a query and a gesture, those with the largest share first.

    Parameters
    ----------
    pairing
        The query and the gesture.
    sees_direction
        Whether the voters distinguish directions; shape voters do not.

    """
    found: list[Difference] = []
    if pairing.base > DIFFERENT:
        turned = _try_reversal(pairing) if sees_direction else ()
        undone = [*_try_side_swap(pairing), *turned, *_try_other_side(pairing), *_try_cuts(pairing)]
        found = [difference for difference in undone if difference.share >= LEAST_SHARE]
        # A reversed circle is also its mirror image: of equal shares the first is most likely.
        found = sorted(found, key=lambda difference: -round(difference.share, 1))
        found = found or [_find_shape_difference(pairing)]
    if found and found[0].kind == "exchanged_sides":
        return tuple(found)  # place and size of such a path are meaningless
    beside = [*_find_unseen(pairing), *_compare_places(pairing), *_compare_sizes(pairing)]
    if sees_direction:
        beside += [*_check_traversal(pairing), *_compare_wrists(pairing)]
    return (*found, *beside, *_compare_tempo(pairing))


def _try_side_swap(pairing: Pairing) -> Iterator[Difference]:
    """Undo side swaps of the pose model that were not repaired."""
    seen = pairing.trajectory
    changed = find_side_swaps(seen).exchanged
    if not changed.any():
        return
    right = replace(seen, xy=swap_sides(seen.xy, seen.landmarks, changed))
    paths = build_movement(right, pairing.landmarks).paths
    left = pairing.distance(paths, pairing.paths_begun_anywhere())
    times = pairing.trajectory.time[changed] + pairing.start
    yield Difference(
        kind="exchanged_sides",
        share=pairing.share(left),
        landmark=None,
        start=float(times[0]),
        end=float(times[-1]),
        words=(
            f"left and right were exchanged in {changed.sum()} of {len(changed)} "
            f"moments between {times[0]:.1f} and {times[-1]:.1f} s"
        ),
    )


def _try_reversal(pairing: Pairing) -> Iterator[Difference]:
    """Reverse the query."""
    backward = not pairing.example.traversal.backward
    left = pairing.distance(pairing.query.paths, pairing.paths_begun_anywhere(backward=backward))
    yield _make_difference(pairing, "direction", left, "it goes in the opposite direction")


def _check_traversal(pairing: Pairing) -> Iterator[Difference]:
    """Yield a difference if the gesture is nearest when traversed backwards."""
    if pairing.example.traversal.backward:
        words = "it goes in the opposite direction, which multiplies the distance by 1.5"
        yield _make_side_difference("direction", _find_busiest(pairing), None, None, words)


def _try_other_side(pairing: Pairing) -> Iterator[Difference]:
    """Exchange the query's hands, mirror it, or both."""
    counterparts = [other_side(name) for name in pairing.landmarks]
    paths, mirror = pairing.query.paths, np.array([-1.0, 1.0])
    examples = pairing.paths_begun_anywhere()
    left = pairing.distance(paths * mirror, examples)
    yield _make_difference(pairing, "side", left, "it is shown as its mirror image")
    if set(counterparts) == set(pairing.landmarks):
        swapped = paths[:, [pairing.landmarks.index(name) for name in counterparts]]
        left = pairing.distance(swapped, examples)
        yield _make_difference(pairing, "hand", left, "it is shown with the other hand")
        left = pairing.distance(swapped * mirror, examples)
        words = "it is shown with the other hand, as its mirror image"
        yield _make_difference(pairing, "hand", left, words)


def _make_difference(pairing: Pairing, kind: Kind, left: float, words: str) -> Difference:
    return Difference(
        kind=kind,
        share=pairing.share(left),
        landmark=_find_busiest(pairing),
        start=pairing.seconds(0),
        end=pairing.seconds(-1),
        words=words,
    )


def _try_cuts(pairing: Pairing) -> Iterator[Difference]:
    """Cut off either end of the gesture or of the query."""
    query, example = pairing.query.paths, pairing.example.movement.paths
    for at_end in (True, False):
        steps, left = _find_best_cut(pairing, query, example, at_end)
        moment = pairing.seconds(-1 if at_end else 0)
        ends = pairing.example.time[[-steps, -1] if at_end else [0, steps - 1]]
        yield Difference(
            kind="missing",
            share=pairing.share(left),
            landmark=_find_busiest(pairing),
            start=moment,
            end=moment,
            words=(
                f"the {'last' if at_end else 'first'} {_format_percent(steps)} of "
                f"{pairing.example.label!r} ({min(ends):.1f} to {max(ends):.1f} s of its "
                f"demonstration) is missing {'after' if at_end else 'before'} {moment:.1f} s"
            ),
        )
        steps, left = _find_best_cut(pairing, example, query, at_end)
        span = (STEPS - steps, STEPS - 1) if at_end else (0, steps - 1)
        start, end = (pairing.seconds(step) for step in span)
        yield Difference(
            kind="extra",
            share=pairing.share(left),
            landmark=_find_busiest(pairing),
            start=start,
            end=end,
            words=(
                f"the movement from {start:.1f} to {end:.1f} s is no part of "
                f"{pairing.example.label!r}"
            ),
        )


def _find_best_cut(
    pairing: Pairing, whole: FloatArray, cut: FloatArray, at_end: bool
) -> tuple[int, float]:
    """Find how many steps to cut off to match the other movement, and the distance left.

    No cut is returned if cutting both leaves less: then the parts differ, and none is missing.
    """
    rests, others = (
        [_stretch(path[: STEPS - steps] if at_end else path[steps:]) for steps in CUTS]
        for path in (cut, whole)
    )
    left = [
        alone if alone <= pairing.distance(other, [rest]) else np.inf
        for rest, other in zip(rests, others, strict=True)
        for alone in (pairing.distance(whole, [rest]),)
    ]
    first = next(index for index, each in enumerate(left) if each <= AS_GOOD * min(left))
    return CUTS[first], left[first]


def _stretch(paths: FloatArray) -> FloatArray:
    """Resample ``(n, L, 2)`` equal steps to `STEPS` of them."""
    at = np.linspace(0, len(paths) - 1, STEPS)
    before = np.minimum(at.astype(np.intp), len(paths) - 2)
    share = (at - before)[:, None, None]
    return np.asarray(paths[before] * (1 - share) + paths[before + 1] * share)


def _format_percent(steps: int) -> str:
    return f"{100 * steps / STEPS:.0f} %"


def _find_shape_difference(pairing: Pairing) -> Difference:
    """Return where the paths differ most, if nothing that was undone explains the distance."""
    parted = find_divergence(pairing)
    where = f"where {pairing.example.label!r} {parted.expected}"
    if parted.shown == parted.expected:
        where = f"as in {pairing.example.label!r}, but on another path"
    return Difference(
        kind="shape",
        share=parted.share,
        landmark=parted.landmark,
        start=parted.start,
        end=parted.end,
        words=(
            f"from {parted.start:.1f} to {parted.end:.1f} s the {humanize(parted.landmark)} "
            f"{parted.shown} {where}"
        ),
    )


def _find_busiest(pairing: Pairing) -> str:
    """Return the landmark that moves most in the gesture."""
    moved = (pairing.example.movement.paths**2).sum(axis=(0, 2))
    return pairing.landmarks[int(moved.argmax())]


def _find_unseen(pairing: Pairing) -> Iterator[Difference]:
    """Yield salient landmarks that were not seen for longer than a bridged gap."""
    trajectory = pairing.trajectory
    for name in pairing.landmarks:
        if name not in trajectory.landmarks:
            continue
        seen = np.isfinite(trajectory.select([name]).xy).all(axis=(1, 2))
        known = np.concatenate([[0.0], trajectory.time[seen], trajectory.time[-1:]])
        gap = int(np.diff(known).argmax())
        start, end = known[gap] + pairing.start, known[gap + 1] + pairing.start
        if end - start > MAX_GAP_SECONDS:
            words = f"the {humanize(name)} was not seen from {start:.1f} to {end:.1f} s"
            yield _make_side_difference("unseen", name, float(start), float(end), words)


def _compare_places(pairing: Pairing) -> Iterator[Difference]:
    name = _find_busiest(pairing)
    units = {pairing.trajectory.unit, pairing.gesture.unit}
    here, there = (_mean_place(each, name) for each in (pairing.trajectory, pairing.gesture))
    apart = here - there
    if units != {"torso_length"} or not np.hypot(*apart) > ELSEWHERE:
        return
    words = f"it is shown {np.hypot(*apart):.1f} torso lengths {_describe_offset(apart)}"
    yield _make_side_difference("place", name, None, None, words)


def _mean_place(trajectory: Trajectory, name: str) -> FloatArray:
    path = trajectory.select([name]).xy[:, 0]
    known = path[np.isfinite(path).all(axis=1)]
    return np.asarray(known.mean(axis=0) if len(known) else np.full(2, np.nan))


def _describe_offset(apart: FloatArray) -> str:
    """Return the direction of ``(2,)`` in the image, in words."""
    x, y = apart
    if abs(y) >= abs(x):
        return "lower" if y > 0 else "higher"
    return "farther to the image's right" if x > 0 else "farther to the image's left"


def _compare_sizes(pairing: Pairing) -> Iterator[Difference]:
    sizes = [
        float(np.sqrt((paths**2).sum(axis=(1, 2)).mean()))
        for paths in (pairing.query.paths, pairing.example.movement.paths)
    ]
    units = {pairing.trajectory.unit, pairing.gesture.unit}
    if units != {"torso_length"} or min(sizes) < MIN_EXTENT:
        return
    doublings = float(np.log2(sizes[0] / sizes[1]))
    if abs(doublings) > CLEARLY_LARGER:
        how = f"{2 ** abs(doublings):.1f} times {'larger' if doublings > 0 else 'smaller'}"
        yield _make_side_difference("size", None, None, None, f"it is shown {how}")


def _compare_wrists(pairing: Pairing) -> Iterator[Difference]:
    """Yield a difference for each wrist that is bent differently, with the degrees."""
    voter = WristBend()
    shown, expected = (
        voter.describe(each).reshape(-1, 1, 3) for each in (pairing.query, pairing.example.movement)
    )
    bones = list_limbs(pairing.landmarks)
    wrists = dict.fromkeys(inner for inner, _ in bones if inner.endswith("wrist"))
    for wrist, here, there in zip(wrists, shown, expected, strict=True):
        distance = float(voter.distances(here, there)[0])
        if np.isfinite(distance) and distance > BENT_OTHERWISE:
            # The mean of sines is within 1 except for rounding errors.
            bends = np.degrees(np.arcsin(np.clip([here[0, 0], there[0, 0]], -1, 1)))
            apart = float(bends[0] - bends[1])
            words = (
                f"the {humanize(wrist)} is bent {abs(apart):.0f} degrees farther "
                f"{'clockwise' if apart > 0 else 'counter-clockwise'} than for "
                f"{pairing.example.label!r}"
            )
            yield _make_side_difference("wrist", wrist, None, None, words)


def _compare_tempo(pairing: Pairing) -> Iterator[Difference]:
    shown, expected = pairing.query.duration, pairing.example.movement.duration
    if min(shown, expected) <= 0:
        return
    doublings = float(np.log2(shown / expected))
    if abs(doublings) > CLEARLY_SLOWER:
        how = f"{2 ** abs(doublings):.1f} times {'slower' if doublings > 0 else 'quicker'}"
        yield _make_side_difference("tempo", None, None, None, f"it is shown {how} ({shown:.1f} s)")


def _make_side_difference(
    kind: Kind, landmark: str | None, start: float | None, end: float | None, words: str
) -> Difference:
    return Difference(kind=kind, share=0.0, landmark=landmark, start=start, end=end, words=words)
