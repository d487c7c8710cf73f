"""Trimming: finds the transits between the salutes and the gesture, and cuts them off.

Between two salutes the diver reaches for the place where the gesture begins, draws, and returns.
The two reaches are no part of the gesture; in its trajectory image they would make all gestures
more alike (as in every image of the published language files).

People move in strokes with a bell-shaped speed (Flash and Hogan 1985), and a reach to a point is
nearly straight. So the take is split where the speed of the moving wrists has a clear minimum; the
first and the last piece are transits if they last short and are straight, or so small that neither
cutting nor keeping them decides (`matching.dtw.OPEN_ENDS`). In doubt nothing is cut: a stroke with
a reach is still recognised, half a stroke is not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from app.recognition.poses.landmarks import WRISTS
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.poses.trajectory import Trajectory

GRID_STEP = 1 / 60
"""Seconds between the moments at which speed is computed: finer than most cameras' frames."""

SMOOTHING = 0.06
"""Standard deviation in seconds of the Gaussian that smooths positions: a quarter of the half-width
of the shortest reach's bell (0.4 s), so that bells remain and frame noise does not."""

MOVING_HAND = 0.3
"""Least extent of a moving wrist, torso lengths: sway of the body and errors of the pose model are
below, gestures above."""

CLEAR_MINIMUM = 0.4
"""Largest ratio of the speed at a boundary to the lower of its two neighbouring peaks. A hand that
stops or turns sharply is below; on a curve it slows down by about a third (two-thirds power law,
Lacquaniti et al. 1983)."""

RESTING = 0.06
"""Share of the highest speed below which a hand is at rest: above the pose model's jitter, below
the slowest drawing after the fastest reach."""

CORNER_MINIMUM = 0.7
"""`CLEAR_MINIMUM` where the hand turns by `CORNER_ANGLE` or more: at a rounded corner a hand slows
down less than when it stops."""

CORNER_ANGLE = 60.0
"""Degrees between the directions `CORNER_REACH` before and after the minimum. A circle drawn in a
second turns by 54 degrees in that time without slowing down."""

CORNER_REACH = 0.15
"""Seconds before and after a minimum in which the hand's direction is measured: longer than the
smoothing rounds a corner."""

PAUSE = 0.1
"""Share of a neighbouring peak below which the hand pauses; this cuts off less than a hundredth of
a minimum-jerk stroke."""

TREMOR = 0.05
"""Least extent of a movement, torso lengths: 2.5 cm. A hand held still in water drifts and trembles
less."""

UNREST = 0.1
"""Least extent of a movement within a salute, torso lengths, that may be the way from or to it."""

SETTING_OUT = 0.15
"""Most seconds between a salute that is no longer seen and its way from it, or a way and the salute
that is not yet seen. The fingers change while the hand travels: in 60 takes of renderings the way
begins at most 0.07 s after the salute, and mostly before its end. Where a stroke begins or ends at
the place of the salute, the hand rests while they change, and no way is cut off."""

STRAIGHT_REACH = 0.85
"""Least ratio of distance to path length of a reach. Reaches are straight within a few per cent; a
half circle has 0.64; a quarter circle has 0.90 but is no whole piece of a stroke."""

SMALL_REACH = 0.15
"""Largest share of all pieces' path that a reach may have without being straight: a hand that
salutes beside the place where it draws gets there in any way."""

LONGEST_REACH = 1.5
"""Most seconds of a reach. Reaches take 0.5 to 1 s (Flash and Hogan 1985); in water somewhat
longer."""

LARGEST_SHARE = 0.45
"""Largest share of a take that one reach may have; two leave a tenth."""


@dataclass(frozen=True)
class Span:
    """A span of time.

    Attributes
    ----------
    start, end
        Seconds, in the clock of the recording; ``start <= end``.

    """

    start: float
    end: float


@dataclass(frozen=True, eq=False)
class Motion:
    """Moving landmarks on an even grid of G moments, `GRID_STEP` apart.

    Attributes
    ----------
    time
        ``(G,)`` seconds in the recording's clock.
    xy
        ``(G, 2 * landmarks)`` torso lengths, smoothed.
    speed
        ``(G,)`` torso lengths a second, of all landmarks together.
    known
        ``(G,)``: whether all of them were seen.

    """

    time: FloatArray
    xy: FloatArray
    speed: FloatArray
    known: npt.NDArray[np.bool_]

    def between(self, start: float, end: float) -> Motion:
        """Keep the moments from `start` to `end` seconds."""
        inside = (self.time >= start) & (self.time <= end)
        return Motion(self.time[inside], self.xy[inside], self.speed[inside], self.known[inside])

    def slowest(self, span: Span) -> float:
        """Return the moment of least speed in `span`."""
        inside = np.flatnonzero((self.time >= span.start) & (self.time <= span.end))
        if not len(inside):
            return span.start
        return float(self.time[inside[np.argmin(self.speed[inside])]])


@dataclass(frozen=True)
class Piece:
    """One movement between two minima of speed: first and last grid index, pauses left out."""

    first: int
    last: int


def find_stroke(
    poses: PoseSequence, opening: Span, closing: Span | None, *, posed: bool = False
) -> Span:
    """Find the gesture's own movement between two salutes.

    The result does not depend on translation or scale of the poses, and shifts with their clock.

    Parameters
    ----------
    poses
        Poses from the first salute to the last one.
    opening, closing
        When the salutes were seen. The hand may keep the shape while it leaves, and form it before
        it arrives. `closing` None: the take was not closed, so only its beginning is trimmed, and
        the stroke ends with the last frame.
    posed
        Whether the triggers are poses of the arms. Any movement entirely within a pose is unrest,
        within a salute a small one only.

    Returns
    -------
    The stroke; everything between the salutes where no reach is clear.

    """
    end = closing.start if closing else float(poses.time[-1])
    whole = Span(opening.end, end)
    motion = _hand_motion(poses.between(opening.start, closing.end if closing else end))
    if motion is None:
        return whole
    motion = motion.between(motion.slowest(opening), motion.slowest(closing) if closing else end)
    pieces = [
        piece
        for piece in split_pieces(motion)
        if (motion.time[piece.last] > whole.start and motion.time[piece.first] < whole.end)
        or not (posed or measure_extent(motion.xy[piece.first : piece.last + 1]) < UNREST)
    ]
    if len(pieces) < 2:
        return whole
    if len(pieces) == 2 and all(_is_straight(motion, piece) for piece in pieces):
        # Two pieces, there and back, may be the whole gesture: a line drawn twice.
        return whole
    moving = float(motion.time[pieces[-1].last] - motion.time[pieces[0].first])
    small = SMALL_REACH * sum(_measure_way(motion, piece) for piece in pieces)
    goes = motion.time[pieces[0].first] <= whole.start + SETTING_OUT and _is_reach(
        motion, pieces[0], moving, small
    )
    comes = (
        closing is not None
        and motion.time[pieces[-1].last] >= whole.end - SETTING_OUT
        and _is_reach(motion, pieces[-1], moving, small)
    )
    return Span(
        start=max(whole.start, float(motion.time[pieces[1].first])) if goes else whole.start,
        end=min(whole.end, float(motion.time[pieces[-2].last])) if comes else whole.end,
    )


def _hand_motion(poses: PoseSequence) -> Motion | None:
    """Measure the motion of the moving wrists; None where none moves or is seen."""
    count = int(np.ceil(poses.duration / GRID_STEP)) + 1
    wrists = [name for name in WRISTS if name in poses.landmarks]
    if count < 3 or not any(np.isfinite(poses.column(name)).any() for name in wrists):
        return None
    trajectory = Trajectory.from_poses(poses).select(wrists).fill_gaps().resample_in_time(count)
    moving = [
        path for path in np.moveaxis(trajectory.xy, 1, 0) if measure_extent(path) >= MOVING_HAND
    ]
    return measure_motion(moving, trajectory.time + poses.time[0])


def measure_motion(paths: Sequence[FloatArray], time: FloatArray) -> Motion | None:
    """Smooth paths on an even grid, and measure their speed.

    Parameters
    ----------
    paths
        Each ``(G, 2)`` in torso lengths, NaN where not seen.
    time
        ``(G,)`` seconds, `GRID_STEP` apart.

    Returns
    -------
    None without paths, or where no moment shows all of them.

    """
    if not paths:
        return None
    xy = np.concatenate(paths, axis=1)
    known: npt.NDArray[np.bool_] = np.asarray(np.isfinite(xy).all(axis=1))
    if not known.any():
        return None
    moments = np.arange(len(time))
    smooth = np.stack(
        [_smooth(np.interp(moments, moments[known], column[known])) for column in xy.T], axis=1
    )
    speed = np.linalg.norm(np.gradient(smooth, time, axis=0), axis=1)
    return Motion(time=time, xy=smooth, speed=speed, known=known)


def measure_extent(path: FloatArray) -> float:
    """Return the diagonal of a path's bounding box; 0 where nothing is seen."""
    seen = path[np.isfinite(path).all(axis=1)]
    return float(np.linalg.norm(np.ptp(seen, axis=0))) if len(seen) else 0.0


def _smooth(values: FloatArray) -> FloatArray:
    """Convolve with the Gaussian of `SMOOTHING` seconds, with the end values extended."""
    deviation = SMOOTHING / GRID_STEP
    half = int(np.ceil(3 * deviation))
    weights = np.exp(-0.5 * (np.arange(-half, half + 1) / deviation) ** 2)
    padded = np.pad(values, half, mode="edge")
    return np.convolve(padded, weights / weights.sum(), mode="valid")


def split_pieces(motion: Motion) -> list[Piece]:
    """Split a motion where its speed has a clear minimum, and drop the pauses in between."""
    speed = motion.speed
    if len(speed) < 3 or speed.max() <= 0:
        return []
    resting = RESTING * float(speed.max())
    peaks, valleys = _turning_points(np.maximum(speed, resting))
    limits = {valley: _find_limit(motion, valley) for valley in valleys}
    while valleys:
        excess = [
            speed[valley] / min(speed[peaks[i]], speed[peaks[i + 1]]) / limits[valley]
            for i, valley in enumerate(valleys)
        ]
        worst = int(np.argmax(excess))
        if excess[worst] <= 1:
            break
        # Without a clear minimum the lower of the two peaks is a ripple on the other's flank.
        valleys.pop(worst)
        peaks.pop(worst if speed[peaks[worst]] < speed[peaks[worst + 1]] else worst + 1)
    cuts = [0, *valleys, len(speed) - 1]
    pieces = [
        _drop_pauses(speed, cuts[i], cuts[i + 1], max(resting, PAUSE * float(speed[peak])))
        for i, peak in enumerate(peaks)
    ]
    return [
        piece
        for piece in pieces
        if measure_extent(motion.xy[piece.first : piece.last + 1]) > TREMOR
    ]


def _find_limit(motion: Motion, valley: int) -> float:
    """Return the largest speed of a minimum to split at, as a share of its lower peak."""
    reach = round(CORNER_REACH / GRID_STEP)
    before = motion.xy[valley] - motion.xy[max(valley - reach, 0)]
    after = motion.xy[min(valley + reach, len(motion.xy) - 1)] - motion.xy[valley]
    lengths = float(np.linalg.norm(before) * np.linalg.norm(after))
    turns = lengths > 0 and before @ after <= lengths * np.cos(np.radians(CORNER_ANGLE))
    return CORNER_MINIMUM if turns else CLEAR_MINIMUM


def _turning_points(values: FloatArray) -> tuple[list[int], list[int]]:
    """Return the indices of the peaks of `values`, and of the minima between them.

    The index of a plateau is its middle; an end of the array from which values fall is a peak.
    """
    ends = np.flatnonzero(np.diff(values) != 0)
    firsts, lasts = np.append(0, ends + 1), np.append(ends, len(values) - 1)
    levels = values[firsts]
    middles = (firsts + lasts) // 2
    framed = np.concatenate([[-np.inf], levels, [-np.inf]])
    is_peak = (framed[1:-1] > framed[:-2]) & (framed[1:-1] > framed[2:])
    peaks = np.flatnonzero(is_peak)
    valleys = [
        int(middles[a + int(np.argmin(levels[a : b + 1]))]) for a, b in pairwise(peaks.tolist())
    ]
    return middles[peaks].tolist(), valleys


def _drop_pauses(speed: FloatArray, first: int, last: int, pause: float) -> Piece:
    fast = np.flatnonzero(speed[first : last + 1] > pause)
    return Piece(first + int(fast[0]), first + int(fast[-1])) if len(fast) else Piece(first, last)


def _is_reach(motion: Motion, piece: Piece, moving: float, small: float) -> bool:
    """Return whether a piece is a short movement of hands in view, straight or small.

    `moving` is the duration of all movement between the salutes, in seconds; `small` the longest
    way that need not be straight, in torso lengths.
    """
    lasts = float(motion.time[piece.last] - motion.time[piece.first])
    return (
        lasts <= min(LONGEST_REACH, LARGEST_SHARE * moving)
        and (_measure_way(motion, piece) <= small or _is_straight(motion, piece))
        and bool(motion.known[piece.first : piece.last + 1].all())
    )


def _measure_way(motion: Motion, piece: Piece) -> float:
    """Return the length of a piece's path in torso lengths."""
    steps = np.diff(motion.xy[piece.first : piece.last + 1], axis=0)
    return float(np.linalg.norm(steps, axis=1).sum())


def _is_straight(motion: Motion, piece: Piece) -> bool:
    apart = float(np.linalg.norm(motion.xy[piece.last] - motion.xy[piece.first]))
    return 0 < STRAIGHT_REACH * _measure_way(motion, piece) <= apart
