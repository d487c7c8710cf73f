"""Gestures: one demonstration, with the image, descriptors and thresholds derived from it."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from app.recognition.errors import GestureError, PoseError
from app.recognition.features.contour import CLOSING_DIAMETER, BinaryImage
from app.recognition.features.trajectory_image import (
    MARGIN,
    MIN_EXTENT,
    SIMPLIFICATION,
    SIZE,
    STROKE_WIDTH,
    Drawing,
    draw,
)
from app.recognition.gestures.switches import AUTOMATIC, Switches
from app.recognition.poses.landmarks import POSE_LANDMARKS, UPPER_BODY, other_side
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.quality import find_fault
from app.recognition.preprocessing.repair import repair_poses
from app.recognition.preprocessing.salience import (
    MIN_DISPLACEMENT,
    choose_landmarks,
    find_salient_landmarks,
    measure_displacements,
)
from app.recognition.text.strict_json import read_json
from app.recognition.voters.registry import PAPER_VOTERS
from app.recognition.voters.shape.fourier import HARMONICS, SAMPLES
from app.recognition.voters.shape.hu import FLOOR
from app.recognition.voters.shape.shape_voter import describe_drawing
from app.recognition.voters.shape.zernike import DEGREE

MAX_LABEL_LENGTH = 80
"""Characters: more than fits on a gesture's card, and still one line of a log."""

MAX_TEXT_LENGTH = 2000
"""Characters of a description or of a command in words: a card, not a manual."""

MAX_COMMAND_BYTES = 4000
"""Size of a command object as JSON: parameters of an action, within the 40 kB of a gesture."""

MAX_COMMAND_DEPTH = 16
"""Nesting of a command object: within a language file, below the JSON reader's limit."""

MIN_FRAMES = 3
"""Least frames of a demonstration: two points are always a straight line."""

MAX_MOMENTS = 100
"""Most moments kept of a demonstration; longer ones are resampled evenly in time.

With `MAX_LANDMARKS` it keeps a gesture's file entry below 40 kB. In a gesture of ten seconds, ten
moments a second are left, enough to follow the arm.
"""

MAX_LANDMARKS = 16
"""Most landmarks kept of a demonstration: the salient ones first, then the upper body's."""

DIGITS = 4
"""Decimals kept of a trajectory: 0.05 mm of a diver, below what any pose model resolves."""

SETTINGS: Final[Mapping[str, int | float]] = MappingProxyType(
    {
        "image_size": SIZE,
        "image_margin": MARGIN,
        "stroke_width": STROKE_WIDTH,
        "simplification": SIMPLIFICATION,
        "min_extent": MIN_EXTENT,
        "max_moments": MAX_MOMENTS,
        "closing_diameter": CLOSING_DIAMETER,
        "hu_floor": FLOOR,
        "zernike_degree": DEGREE,
        "fourier_samples": SAMPLES,
        "fourier_harmonics": HARMONICS,
    }
)
"""Settings that images and descriptors in a language file depend on; where a file's differ, they
are computed again."""


@dataclass(frozen=True, kw_only=True)
class Rates:
    """Estimated error rates of a gesture's thresholds.

    Attributes
    ----------
    miss
        Share of other people's takes of the gesture that are rejected.
    false_alarm
        Share of out-of-vocabulary movements (`negatives`) that are recognised as the gesture.

    """

    miss: float
    false_alarm: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Gesture:
    """A labelled gesture of a language.

    Attributes
    ----------
    label
        The label of recognitions.
    salient
        The salient landmarks in alphabetical order; empty only in imported gestures, which then
        match nothing.
    image
        ``(224, 224)``: the salient landmarks' paths, 255 on black.
    trajectory
        The demonstration, at most `MAX_MOMENTS` moments of `MAX_LANDMARKS` landmarks; None when
        the gesture was imported from a file that has only images.
    descriptors
        Per voter's name its descriptor of the image; empty when the image is.
    thresholds
        Per voter's name the distance at which the gesture is rejected, if the others exceed theirs
        by the same factor (`rejection`); empty until its language is calibrated.
    rates
        Estimated error rates of the thresholds; None where not known.
    description
        What the gesture looks like or means, in words.
    command
        What the robot should do: free text, a JSON object, or None.
    switches
        Whether the gesture's direction, tempo and mirror image count.

    Raises
    ------
    GestureError
        When a field breaks these rules.

    """

    label: str
    salient: tuple[str, ...]
    image: BinaryImage
    trajectory: Trajectory | None = None
    descriptors: Mapping[str, FloatArray] = field(default_factory=dict)
    thresholds: Mapping[str, float] = field(default_factory=dict)
    rates: Rates | None = None
    description: str = ""
    command: str | dict[str, Any] | None = None
    switches: Switches = AUTOMATIC

    def __post_init__(self) -> None:
        """Validate texts, command and image, and freeze mutable fields."""
        object.__setattr__(self, "label", check_label(self.label))
        object.__setattr__(self, "description", check_text(self.description))
        object.__setattr__(self, "command", check_command(self.command))
        image = np.array(self.image, dtype=np.uint8)
        if image.shape != (SIZE, SIZE) or not np.isin(image, (0, 255)).all():
            raise GestureError(
                f"image of gesture {self.label!r} must be {SIZE} x {SIZE} of 0 and 255, "
                f"got shape {image.shape}"
            )
        image.setflags(write=False)
        object.__setattr__(self, "image", image)
        object.__setattr__(self, "salient", tuple(sorted(self.salient)))
        descriptors = {name: values.copy() for name, values in self.descriptors.items()}
        for values in descriptors.values():
            values.setflags(write=False)
        object.__setattr__(self, "descriptors", MappingProxyType(descriptors))
        object.__setattr__(self, "thresholds", MappingProxyType(dict(self.thresholds)))

    @classmethod
    def from_demonstration(
        cls,
        label: str,
        poses: PoseSequence,
        *,
        salient: Sequence[str] | None = None,
        description: str = "",
        command: str | dict[str, Any] | None = None,
    ) -> Gesture:
        """Create a gesture from one demonstration.

        Parameters
        ----------
        label
            The label of recognitions.
        poses
            The demonstration, without the salutes around it; it is repaired first.
        salient
            Landmarks to use instead of those chosen by `find_salient_landmarks`.
        description, command
            See the class.

        Raises
        ------
        GestureError
            When the demonstration is too short, nothing moves in it, or `salient` does not fit it.

        """
        label = check_label(label)
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
        if salient is None:
            names = find_salient_landmarks(trajectory)
        else:
            names = choose_landmarks(trajectory, salient)
        if poor := find_fault(seen, names):
            raise GestureError(
                f"the demonstration of {label!r} is too poor to use: {poor}; show the "
                f"gesture again in view of the camera, or choose another range of the clip"
            )
        kept = condense(trajectory).select(_choose_kept_landmarks(trajectory, names))
        drawing = draw(kept.select(names)) if names else None
        if drawing is None or drawing.empty:
            raise GestureError(_explain_nothing_moves(label, trajectory, names))
        return cls(
            label=label,
            salient=names,
            image=drawing.image,
            trajectory=kept,
            descriptors=describe_drawing(drawing, PAPER_VOTERS),
            description=description,
            command=command,
        )

    @property
    def drawing(self) -> Drawing:
        """The gesture's drawing, which shape voters compare."""
        seen = None if self.trajectory is None else self.trajectory.select(self.salient)
        return Drawing(self.image, seen)

    def mirror(self) -> Gesture:
        """Return the mirror image, as if shown with the other hand.

        Raises
        ------
        GestureError
            When only an image of the gesture is known.

        """
        if self.trajectory is None:
            raise GestureError(
                f"{self.label!r} was imported without its demonstration and cannot be mirrored: "
                f"define it again from a clip"
            )
        trajectory = self.trajectory.compute_once("mirrored", self.trajectory.mirror)
        salient = tuple(other_side(name) for name in self.salient)
        drawing = draw(trajectory.select(sorted(salient)))
        return replace(
            self,
            salient=salient,
            trajectory=trajectory,
            image=drawing.image,
            descriptors=describe_drawing(drawing, PAPER_VOTERS),
        )

    def with_salient(self, salient: Sequence[str]) -> Gesture:
        """Return the gesture with other salient landmarks, with image and descriptors recomputed.

        Raises
        ------
        GestureError
            When only an image of the gesture is known, or its demonstration lacks one of them.

        """
        if self.trajectory is None:
            raise GestureError(
                f"the gesture {self.label!r} was imported without its demonstration, so its "
                f"salient keypoints cannot be changed; save it again from a clip"
            )
        return replace(self, salient=choose_landmarks(self.trajectory, salient)).redraw()

    def redraw(self, simplification: float = SIMPLIFICATION) -> Gesture:
        """Return the gesture with image and descriptors recomputed from its demonstration.

        Where only an image is known, it is kept, and the descriptors are computed from it.
        """
        drawing = self.drawing
        if drawing.trajectory is not None and self.salient:
            drawing = draw(drawing.trajectory, simplification)
        descriptors = describe_drawing(drawing, PAPER_VOTERS)
        return replace(self, image=drawing.image, descriptors=descriptors)


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
        bounded, xy=np.round(bounded.xy, DIGITS) + 0.0, time=np.round(bounded.time, DIGITS) + 0.0
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


def check_label(label: Any) -> str:
    """Return a label without white space around it.

    Raises
    ------
    GestureError
        When it is empty, longer than `MAX_LABEL_LENGTH` or not printable.

    """
    if not isinstance(label, str) or not label.strip():
        raise GestureError(f"a gesture's label must be a word or a few, got {label!r}")
    if len(label) > MAX_LABEL_LENGTH or not label.isprintable():
        raise GestureError(
            f"a gesture's label must be at most {MAX_LABEL_LENGTH} printable characters, "
            f"got {label[:MAX_LABEL_LENGTH]!r} ({len(label)})"
        )
    return label.strip()


def check_text(text: Any) -> str:
    """Return a description or a command in words.

    Raises
    ------
    GestureError
        When it is longer than `MAX_TEXT_LENGTH` or holds half a surrogate pair.

    """
    if not isinstance(text, str) or len(text) > MAX_TEXT_LENGTH:
        size = f"{len(text)} characters" if isinstance(text, str) else repr(text)
        raise GestureError(f"must be text of at most {MAX_TEXT_LENGTH} characters, got {size}")
    if any("\ud800" <= character <= "\udfff" for character in text):
        raise GestureError("text with half a surrogate pair cannot be saved: write it again")
    return text


def check_command(command: Any) -> str | dict[str, Any] | None:
    """Return a command; an object is copied, so that later changes do not affect it.

    Raises
    ------
    GestureError
        When it is neither text, an object of plain JSON, nor None, or beyond `MAX_TEXT_LENGTH`,
        `MAX_COMMAND_BYTES` or `MAX_COMMAND_DEPTH`.

    """
    if command is None:
        return None
    if not isinstance(command, dict):
        return check_text(command)
    try:
        content = json.dumps(command).encode("ascii")
        read: dict[str, Any] = read_json(content, MAX_COMMAND_BYTES, MAX_COMMAND_DEPTH)
    except (TypeError, ValueError, RecursionError) as error:
        raise GestureError(f"a gesture's command must be plain JSON: {error}") from error
    return read


def _explain_nothing_moves(label: str, trajectory: Trajectory, salient: Sequence[str]) -> str:
    moved = measure_displacements(trajectory)
    most = max(salient or moved, key=lambda name: moved[name])
    unit = "torso lengths" if trajectory.unit == "torso_length" else "of the largest extent"
    return (
        f"nothing moves in the demonstration of {label!r}: {most} has the largest displacement, "
        f"{moved[most]:.2f} {unit}, and a hand or the head needs {MIN_DISPLACEMENT:g}: show the "
        f"gesture larger, choose another range of the clip, or name the salient landmarks"
    )
