"""Missing salutes: why the report of a clip's quality finds no take between two salutes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from app.recognition.poses.frame import Hand
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.poses.trajectory import TURNED_AWAY, Trajectory
from app.recognition.recording.salute import (
    DROPOUT_SECONDS,
    ENTER_SCORE,
    FEW_HANDS,
    SHORTEST_TAKE,
    find_held,
)


def explain_missing_salutes(
    poses: PoseSequence,
    scores: FloatArray,
    hands: Sequence[Sequence[Hand]],
    without_fingers: int = 0,
    odd: Sequence[str] = (),
) -> Iterator[str]:
    """Yield why a take has no salutes around it, with a remedy; nothing where both were held.

    Parameters
    ----------
    poses
        Of T frames.
    scores
        ``(T,)`` scores of the best hand in each frame.
    hands
        Per frame the hands that were found.
    without_fingers
        Number of the other frames in which the place of a hand was found.
    odd
        What is odd about the file or its clock, and may be the reason.

    """
    if odd and len(find_held(poses.time, scores)) < 2:
        yield f"two salutes were not seen, and something else is odd: {odd[0]}"
        return
    frames, with_hand = len(hands), sum(map(bool, hands))
    seen = with_hand + without_fingers
    facing = Trajectory.from_poses(poses).facing if poses.seen.any() else None
    if scores.max(initial=0.0) > ENTER_SCORE:
        yield from _describe_missed_salute(poses.time, scores, hands)
    elif facing is not None and abs(facing) >= TURNED_AWAY:
        yield (
            f"no salute in any of {frames} frames: the diver is turned {abs(facing):.0f} degrees "
            "away; face the camera"
        )
    elif with_hand < FEW_HANDS * frames <= seen:
        yield (
            f"hands seen in {seen / frames:.0%} of {frames} frames, their fingers in "
            f"{with_hand / frames:.0%}: gloves? Choose a trigger of the arms"
        )
    elif not with_hand:
        yield (
            f"no hand in any of {frames} frames, so no salute can be seen; choose the "
            "gesture's range by hand, choose a trigger of the arms, or film from nearer"
        )
    elif with_hand < FEW_HANDS * frames:
        yield (
            f"hands seen in {with_hand / frames:.0%} of {frames} frames: choose a trigger of "
            "the arms, or film from nearer"
        )
    else:
        yield (
            f"no salute in any of {frames} frames; choose the gesture's range by hand, or "
            "salute with the palm or back of the hand towards the camera"
        )


def _describe_missed_salute(
    time: FloatArray, scores: FloatArray, hands: Sequence[Sequence[Hand]]
) -> Iterator[str]:
    """Yield which of the two salutes around a take was not seen, when, and in how many frames.

    Parameters as in `explain_missing_salutes`.
    """
    held = find_held(time, scores)
    seen = scores >= ENTER_SCORE
    if len(held) > 1:
        return
    name, told, missing = "salute", "no salute was held for long enough", np.ones_like(seen)
    if held:
        ((start, end),) = held
        is_first = end - time[0] < time[-1] - start
        name, other = ("second", "first") if is_first else ("first", "second")
        told = f"the {other} salute was seen at {start:.1f} to {end:.1f} s"
        missing = time > end + DROPOUT_SECONDS if is_first else time < start - DROPOUT_SECONDS
    if not missing.any():
        return
    # Where on that side a salute is seen most, for as long as a take lasts at least.
    there = np.flatnonzero(missing)
    ends = np.searchsorted(time[there], time[there] + SHORTEST_TAKE)
    before = np.concatenate([[0], np.cumsum(seen[there])])
    counts = before[ends] - before[:-1]
    at = int(counts.argmax())
    if counts[at]:
        span = f"{time[there[at]]:.1f} to {time[there[ends[at] - 1]]:.1f} s"
        in_part = f"seen in {counts[at]} of {ends[at] - at} frames at {span}"
    else:
        with_hand = sum(bool(hands[each]) for each in there.tolist())
        in_part = f"not seen; a hand was in {with_hand} of {len(there)} frames there"
    what = f"the {name} one was" if held else "one was"
    yield f"{told}; {what} {in_part}; hold both salutes longer, and nearer to the camera"
