"""Routes of the preview: a gesture and its effect on the language, before it is saved."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Annotated

from fastapi import APIRouter, Query
from pydantic import Field

from app.api.http.problems import ProblemError, problem_responses
from app.api.http.schemas import gestures as schemas
from app.api.http.schemas.values import Body, Label, View
from app.api.routes.asked_revisions import NewestRevision
from app.api.services import gesture_edits
from app.api.services.demonstration_sources import view_faults
from app.api.services.limited_routes import computed
from app.api.services.running_studio import Clips
from app.api.services.trajectory_images import draw_trajectory_image
from app.recognition import Gesture, GestureError, Language, Recognizer
from app.recognition.explanation.strokes import transcribe_gesture
from app.recognition.explanation.transcript import describe_strokes
from app.recognition.features.motion import find_hands
from app.recognition.features.png import to_data_url
from app.recognition.gestures.demonstration import condense
from app.recognition.gestures.switches import Sensitivity, describe_effects
from app.recognition.health.check import rank_others
from app.recognition.health.finding import DUPLICATE, measure_visible_share
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing import salience
from app.recognition.voters.registry import PAPER_VOTERS
from app.store import ClipStore

DISPLACEMENT_DIGITS = 3
"""Decimals of a displacement in torso lengths: about a millimetre on a diver."""

MOST_NEAR = 3
"""Gestures that are listed beside the edited one."""

router = APIRouter(prefix="/languages/{language_id}", tags=["gestures"])


class PreviewRequest(Body):
    """A gesture as it would be saved."""

    label: Label | None = None
    """Which gesture is changed; null: a new."""
    change: schemas.GestureChange
    """A new gesture needs its demonstration."""


class KeypointView(View):
    """How much of a gesture one keypoint shows."""

    landmark: str
    displacement: float
    """Peak to peak, in the preview's unit."""
    seen: float
    """Share of the moments in which it was seen, 0 to 1."""
    usual: bool
    """Whether it may be proposed: the one that stands for its hand."""
    proposed: bool
    """Whether it moves enough to be proposed."""


class DescriptorView(View):
    """How one voter describes the trajectory image."""

    voter: str
    unit: str
    """What a distance of 1 between two descriptors means."""
    values: list[float]


class PreviewView(View):
    """What a gesture would be."""

    problem: str | None
    """Why it cannot be saved like this; null: it can."""
    image: str | None
    """The trajectory image, a data URI of a PNG."""
    salient: list[str]
    """The keypoints that are drawn."""
    held_shapes: int = Field(description=schemas.HELD_SHAPES)
    keypoints: list[KeypointView]
    """Empty without a demonstration."""
    threshold: Annotated[float, Field(ge=0)] | None
    """Displacement from which a keypoint is proposed."""
    unit: str
    """Of displacements: torso_length, or extent without a torso."""
    descriptors: list[DescriptorView]
    start: float | None
    """Seconds of the clip; null without one."""
    end: float | None
    seconds: float | None
    """How long the demonstration lasts."""
    strokes: str = Field(description=schemas.STROKES)
    faults: list[schemas.DemonstrationFaultView]
    """Why its range of the clip is a bad demonstration, the gravest fault first."""


class SwitchView(View):
    """A switch, and what comes of it in this language."""

    position: schemas.SwitchPosition
    counts: bool | None
    """Null: only the drawing is compared."""
    words: str


class NearGestureView(View):
    """Another gesture of the language, and how far it is."""

    label: str
    distance: float
    """As in the health report; 1: two typical gestures."""
    same: bool
    """Whether the robot cannot distinguish the two."""


class OutlookView(View):
    """What is to be expected of a gesture in its language."""

    switches: dict[str, SwitchView]
    nearest: list[NearGestureView] | None
    """The nearest first; null: it has no demonstration to compare."""


@router.post("/preview", responses=problem_responses(404, 409))
@computed
def preview_gesture(
    asked: NewestRevision,
    request: PreviewRequest,
    clips: Clips,
    *,
    marks: Annotated[bool, Query(description="Image with start dot and arrow, for people")] = False,
) -> PreviewView:
    """Return what a gesture would be; nothing is written."""
    language = asked.language
    draft = _draft(language, request, clips)
    try:
        gesture = draft.gesture()
    except GestureError as error:
        return _view(None, draft, str(error), marks=marks)
    where = request.change.demonstration
    faults = [] if where is None else view_faults(clips, where, gesture, language.trigger)
    return _view(gesture, draft, None, marks=marks, faults=faults)


@router.post("/preview/health", responses=problem_responses(404, 409))
@computed
def preview_health(
    asked: NewestRevision, request: PreviewRequest, clips: Clips, advance: Callable[[], None]
) -> OutlookView:
    """Return how a gesture would change its language's report; nothing is written."""
    language = asked.language
    advance()
    draft = _draft(language, request, clips)
    gesture = draft.gesture()
    advance()
    recognizer = Recognizer(draft.language(), "full")
    advance()
    return OutlookView(
        switches=_switch_views(gesture, recognizer.sensitivity(gesture.label)),
        nearest=_nearest(gesture, recognizer),
    )


def _nearest(gesture: Gesture, recognizer: Recognizer) -> list[NearGestureView] | None:
    """Return the gestures that are nearest to a gesture of the recogniser's language."""
    if gesture.trajectory is None:
        return None
    labels = recognizer.language.labels
    scores = recognizer.compare(condense(gesture.trajectory)).scores
    others = rank_others(labels, scores, labels.index(gesture.label))[:MOST_NEAR]
    return [
        NearGestureView(label=label, distance=distance, same=distance < DUPLICATE)
        for label, distance in others
    ]


def _draft(
    language: Language, request: PreviewRequest, clips: ClipStore
) -> gesture_edits.EditedGesture:
    where = request.change.demonstration
    if request.label is not None:
        gesture_edits.gesture_in(language, request.label)
    elif where is None:
        detail = "a new gesture needs a demonstration: name its clip"
        raise ProblemError(422, "request_invalid", detail, pointer="/change/demonstration")
    shown = (
        None if where is None else gesture_edits.demonstration_at(clips, where, language.trigger)
    )
    return gesture_edits.EditedGesture(language, request.label, request.change, shown)


def _view(
    gesture: Gesture | None,
    draft: gesture_edits.EditedGesture,
    problem: str | None,
    *,
    marks: bool,
    faults: Sequence[schemas.DemonstrationFaultView] = (),
) -> PreviewView:
    trajectory, shown = draft.trajectory(), draft.demonstration
    return PreviewView(
        problem=problem,
        image=None if gesture is None else to_data_url(draw_trajectory_image(gesture, marks)),
        salient=[] if gesture is None else list(gesture.salient),
        held_shapes=0 if gesture is None else len(gesture.held_shapes),
        keypoints=[] if trajectory is None else _keypoints(trajectory),
        threshold=None if trajectory is None else salience.find_least_displacement(trajectory),
        unit="torso_length" if trajectory is None else trajectory.unit,
        descriptors=[] if gesture is None else _descriptors(gesture),
        start=None if shown is None else shown.start,
        end=None if shown is None else shown.end,
        seconds=None if trajectory is None else float(trajectory.time[-1] - trajectory.time[0]),
        strokes="" if gesture is None else describe_strokes(transcribe_gesture(gesture)),
        faults=list(faults),
    )


def _keypoints(trajectory: Trajectory) -> list[KeypointView]:
    moved, usual = (
        salience.measure_displacements(trajectory),
        salience.choose_representatives(trajectory),
    )
    proposed = salience.find_salient_landmarks(trajectory)
    views = [
        KeypointView(
            landmark=name,
            displacement=round(moved[name], DISPLACEMENT_DIGITS),
            seen=measure_visible_share(trajectory, name),
            usual=name in usual,
            proposed=name in proposed,
        )
        for name in trajectory.landmarks
    ]
    return sorted(views, key=lambda view: -view.displacement)


def _descriptors(gesture: Gesture) -> list[DescriptorView]:
    return [
        DescriptorView(
            voter=voter.name, unit=voter.unit, values=gesture.descriptors[voter.name].tolist()
        )
        for voter in PAPER_VOTERS
        if voter.name in gesture.descriptors
    ]


def _switch_views(gesture: Gesture, counting: Sensitivity | None) -> dict[str, SwitchView]:
    words = describe_effects(
        gesture.switches, counting, hands=find_hands(gesture.salient), held=gesture.is_held
    )
    counts: dict[str, bool] = {}
    if counting is not None:
        sides_free = gesture.switches.mirror == "on" or not counting.sides
        counts = {
            "direction": counting.direction,
            "tempo": counting.tempo,
            "mirror": not sides_free,
            "hand_shape": counting.hand_shape,
        }
    return {
        name: SwitchView(position=position, counts=counts.get(name), words=words[name])
        for name, position in vars(gesture.switches).items()
    }
