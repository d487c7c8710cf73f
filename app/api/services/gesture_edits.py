"""Edits of a gesture as a request describes them, applied to a language in memory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from app.api.http.problems import ProblemError, problem_of
from app.api.http.schemas.gestures import (
    DemonstrationDraft,
    GestureChange,
    GestureDraft,
    NewDemonstration,
)
from app.api.services.recording_cache import recording_of
from app.recognition import Gesture, GestureError, Language, PoseError, PoseSequence
from app.recognition.errors import RangeError
from app.recognition.gestures.switches import Switches
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.repair import repair_poses
from app.recognition.recording.clip_range import ClipRange, find_clip_range
from app.recognition.text.look_alikes import find_confusable
from app.recognition.triggers.trigger import Trigger
from app.store import ClipStore, DemonstrationSource

UNNAMED = "this gesture"
"""Name in messages for a gesture that has no label yet."""

WORDS = frozenset({"label", "description", "command", "diver"})
"""Fields of a gesture that are for people and the robot, and do not affect recognition."""


def demonstration_at(
    clips: ClipStore, where: NewDemonstration | DemonstrationSource, trigger: Trigger
) -> ClipRange:
    """Find the demonstration that a request or a source names, in takes by a language's trigger.

    Raises
    ------
    NotFound
        When there is no such clip.
    ProblemError
        409 while its poses are not extracted.
    RangeError
        As `find_clip_range`.

    """
    recording = recording_of(clips, where.clip_id)
    return find_clip_range(
        recording, where.start, where.end, keep_transit=where.keep_transit, trigger=trigger
    )


def gesture_from(draft: GestureDraft, demonstration: ClipRange) -> Gesture:
    """Return the gesture that a draft describes.

    Raises
    ------
    GestureError
        When the demonstration is none.

    """
    gesture = Gesture.from_demonstration(
        draft.label,
        demonstration.poses,
        salient=draft.salient or None,
        description=draft.description,
        command=draft.command,
        diver=draft.diver,
    )
    switches = set_switches(gesture.switches, draft)
    return replace(gesture, switches=switches)


def gestures_from(
    clips: ClipStore, drafts: Sequence[GestureDraft], trigger: Trigger
) -> list[tuple[Gesture, ClipRange]]:
    """Return the gestures that drafts describe, with their demonstrations.

    Raises
    ------
    ProblemError
        With the place of the draft, when its clip is not ready or its take cannot be a gesture.
    NotFound
        When there is no such clip.

    """
    made = []
    for index, draft in enumerate(drafts):
        try:
            demonstration = demonstration_at(clips, draft, trigger)
            made.append((gesture_from(draft, demonstration), demonstration))
        except (ProblemError, GestureError, RangeError) as error:
            problem = problem_of(error)
            raise ProblemError(
                problem.status_code,
                problem.code,
                f"{draft.label}: {problem.detail}",
                pointer=f"/gestures/{index}",
            ) from error
    return made


def add_gestures_to(language: Language, gestures: Sequence[Gesture]) -> Language:
    """Return a language with further gestures.

    Raises
    ------
    ProblemError
        409 when a label is taken, by the language or by another one of the gestures.

    """
    for index, gesture in enumerate(gestures):
        require_free(language.labels, gesture.label, f"/gestures/{index}/label")
        language = language.with_gesture(gesture)
    return language


def set_switches(switches: Switches, wanted: GestureDraft | GestureChange) -> Switches:
    """Return the switches, changed to those values of the request that are not None."""
    return Switches(
        **{name: getattr(wanted, name) or kept for name, kept in vars(switches).items()}
    )


def change_gesture_of(
    language: Language, label: str, change: GestureChange, demonstration: ClipRange | None
) -> Language:
    """Return a language in which one gesture is changed.

    Parameters
    ----------
    language
        Language that has the gesture.
    label
        Label of the gesture before the change.
    change
        The requested change; omitted fields stay.
    demonstration
        The demonstration that `change` names, if any.

    Raises
    ------
    ProblemError
        404 without such a gesture, 409 when its new label is taken, 422 when the salient keypoints
        do not fit it.
    GestureError
        When the demonstration is none.

    """
    gesture = gesture_in(language, label)
    if change.label is not None and change.label.strip() != gesture.label:
        require_free(language.labels, change.label.strip(), instead_of=gesture.label)
    # The command may be null on purpose; any other null field was omitted.
    fields = {
        name: getattr(change, name)
        for name in change.model_fields_set & WORDS
        if name == "command" or getattr(change, name) is not None
    }
    changed = gesture
    if demonstration is not None:
        diver = "" if change.demonstration is None else change.demonstration.diver
        show = Gesture.with_demonstration if change.further else _remake
        changed = show(gesture, demonstration.poses, diver, salient=change.salient or None)
    elif change.salient:
        changed = _set_salient(gesture, change.salient)
    switches = set_switches(changed.switches, change)
    changed = replace(changed, switches=switches, **fields)
    if changed.label != gesture.label:
        language = language.renamed(gesture.label, changed.label)  # and in its phrases
    gestures = [changed if each.label == changed.label else each for each in language.gestures]
    return replace(language, gestures=gestures)


def add_demonstration_to(
    language: Language, draft: DemonstrationDraft, demonstration: ClipRange
) -> Language:
    """Return a language in which a gesture has one more demonstration.

    Raises
    ------
    ProblemError
        404 without such a gesture.
    GestureError
        When the demonstration is none, or the gesture has as many as it may.

    """
    gesture = gesture_in(language, draft.label)
    return language.with_changed(
        gesture.with_demonstration(demonstration.poses, draft.diver, salient=draft.salient or None)
    )


def remove_demonstration_from(language: Language, label: str, index: int) -> Language:
    """Return a language in which a gesture has one demonstration fewer.

    Raises
    ------
    ProblemError
        404 without such a gesture or demonstration, 409 when it is the only one.

    """
    gesture = gesture_in(language, label)
    require_demonstration(gesture, index)
    try:
        return language.with_changed(gesture.without_demonstration(index))
    except GestureError as error:
        raise ProblemError(409, "demonstration_needed", str(error)) from error


def require_demonstration(gesture: Gesture, index: int) -> Gesture:
    """Return the gesture of one demonstration.

    Raises
    ------
    ProblemError
        404 when there is none of that index.

    """
    shown = gesture.single_demonstrations()
    if not 0 <= index < len(shown):
        detail = (
            f"{gesture.label!r} has no demonstration {index}; it has {len(shown)}, counted from 0"
        )
        raise ProblemError(404, "not_found", detail)
    return shown[index]


def gesture_in(language: Language, label: str) -> Gesture:
    """Return the gesture of that label.

    Raises
    ------
    ProblemError
        404 when there is none.

    """
    for gesture in language.gestures:
        if gesture.label == label:
            return gesture
    raise ProblemError(404, "not_found", f"there is no gesture {label[:80]!r} in this language")


def require_free(
    labels: Sequence[str], label: str, pointer: str = "/label", instead_of: str | None = None
) -> None:
    """Refuse a label that looks like one of the language's.

    Parameters
    ----------
    labels
        The language's.
    label
        A new one.
    pointer
        Its place in the request.
    instead_of
        The label that it replaces.

    Raises
    ------
    ProblemError
        409 when one has it.

    """
    others = [each for each in labels if each != instead_of]
    if (taken := find_confusable(label, others)) is not None:
        detail = f"the language has a gesture {label!r} already; choose another label"
        if taken != label:
            detail = (
                f"the label {label!r} looks like {taken!r}, which the language has; choose another"
            )
        raise ProblemError(409, "label_taken", detail, pointer=pointer)


def _remake(
    gesture: Gesture, poses: PoseSequence, diver: str, *, salient: Sequence[str] | None
) -> Gesture:
    """Replace the first demonstration; texts, command and switches stay."""
    made = Gesture.from_demonstration(gesture.label, poses, salient=salient, diver=diver)
    return replace(
        made,
        description=gesture.description,
        command=gesture.command,
        switches=gesture.switches,
        further=gesture.further,
    )


def _set_salient(gesture: Gesture, names: list[str]) -> Gesture:
    """Draw and describe a gesture again, with other salient keypoints."""
    try:
        return gesture.with_salient(names)
    except GestureError as error:
        raise ProblemError(422, "gesture_unusable", str(error), pointer="/salient") from error


@dataclass(frozen=True)
class EditedGesture:
    """A gesture that is being edited, in its language.

    Attributes
    ----------
    of
        The language.
    known
        Label of the gesture in it; None: a new gesture.
    change
        What is changed of it, or a new gesture's demonstration.
    demonstration
        The demonstration that the change names; None if it names none.

    """

    of: Language
    known: str | None
    change: GestureChange
    demonstration: ClipRange | None

    @property
    def label(self) -> str:
        """Label of the gesture, or `UNNAMED`."""
        label = self.known or UNNAMED
        while self.known is None and label in self.of.labels:
            label += "'"
        return label

    def language(self) -> Language:
        """Return the language with it."""
        change = self.change
        if self.known is not None:
            words = change.model_copy(update={"label": None})
            return change_gesture_of(self.of, self.label, words, self.demonstration)
        assert self.demonstration is not None  # a new gesture needs one
        made = Gesture.from_demonstration(
            self.label, self.demonstration.poses, salient=change.salient or None
        )
        switches = set_switches(Switches(), change)
        return self.of.with_gesture(replace(made, switches=switches))

    def gesture(self) -> Gesture:
        """Return the gesture itself."""
        return self.language().gesture(self.label)

    def trajectory(self) -> Trajectory | None:
        """Return the trajectory with all known landmarks; None if none is known."""
        if self.demonstration is None:
            return gesture_in(self.of, self.label).trajectory
        try:
            return Trajectory.from_poses(repair_poses(self.demonstration.poses).poses)
        except PoseError:
            return None
