"""Demonstrations: the takes that define a gesture, with the image and descriptors of each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from app.recognition.errors import GestureError, PoseError
from app.recognition.features.contour import BinaryImage
from app.recognition.features.trajectory_image import (
    SIMPLIFICATION,
    SIZE,
    Drawing,
    draw,
    draw_hands,
)
from app.recognition.poses.landmarks import POSE_LANDMARKS, UPPER_BODY, other_side
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.holds import (
    MOST_HOLDS,
    Hold,
    describe_excess,
    find_holds,
    keep_holds,
    rests_between_ends,
)
from app.recognition.preprocessing.moving_hands import find_moving_hands, list_moving_sides
from app.recognition.preprocessing.quality import find_fault
from app.recognition.preprocessing.repair import repair_poses
from app.recognition.preprocessing.salience import (
    LEAST_DISPLACEMENT,
    choose_landmarks,
    find_salient_landmarks,
    measure_displacements,
)
from app.recognition.text.look_alikes import compose, is_printable
from app.recognition.voters.registry import PAPER_VOTERS
from app.recognition.voters.shape_voters import describe_drawing

MAX_DEMONSTRATIONS = 8
"""Most demonstrations of one gesture: one each of eight people, a whole team of divers, and
it bounds the work."""

MAX_DIVER_LENGTH = 80
"""Characters of a diver's name: a name, not a text."""

MIN_FRAMES = 3
"""Least frames of a demonstration: two points are always a straight line."""

MAX_MOMENTS = 100
"""Most moments kept of a demonstration; longer ones are resampled evenly in time.

With `MAX_LANDMARKS` it keeps a demonstration's file entry below 40 kB. In a gesture of ten
seconds, ten moments a second are left, enough to follow the arm.
"""

HELD_MOMENTS = 8
"""Most moments kept of a held hand shape: nothing moves, and its file entry stays below 12 kB."""

MAX_LANDMARKS = 16
"""Most landmarks kept of a demonstration: the salient ones first, then the upper body's."""

DIGITS = 4
"""Decimals kept of a trajectory: 0.05 mm of a diver, below what any pose model resolves."""

DEPTH_DIGITS = 2
"""Decimals kept of a trajectory's depth: 5 mm of a diver, a tenth of a pose model's error."""

DEMONSTRATION_KINDS = ("a movement", "a held hand shape", "a sequence of two held hand shapes")
"""Kinds of demonstrations, by the number of held hand shapes."""


@dataclass(frozen=True, eq=False)
class Demonstration:
    """A further demonstration of a gesture, beside its first.

    Attributes
    ----------
    trajectory
        At most `MAX_MOMENTS` moments of `MAX_LANDMARKS` landmarks.
    salient
        Its salient landmarks in alphabetical order; another diver may use the other hand. Empty
        for a held hand shape.
    image
        ``(224, 224)``: the salient landmarks' paths, or the held hands, 255 on black.
    descriptors
        Per voter's name its descriptor of the image.
    diver
        Name of the diver who shows it; empty: not known.

    Raises
    ------
    GestureError
        When a field breaks these rules.

    """

    trajectory: Trajectory
    salient: tuple[str, ...]
    image: BinaryImage
    descriptors: Mapping[str, FloatArray]
    diver: str = ""

    def __post_init__(self) -> None:
        """Validate image and name, and freeze mutable fields."""
        object.__setattr__(self, "salient", tuple(sorted(self.salient)))
        object.__setattr__(self, "image", freeze_image(self.image))
        object.__setattr__(self, "descriptors", freeze_descriptors(self.descriptors))
        object.__setattr__(self, "diver", check_diver(self.diver))

    @classmethod
    def from_poses(
        cls,
        label: str,
        poses: PoseSequence,
        *,
        salient: Sequence[str] | None = None,
        like: Sequence[str] = (),
        diver: str = "",
    ) -> Demonstration:
        """Create a demonstration from the poses of a take.

        Parameters
        ----------
        label
            The gesture's label, for messages.
        poses
            The take, without the salutes around it; it is repaired first.
        salient
            Landmarks to use instead of those chosen by `find_salient_landmarks`.
        like
            Salient landmarks of the gesture's first demonstration; they are used without `salient`
            if one of them is salient in this take too.
        diver
            See the class.

        Raises
        ------
        GestureError
            When the take is too short, when nothing moves in it and no hand shape is held, when
            more than `MOST_HOLDS` shapes are held, or when `salient` does not fit it.

        """
        if len(poses) < MIN_FRAMES:
            raise GestureError(
                f"the demonstration of {label!r} has {len(poses)} frames, a gesture needs at "
                f"least {MIN_FRAMES}: choose a longer range of the clip"
            )
        try:
            seen = repair_poses(poses).poses
            trajectory = Trajectory.from_poses(seen)
        except PoseError as error:
            raise GestureError(f"the demonstration of {label!r} is empty: {error}") from error
        holds = find_holds(seen, trajectory) if salient is None else ()
        if salient is not None:
            names = choose_landmarks(trajectory, salient)
        elif is_shown_by(like, trajectory):
            names = choose_landmarks(trajectory, like)
        else:
            names = find_salient_landmarks(trajectory)
        # Without a torso the unit is the extent itself, in which everything moves.
        still = not names or trajectory.unit == "extent" or rests_between_ends(trajectory)
        if holds and still:
            return cls._of_holds(label, seen, trajectory, holds, diver)
        if poor := find_fault(seen, names):
            raise GestureError(
                f"the demonstration of {label!r} is too poor to use: {poor.words}; show the "
                f"gesture again in view of the camera, or choose another range of the clip"
            )
        kept = condense(trajectory).select(_choose_kept_landmarks(trajectory, names))
        kept = replace(kept, moving_hands=find_moving_hands(seen, list_moving_sides(names)))
        drawing = draw(kept.select(names)) if names else None
        if drawing is None or drawing.empty:
            raise GestureError(_explain_nothing_moves(label, trajectory, names))
        return cls(kept, names, drawing.image, describe_drawing(drawing, PAPER_VOTERS), diver)

    @classmethod
    def _of_holds(
        cls,
        label: str,
        poses: PoseSequence,
        trajectory: Trajectory,
        holds: Sequence[Hold],
        diver: str,
    ) -> Demonstration:
        """Create a demonstration of a held hand shape, or of two in sequence."""
        if len(holds) > MOST_HOLDS:
            raise GestureError(
                f"the demonstration of {label!r} shows {describe_excess(holds)}: choose a range of "
                "the clip with two of them, or save each as a gesture of its own and make a phrase "
                "of them"
            )
        if poor := find_fault(poses, ()):
            raise GestureError(f"the demonstration of {label!r} is too poor to use: {poor.words}")
        few = trajectory.fill_gaps().resample_in_time(min(len(trajectory), HELD_MOMENTS))
        kept = condense(few).select(_choose_kept_landmarks(trajectory, ()))
        kept = keep_holds(kept, holds)
        return cls(kept, (), draw_hands(*kept.held_shapes), {}, diver)

    @property
    def is_held(self) -> bool:
        """Whether it is a held hand shape or two in sequence, not a movement."""
        return bool(self.trajectory.hands)

    @property
    def kind(self) -> str:
        """What it shows, in words: a movement, a held hand shape, or two in sequence."""
        return DEMONSTRATION_KINDS[len(self.trajectory.held_shapes)]

    def mirror(self) -> Demonstration:
        """Return the mirror image, as if shown with the other hand."""
        trajectory = self.trajectory.compute_once("mirrored", self.trajectory.mirror)
        salient = tuple(sorted(other_side(name) for name in self.salient))
        return replace(self, trajectory=trajectory, salient=salient).redraw()

    def turn(self, degrees: int) -> Demonstration:
        """Return the demonstration as seen when its diver is turned, see `Trajectory.turn`."""
        seen = self.trajectory.turn_once(degrees)
        return seen.compute_once(
            ("demonstration", self.salient), lambda: replace(self, trajectory=seen).redraw()
        )

    def with_salient(self, salient: Sequence[str]) -> Demonstration:
        """Return the demonstration with other salient landmarks, redrawn.

        Raises
        ------
        GestureError
            When it lacks one of them.

        """
        chosen = choose_landmarks(self.trajectory, salient)
        sides = list_moving_sides(chosen)
        hands = tuple(hand for hand in self.trajectory.moving_hands if hand.side in sides)
        moving = replace(self.trajectory, hands=(), then_hands=(), moving_hands=hands)
        return replace(self, salient=chosen, trajectory=moving).redraw()

    def redraw(self, simplification: float = SIMPLIFICATION) -> Demonstration:
        """Return the demonstration with image and descriptors recomputed."""
        if self.is_held:
            return replace(self, image=draw_hands(*self.trajectory.held_shapes), descriptors={})
        drawing = Drawing(self.image, self.trajectory.select(self.salient))
        if self.salient:
            drawing = draw(self.trajectory.select(self.salient), simplification)
        descriptors = describe_drawing(drawing, PAPER_VOTERS)
        return replace(self, image=drawing.image, descriptors=descriptors)


def is_shown_by(salient: Sequence[str], trajectory: Trajectory) -> bool:
    """Return whether landmarks can be a take's salient ones: all are seen, and one is salient."""
    visible = {
        name
        for index, name in enumerate(trajectory.landmarks)
        if np.isfinite(trajectory.xy[:, index]).any()
    }
    moving = find_salient_landmarks(trajectory)
    return visible.issuperset(salient) and not set(moving).isdisjoint(salient)


def freeze_image(image: BinaryImage) -> BinaryImage:
    """Return a read-only copy of a trajectory image.

    Raises
    ------
    GestureError
        When it has another shape or other values.

    """
    copy = np.array(image, dtype=np.uint8)
    if copy.shape != (SIZE, SIZE) or not np.isin(copy, (0, 255)).all():
        raise GestureError(
            f"the image of a gesture must be {SIZE} x {SIZE} of 0 and 255, got shape {copy.shape}"
        )
    copy.setflags(write=False)
    return copy


def freeze_descriptors(descriptors: Mapping[str, FloatArray]) -> Mapping[str, FloatArray]:
    """Return read-only copies of descriptors."""
    copies = {name: values.copy() for name, values in descriptors.items()}
    for values in copies.values():
        values.setflags(write=False)
    return MappingProxyType(copies)


def check_diver(diver: str) -> str:
    """Return a diver's name without white space around it.

    Raises
    ------
    GestureError
        When it is longer than `MAX_DIVER_LENGTH` or not printable.

    """
    if not isinstance(diver, str) or len(diver) > MAX_DIVER_LENGTH or not is_printable(diver):
        raise GestureError(
            f"a diver's name must be at most {MAX_DIVER_LENGTH} printable characters, got "
            f"{str(diver)[:MAX_DIVER_LENGTH]!r}"
        )
    return compose(diver.strip())


def condense(trajectory: Trajectory) -> Trajectory:
    """Condense a trajectory: bridge gaps, limit the number of moments, and round.

    Applied to references and queries, so that recognition with a saved file equals recognition
    before saving, to the last bit.

    Returns
    -------
    A trajectory of at most `MAX_MOMENTS` moments, rounded to `DIGITS` decimals.

    """
    bounded = trajectory.fill_gaps()
    if len(bounded) > MAX_MOMENTS:
        bounded = bounded.resample_in_time(MAX_MOMENTS)
    # Adding 0 turns -0.0 into 0.0, which files do not distinguish.
    return replace(
        bounded,
        xy=np.round(bounded.xy, DIGITS) + 0.0,
        time=np.round(bounded.time, DIGITS) + 0.0,
        depth=None if bounded.depth is None else np.round(bounded.depth, DEPTH_DIGITS) + 0.0,
    )


def _choose_kept_landmarks(trajectory: Trajectory, salient: Sequence[str]) -> tuple[str, ...]:
    """Choose the landmarks to keep, in the trajectory's order."""
    names = trajectory.landmarks
    upper = [name for name in names if name in UPPER_BODY and name not in salient]
    # Of MediaPipe's set only the upper body is kept; names of other sets may all be arms.
    known = frozenset(POSE_LANDMARKS) if upper else frozenset()
    others = [name for name in names if name not in salient and name not in known]
    kept = {*salient, *(upper + others)[: max(0, MAX_LANDMARKS - len(salient))]}
    return tuple(name for name in names if name in kept)


def _explain_nothing_moves(label: str, trajectory: Trajectory, salient: Sequence[str]) -> str:
    moved = measure_displacements(trajectory)
    most = max(salient or moved, key=lambda name: moved[name])
    unit = "torso lengths" if trajectory.unit == "torso_length" else "of the largest extent"
    return (
        f"nothing moves in the demonstration of {label!r}: {most} has the largest displacement, "
        f"{moved[most]:.2f} {unit}, and at least {LEAST_DISPLACEMENT:g} are needed; nor is a hand "
        f"seen that holds a shape: show the gesture larger, choose another range of the clip, or "
        f"name the salient landmarks"
    )
