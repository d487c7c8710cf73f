"""Gestures: one demonstration or several, with their label, command and switches."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import Any, Final

from app.recognition.errors import GestureError
from app.recognition.features.contour import CLOSING_DIAMETER, BinaryImage
from app.recognition.features.trajectory_image import (
    MARGIN,
    MIN_EXTENT,
    SIMPLIFICATION,
    SIZE,
    STROKE_WIDTH,
    Drawing,
)
from app.recognition.gestures.demonstration import (
    DEMONSTRATION_KINDS,
    MAX_DEMONSTRATIONS,
    MAX_MOMENTS,
    MIN_FRAMES,
    Demonstration,
    check_diver,
    freeze_descriptors,
    freeze_image,
    is_shown_by,
)
from app.recognition.gestures.switches import AUTOMATIC, Switches
from app.recognition.poses.frame import HandShape
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.text.look_alikes import compose, is_printable, skeleton
from app.recognition.text.strict_json import read_json
from app.recognition.voters.registry import PAPER_VOTERS
from app.recognition.voters.shape_voters import DEGREE, FLOOR, HARMONICS, SAMPLES, describe_drawing

MAX_LABEL_LENGTH = 80
"""Most characters of a label: more than fits on a gesture's card, and still one line of a log."""

MAX_TEXT_LENGTH = 2000
"""Characters of a description or of a command in words: a card, not a manual."""

MAX_COMMAND_BYTES = 4000
"""Size of a command object as JSON: parameters of an action, within the 40 kB of a gesture."""

MAX_COMMAND_DEPTH = 16
"""Nesting of a command object: within a language file, below the JSON reader's limit."""

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
"""Settings that images and descriptors in a language file depend on; if a file has others, its
images and descriptors are computed again."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Gesture:
    """A labelled gesture of a language.

    Attributes
    ----------
    label
        The label of recognitions.
    salient
        The salient landmarks in alphabetical order; empty for a held hand shape, and in imported
        gestures, which then match nothing.
    image
        ``(224, 224)``: the salient landmarks' paths, or the held hands, 255 on black.
    trajectory
        The first demonstration, at most `MAX_MOMENTS` moments of `MAX_LANDMARKS` landmarks; None
        when the gesture was imported from a file that has only images.
    descriptors
        Per voter's name its descriptor of the image; empty when the image is.
    thresholds, rates
        Of files of version 0.2 and before, which reject by them, and the shares ``miss`` and
        ``false_alarm`` of errors that these estimate; kept for robots of these versions, and not
        used.
    description
        What the gesture looks like or means, in words.
    command
        What the robot should do: free text, a JSON object, or None.
    switches
        Whether the gesture's direction, tempo, mirror image and hand shape count.
    diver
        Name of the diver of the first demonstration; empty: not known.
    further
        Its demonstrations beside the first, `MAX_DEMONSTRATIONS` in all; `salient`, `image`,
        `trajectory` and `descriptors` are the first one's.

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
    rates: Mapping[str, float] | None = None
    description: str = ""
    command: str | dict[str, Any] | None = None
    switches: Switches = AUTOMATIC
    diver: str = ""
    further: tuple[Demonstration, ...] = ()

    def __post_init__(self) -> None:
        """Validate texts, command and image, and freeze mutable fields."""
        object.__setattr__(self, "label", check_label(self.label))
        object.__setattr__(self, "description", check_text(self.description))
        object.__setattr__(self, "command", check_command(self.command))
        object.__setattr__(self, "image", freeze_image(self.image))
        object.__setattr__(self, "salient", tuple(sorted(self.salient)))
        object.__setattr__(self, "descriptors", freeze_descriptors(self.descriptors))
        object.__setattr__(self, "thresholds", MappingProxyType(dict(self.thresholds)))
        object.__setattr__(self, "diver", check_diver(self.diver))
        object.__setattr__(self, "further", tuple(self.further))
        if len(self.further) >= MAX_DEMONSTRATIONS:
            raise GestureError(
                f"{self.label!r} would have {1 + len(self.further)} demonstrations, the limit is "
                f"{MAX_DEMONSTRATIONS}: remove one first"
            )

    @classmethod
    def from_demonstration(
        cls,
        label: str,
        poses: PoseSequence,
        *,
        salient: Sequence[str] | None = None,
        description: str = "",
        command: str | dict[str, Any] | None = None,
        diver: str = "",
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
        description, command, diver
            See the class.

        Raises
        ------
        GestureError
            When the demonstration is too short, nothing moves in it and no hand shape is held, or
            `salient` does not fit it.

        """
        label = make_label(label)
        shown = Demonstration.from_poses(label, poses, salient=salient, diver=diver)
        return cls(label=label, description=description, command=command, **vars(shown))

    @property
    def is_held(self) -> bool:
        """Whether it is a held hand shape or two in sequence, not a movement."""
        return bool(self.held_shapes)

    @property
    def held_shapes(self) -> tuple[tuple[HandShape, ...], ...]:
        """The hands of each shape that the first demonstration holds, in their order.

        Empty for a movement, two of a sequence (`Trajectory.then_hands`).
        """
        return () if self.trajectory is None else self.trajectory.held_shapes

    @property
    def drawing(self) -> Drawing:
        """The gesture's drawing, which shape voters compare."""
        seen = None if self.trajectory is None else self.trajectory.select(self.salient)
        return Drawing(self.image, seen)

    def single_demonstrations(self) -> tuple[Gesture, ...]:
        """Return one gesture for each demonstration, the first one's first."""
        return self._apart if self.further else (self,)

    @cached_property
    def _apart(self) -> tuple[Gesture, ...]:
        first = replace(self, further=())
        return (first, *(first._with_shown((each,)) for each in self.further))

    @property
    def trajectories(self) -> tuple[Trajectory, ...]:
        """The trajectories of all demonstrations; empty where only an image was imported."""
        shown = self.single_demonstrations() if self.trajectory is not None else ()
        return tuple(each.trajectory for each in shown if each.trajectory is not None)

    def with_demonstration(
        self, poses: PoseSequence, diver: str = "", *, salient: Sequence[str] | None = None
    ) -> Gesture:
        """Return the gesture with one more demonstration.

        Parameters
        ----------
        poses
            The take, without the salutes around it; it is repaired first.
        diver
            Name of the diver who shows it; empty: not known.
        salient
            Its salient landmarks. By default those of the first demonstration; where none of these
            moves, as in a take with the other hand, those of the take itself.

        Raises
        ------
        GestureError
            When the gesture has `MAX_DEMONSTRATIONS` already, or the take cannot be used.

        """
        made = Demonstration.from_poses(
            self.label, poses, salient=salient, like=self.salient, diver=diver
        )
        first = DEMONSTRATION_KINDS[len(self.held_shapes)]
        if made.kind != first:
            raise GestureError(
                f"{self.label!r} is {first} and this demonstration is {made.kind}: show it in the "
                f"same way, or define another gesture"
            )
        return replace(self, further=(*self.further, made))

    def without_demonstration(self, index: int) -> Gesture:
        """Return the gesture without one of its demonstrations, counted from 0.

        Without the first, the second takes its place.

        Raises
        ------
        GestureError
            When there is no such demonstration, or it is the only one.

        """
        count = 1 + len(self.further)
        if not 0 <= index < count:
            raise GestureError(
                f"{self.label!r} has no demonstration {index}, it has {count}, counted from 0"
            )
        if count == 1:
            raise GestureError(
                f"the only demonstration of {self.label!r} cannot be removed: add another one "
                f"first, or remove the gesture"
            )
        if index == 0:
            return self._with_shown(self.further)
        return replace(self, further=self.further[: index - 1] + self.further[index:])

    def without_demonstrations(self, indices: Collection[int]) -> Gesture | None:
        """Return the gesture without some of its demonstrations; None where none is left."""
        kept: Gesture | None = self
        for index in sorted(indices, reverse=True):
            kept = kept.without_demonstration(index) if kept and kept.further else None
        return kept

    def with_cut(self, index: int, start: float, end: float) -> Gesture:
        """Return the gesture with one of its demonstrations, counted from 0, cut at both ends.

        Parameters
        ----------
        index
            Which demonstration.
        start, end
            Seconds of the demonstration's own clock between which it is kept.

        Raises
        ------
        GestureError
            When there is no such demonstration, or fewer than `MIN_FRAMES` moments are left.

        """
        shown = [self._require_first("cannot be cut: define it again from a clip"), *self.further]
        if not 0 <= index < len(shown):
            raise GestureError(f"{self.label!r} has no demonstration {index}, counted from 0")
        kept = shown[index].trajectory.between(start, end)
        if len(kept) < MIN_FRAMES:
            raise GestureError(f"only {len(kept)} moments of {self.label!r} would be left")
        kept = replace(kept, time=kept.time - kept.time[0])
        shown[index] = replace(shown[index], trajectory=kept).redraw()
        return self._with_shown(shown)

    def mirror(self) -> Gesture:
        """Return the mirror image, as if shown with the other hand.

        Raises
        ------
        GestureError
            When only an image of the gesture is known.

        """
        first = self._require_first("cannot be mirrored: define it again from a clip")
        return self._with_shown([each.mirror() for each in (first, *self.further)])

    def turn(self, degrees: int) -> Gesture:
        """Return the gesture as seen when its divers are turned, see `Trajectory.turn`.

        Demonstrations without depth are unchanged.
        """
        if degrees == 0 or (first := self._first) is None:
            return self
        return self._with_shown(
            [
                each if each.trajectory.depth is None else each.turn(degrees)
                for each in (first, *self.further)
            ]
        )

    def with_salient(self, salient: Sequence[str]) -> Gesture:
        """Return the gesture with other salient landmarks, with image and descriptors recomputed.

        A further demonstration in which none of them moves keeps its own.

        Raises
        ------
        GestureError
            When only an image of the gesture is known, or its first demonstration lacks one of
            them.

        """
        first = self._require_first(
            "has salient keypoints that cannot be changed; save it again from a clip"
        )
        further = [
            each.with_salient(salient) if is_shown_by(salient, each.trajectory) else each
            for each in self.further
        ]
        return self._with_shown([first.with_salient(salient), *further])

    def redraw(self, simplification: float = SIMPLIFICATION) -> Gesture:
        """Return the gesture with images and descriptors recomputed from its demonstrations.

        Where only an image is known, it is kept, and the descriptors are computed from it.
        """
        further = tuple(each.redraw(simplification) for each in self.further)
        if (first := self._first) is None:
            descriptors = describe_drawing(self.drawing, PAPER_VOTERS)
            return replace(self, descriptors=descriptors, further=further)
        return self._with_shown((first.redraw(simplification), *further))

    @property
    def _first(self) -> Demonstration | None:
        if self.trajectory is None:
            return None
        return Demonstration(
            self.trajectory, self.salient, self.image, self.descriptors, self.diver
        )

    def _require_first(self, otherwise: str) -> Demonstration:
        if (first := self._first) is None:
            raise GestureError(
                f"{self.label!r} was imported without its demonstration and {otherwise}"
            )
        return first

    def _with_shown(self, shown: Sequence[Demonstration]) -> Gesture:
        """Return the gesture with other demonstrations."""
        first, *further = shown
        return replace(self, **vars(first), further=tuple(further))


def check_label(label: Any) -> str:
    """Return a label without white space around it.

    Raises
    ------
    GestureError
        When it is empty, longer than `MAX_LABEL_LENGTH` or not printable.

    """
    if not isinstance(label, str) or not label.strip():
        raise GestureError(f"a gesture's label must be a word or a few, got {label!r}")
    if len(label) > MAX_LABEL_LENGTH or not is_printable(label):
        raise GestureError(
            f"a gesture's label must be at most {MAX_LABEL_LENGTH} printable characters, "
            f"got {label[:MAX_LABEL_LENGTH]!r} ({len(label)})"
        )
    return label.strip()


def make_label(label: Any) -> str:
    """Return a new label in the form that is stored, see `look_alikes.compose`.

    Raises
    ------
    GestureError
        As `check_label`, and when nothing of the label can be seen.

    """
    made = compose(check_label(label))
    if not skeleton(made):
        raise GestureError(f"nothing of the label {made!r} can be seen: write it in letters")
    return made


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
