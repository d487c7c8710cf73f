"""Differences: in what way a query is not the gesture that was expected, where and when.

Each kind is tried by undoing it: the query is turned round, shown with the other hand, cut short,
and compared again. What that takes away of the distance between the paths is the difference's
share.
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
from app.recognition.poses.landmarks import other_side
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import MAX_GAP_SECONDS, Trajectory
from app.recognition.preprocessing.side_swaps import find_side_swaps, swap_sides
from app.recognition.text.wording import humanize
from app.recognition.voters.motion.wrist_bend import WristBend

Kind = Literal[
    "exchanged_sides", "direction", "hand", "side", "missing", "extra", "shape",
    "tempo", "place", "size", "wrist", "unseen",
]  # fmt: skip
"""In what way: left and right exchanged by the pose model; the other way round; with the other
hand; as its mirror image; a part missing, or too much; another course; slower or quicker; elsewhere
beside the body; larger or smaller; with the wrist bent otherwise; not seen for a while."""

DIFFERENT = 2 * ALIKE
"""Path distance from which a query's path is told to differ: twice what two people's takes of one
figure differ by. Of plausible takes by another person a third lie beyond it."""

LEAST_SHARE = 0.5
"""Share of the distance that undoing a difference must take away for it to be named: what it
explains is then more than what remains."""

CUTS = tuple(range(STEPS // 8, STEPS // 2 + 1, 2))
"""Steps of 32 that may be missing or too many at either end: from an eighth, the least that is a
stroke of its own, to a half, beyond which the rest is no longer most of the gesture."""

AS_GOOD = 1.15
"""Factor on the least distance up to which a smaller cut is as good: a little less than the least
difference that people see in a figure, a fifth."""

ELSEWHERE = 0.5
"""Torso lengths between the mean places from which a gesture is shown elsewhere: raised or lowered
by more than a forearm's half; where people show the same, they differ by half of that."""

CLEARLY_LARGER = 1.0
"""Doublings of the size from which it is told; two people differ by a third of one."""

BENT_OTHERWISE = 1.5
"""Distance by `WristBend` from which a wrist is told to be bent otherwise: about the threshold of
that voter, three times what two people's takes of one gesture differ by."""


@dataclass(frozen=True, kw_only=True)
class Difference:
    """One way in which a query is not the expected gesture.

    Attributes
    ----------
    kind
        See `Kind`.
    share
        In [0, 1]: of the distance between the paths, beyond what takes of one figure differ by,
        what undoing it takes away; 0 for what is told beside it and changes no path: tempo,
        place, size, the wrist, what was not seen.
    landmark
        The joint concerned most; None: all of them.
    start, end
        Seconds of the query's clock between which it lies; None: throughout. What is missing lies
        where `start` is `end`.
    words
        A clause for people.

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
    """Tell in what ways a query is not a gesture, the most telling first.

    Parameters
    ----------
    pairing
        The two.
    sees_direction
        Whether the voters can tell one way round from the other; to those that see drawings both
        are the same.

    """
    found: list[Difference] = []
    if pairing.base > DIFFERENT:
        turned = _turned(pairing) if sees_direction else ()
        undone = [*_exchanged(pairing), *turned, *_on_the_other_side(pairing), *_cut(pairing)]
        found = [difference for difference in undone if difference.share >= LEAST_SHARE]
        # A circle turned round is its mirror image too: of equals the first is the likeliest.
        found = sorted(found, key=lambda difference: -round(difference.share, 1))
        found = found or [_bent(pairing)]
    if found and found[0].kind == "exchanged_sides":
        return tuple(found)  # where and how large such a path is, says nothing of the gesture
    beside = [*_unseen(pairing), *_elsewhere(pairing), *_otherwise_sized(pairing)]
    if sees_direction:
        beside += [*_read_backwards(pairing), *_bent_otherwise(pairing)]
    return (*found, *beside, *_paced(pairing))


def _exchanged(pairing: Pairing) -> Iterator[Difference]:
    """Put right what the pose model exchanged, unless it was already."""
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
            f"left and right were taken for each other in {changed.sum()} of {len(changed)} "
            f"moments between {times[0]:.1f} and {times[-1]:.1f} s"
        ),
    )


def _turned(pairing: Pairing) -> Iterator[Difference]:
    """Turn the query round."""
    backward = not pairing.example.traversal.backward
    left = pairing.distance(pairing.query.paths, pairing.paths_begun_anywhere(backward=backward))
    yield _throughout(pairing, "direction", left, "it goes the other way round")


def _read_backwards(pairing: Pairing) -> Iterator[Difference]:
    """Tell that the gesture fits only when read backwards."""
    if pairing.example.traversal.backward:
        words = "it goes the other way round, which costs half as much again"
        yield _beside("direction", _busiest(pairing), None, None, words)


def _on_the_other_side(pairing: Pairing) -> Iterator[Difference]:
    """Show the query with the other hand, mirrored, or both."""
    counterparts = [other_side(name) for name in pairing.landmarks]
    paths, mirror = pairing.query.paths, np.array([-1.0, 1.0])
    examples = pairing.paths_begun_anywhere()
    left = pairing.distance(paths * mirror, examples)
    yield _throughout(pairing, "side", left, "it is shown as its mirror image")
    if set(counterparts) == set(pairing.landmarks):
        swapped = paths[:, [pairing.landmarks.index(name) for name in counterparts]]
        left = pairing.distance(swapped, examples)
        yield _throughout(pairing, "hand", left, "it is shown with the other hand")
        left = pairing.distance(swapped * mirror, examples)
        words = "it is shown with the other hand, as its mirror image"
        yield _throughout(pairing, "hand", left, words)


def _throughout(pairing: Pairing, kind: Kind, left: float, words: str) -> Difference:
    return Difference(
        kind=kind,
        share=pairing.share(left),
        landmark=_busiest(pairing),
        start=pairing.seconds(0),
        end=pairing.seconds(-1),
        words=words,
    )


def _cut(pairing: Pairing) -> Iterator[Difference]:
    """Cut either end off the gesture, or off the query."""
    query, example = pairing.query.paths, pairing.example.movement.paths
    for at_end in (True, False):
        steps, left = _best_cut(pairing, query, example, at_end)
        moment = pairing.seconds(-1 if at_end else 0)
        ends = pairing.example.time[[-steps, -1] if at_end else [0, steps - 1]]
        yield Difference(
            kind="missing",
            share=pairing.share(left),
            landmark=_busiest(pairing),
            start=moment,
            end=moment,
            words=(
                f"the {'last' if at_end else 'first'} {_percent(steps)} of "
                f"{pairing.example.label!r} ({min(ends):.1f} to {max(ends):.1f} s of its "
                f"demonstration) is missing {'after' if at_end else 'before'} {moment:.1f} s"
            ),
        )
        steps, left = _best_cut(pairing, example, query, at_end)
        span = (STEPS - steps, STEPS - 1) if at_end else (0, steps - 1)
        start, end = (pairing.seconds(step) for step in span)
        yield Difference(
            kind="extra",
            share=pairing.share(left),
            landmark=_busiest(pairing),
            start=start,
            end=end,
            words=(
                f"what is shown from {start:.1f} to {end:.1f} s is no part of "
                f"{pairing.example.label!r}"
            ),
        )


def _best_cut(
    pairing: Pairing, whole: FloatArray, cut: FloatArray, at_end: bool
) -> tuple[int, float]:
    """Find how many steps to cut off so that the rest is the whole of the other: with what left.

    Where it leaves less to cut both, the one has something else there, not nothing: no cut is good.
    """
    rests, others = (
        [_stretched(path[: STEPS - steps] if at_end else path[steps:]) for steps in CUTS]
        for path in (cut, whole)
    )
    left = [
        alone if alone <= pairing.distance(other, [rest]) else np.inf
        for rest, other in zip(rests, others, strict=True)
        for alone in (pairing.distance(whole, [rest]),)
    ]
    first = next(index for index, each in enumerate(left) if each <= AS_GOOD * min(left))
    return CUTS[first], left[first]


def _stretched(paths: FloatArray) -> FloatArray:
    """Resample ``(n, L, 2)`` equal steps to `STEPS` of them."""
    at = np.linspace(0, len(paths) - 1, STEPS)
    before = np.minimum(at.astype(np.intp), len(paths) - 2)
    share = (at - before)[:, None, None]
    return np.asarray(paths[before] * (1 - share) + paths[before + 1] * share)


def _percent(steps: int) -> str:
    return f"{100 * steps / STEPS:.0f} %"


def _bent(pairing: Pairing) -> Difference:
    """Tell where the courses part: nothing that was undone explains it."""
    parted = find_divergence(pairing)
    where = f"where {pairing.example.label!r} {parted.expected}"
    if parted.shown == parted.expected:
        where = f"as {pairing.example.label!r} does, but on another course"
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


def _busiest(pairing: Pairing) -> str:
    """Return the landmark that moves most in the gesture."""
    moved = (pairing.example.movement.paths**2).sum(axis=(0, 2))
    return pairing.landmarks[int(moved.argmax())]


def _unseen(pairing: Pairing) -> Iterator[Difference]:
    """Tell of salient joints that were not seen for longer than a gap that is bridged."""
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
            yield _beside("unseen", name, float(start), float(end), words)


def _elsewhere(pairing: Pairing) -> Iterator[Difference]:
    name = _busiest(pairing)
    units = {pairing.trajectory.unit, pairing.gesture.unit}
    here, there = (_mean_place(each, name) for each in (pairing.trajectory, pairing.gesture))
    apart = here - there
    if units != {"torso_length"} or not np.hypot(*apart) > ELSEWHERE:
        return
    words = f"it is shown {np.hypot(*apart):.1f} torso lengths {_where(apart)}"
    yield _beside("place", name, None, None, words)


def _mean_place(trajectory: Trajectory, name: str) -> FloatArray:
    path = trajectory.select([name]).xy[:, 0]
    known = path[np.isfinite(path).all(axis=1)]
    return np.asarray(known.mean(axis=0) if len(known) else np.full(2, np.nan))


def _where(apart: FloatArray) -> str:
    """Name the direction of ``(2,)`` in the image."""
    x, y = apart
    if abs(y) >= abs(x):
        return "lower" if y > 0 else "higher"
    return "farther to the image's right" if x > 0 else "farther to the image's left"


def _otherwise_sized(pairing: Pairing) -> Iterator[Difference]:
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
        yield _beside("size", None, None, None, f"it is shown {how}")


def _bent_otherwise(pairing: Pairing) -> Iterator[Difference]:
    """Return which wrist is bent otherwise, and by how many degrees."""
    voter = WristBend()
    shown, expected = (
        voter.describe(each).reshape(-1, 1, 3) for each in (pairing.query, pairing.example.movement)
    )
    bones = list_limbs(pairing.landmarks)
    wrists = dict.fromkeys(inner for inner, _ in bones if inner.endswith("wrist"))
    for wrist, here, there in zip(wrists, shown, expected, strict=True):
        distance = float(voter.distances(here, there)[0])
        if np.isfinite(distance) and distance > BENT_OTHERWISE:
            # The mean of a sine stays within 1; a rounding error need not.
            bends = np.degrees(np.arcsin(np.clip([here[0, 0], there[0, 0]], -1, 1)))
            apart = float(bends[0] - bends[1])
            words = (
                f"the {humanize(wrist)} is bent {abs(apart):.0f} degrees farther "
                f"{'clockwise' if apart > 0 else 'counter-clockwise'} than for "
                f"{pairing.example.label!r}"
            )
            yield _beside("wrist", wrist, None, None, words)


def _paced(pairing: Pairing) -> Iterator[Difference]:
    shown, expected = pairing.query.duration, pairing.example.movement.duration
    if min(shown, expected) <= 0:
        return
    doublings = float(np.log2(shown / expected))
    if abs(doublings) > CLEARLY_SLOWER:
        how = f"{2 ** abs(doublings):.1f} times {'slower' if doublings > 0 else 'quicker'}"
        yield _beside("tempo", None, None, None, f"it is shown {how} ({shown:.1f} s)")


def _beside(
    kind: Kind, landmark: str | None, start: float | None, end: float | None, words: str
) -> Difference:
    return Difference(kind=kind, share=0.0, landmark=landmark, start=start, end=end, words=words)
