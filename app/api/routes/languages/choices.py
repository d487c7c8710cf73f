"""Routes of a choice: which gestures to keep, and another movement for one of a language."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from fastapi import APIRouter
from pydantic import Field, model_validator

from app.api.http.problems import ProblemError, problem_responses
from app.api.http.schemas import gestures as schemas
from app.api.http.schemas.languages import LanguageView
from app.api.http.schemas.values import Body, Identifier, Label, View
from app.api.routes.asked_revisions import CurrentEdit, CurrentRevision
from app.api.services.demonstration_sources import digests_of
from app.api.services.gesture_edits import demonstration_at, gesture_in, gestures_from
from app.api.services.limited_routes import computed, edited
from app.api.services.running_studio import CurrentStudio, Studio
from app.api.services.sample_library import STROKES, Samples
from app.api.services.stored_languages import language_of, recognizer_of
from app.api.services.stored_recognitions import load_known
from app.recognition import Gesture, Language
from app.recognition.explanation.context import KnownTake
from app.recognition.health.choice import (
    Replacement,
    describe_people,
    find_replacements,
    join_candidates,
    measure_confusions,
)
from app.resources import known_signs_file
from app.store import ClipStore, LanguageState, NotFound
from app.ui.charts import data_url, mark_gesture

MOST_COMPARED = 300
"""Most demonstrations of a language and candidates: each is compared with every gesture, for
seconds."""

SIGNS = known_signs_file().stem
"""Sample language of the signs that divers know."""

SAMPLES = ("osg-table-2", STROKES, SIGNS)
"""Samples whose gestures are candidates."""

router = APIRouter(prefix="/languages", tags=["languages"])

PEOPLE = "By whose demonstrations this is known, in a sentence"


class ChoiceRequest(schemas.GesturesDraft):
    """Takes of clips, of which some are to become gestures."""

    keep: Annotated[int, Field(ge=1, le=schemas.MOST_GESTURES_AT_ONCE)]
    """How many of them."""
    language_id: Identifier | None = None
    """Language that has gestures beside them; null: a new one."""


class LeftOutView(View):
    """A take that is left out."""

    index: int
    """Its place in the request."""
    other: str
    """The gesture that stays and is most like it."""
    words: str
    """How alike the two are, and how that is known."""


class ChoiceView(View):
    """The takes of a request that are told apart best, beside the gestures of the language."""

    keep: list[int]
    """Their places in the request."""
    left_out: list[LeftOutView]
    people: str = Field(description=PEOPLE)


class ReplacementsRequest(Body):
    """A gesture of a language that may get another movement."""

    label: Label
    gestures: Annotated[
        list[schemas.GestureDraft], Field(max_length=schemas.MOST_GESTURES_AT_ONCE)
    ] = Field(default=[])
    """Takes of clips that may take its place; those that cannot are left out."""


class AlikeView(View):
    """Two gestures, and how far apart they would be."""

    gestures: tuple[str, str]
    words: str


class ReplacementView(View):
    """Another movement for a gesture, and what it would do to the language."""

    sample: str | None
    """Sample language that has it, or `strokes`; null: a take of a clip."""
    gesture: str
    """Its label in the sample language or in the request."""
    index: int | None
    """Its place among the request's takes; null: a sample's."""
    sign: str | None
    """What divers mean by it, where that is not the gesture's label; null: nothing."""
    image: str
    """Trajectory image with its direction, a data URI of a PNG."""
    before: float
    """How much all gestures are mixed up now, 0 to 1; for the order, nobody has measured it."""
    after: float
    """The same with this movement."""
    nearest: AlikeView | None
    """The gesture with this movement, and the one that would be nearest to it."""
    alike: list[AlikeView]
    """Pairs that would be nearly alike, the worst first."""


class ReplacementsView(View):
    """The movements that would be told apart better than a gesture's own, the best first."""

    label: str
    people: str | None = Field(description=f"{PEOPLE}; null: there is no such movement")
    replacements: list[ReplacementView]


class ReplacementDraft(Body):
    """Another movement for a gesture: one of a sample language, or a take of a clip."""

    label: Label
    """Of the gesture; it stays, with command and description."""
    sample: Identifier | None = None
    gesture: Label | None = None
    """Label in the sample language."""
    demonstration: schemas.NewDemonstration | None = None

    @model_validator(mode="after")
    def _require_one(self) -> ReplacementDraft:
        of_sample = self.sample is not None and self.gesture is not None
        of_neither = self.sample is None and self.gesture is None
        if not (of_sample if self.demonstration is None else of_neither):
            raise ValueError("give either sample and gesture, or demonstration")
        return self


@router.post("/choice", responses=problem_responses(404, 409))
@computed
def choose_gestures(
    choice: ChoiceRequest, studio: CurrentStudio, advance: Callable[[], None]
) -> ChoiceView:
    """Return which takes of clips to make gestures of, so that they are told apart best.

    The gestures of the language stay. Nothing is written.
    """
    state = None if choice.language_id is None else studio.languages.get(choice.language_id)
    language = Language("choice", []) if state is None else language_of(state)
    _require_few(language, len(choice.gestures))
    made = gestures_from(studio.clips, choice.gestures, language.trigger)
    joined = join_candidates(language, [gesture for gesture, _ in made])
    known = [] if state is None else _load_known(studio, state, language)
    confusions = measure_confusions(joined, known, advance=advance)
    fixed = list(range(len(language.gestures)))
    chosen = confusions.choose(choice.keep, fixed)
    labels = [*language.labels, *(draft.label for draft in choice.gestures)]
    kept, left_out = [*fixed, *chosen], []
    for index in sorted({*range(len(fixed), len(labels))} - {*chosen}):
        nearest = kept[int(np.argmax(confusions.rates[index, kept]))]
        words = confusions.compare(index, nearest).words
        left_out.append(LeftOutView(index=index - len(fixed), other=labels[nearest], words=words))
    return ChoiceView(
        keep=[each - len(fixed) for each in chosen],
        left_out=left_out,
        people=describe_people(confusions.people),
    )


@router.post("/{language_id}/replacements", responses=problem_responses(404))
@computed
def propose_replacements(
    wanted: ReplacementsRequest,
    asked: CurrentRevision,
    studio: CurrentStudio,
    advance: Callable[[], None],
) -> ReplacementsView:
    """Return the movements that fit best in the place of a gesture; nothing is written.

    Candidates are the figures of the samples and single strokes that the language does not have,
    movements for a movement and held hand shapes for a held one, and the takes of the request;
    where none is told apart better, also the signs by which divers mean something else.
    """
    language = asked.language
    own = gesture_in(language, wanted.label)
    samples = list(_list_samples(studio.samples, language, own))
    _require_few(language, len(samples) + len(wanted.gestures))
    candidates = [*samples, *_list_takes(studio.clips, wanted.gestures, language, advance)]
    known = _load_known(studio, asked.state, language)
    views: list[ReplacementView] = []
    found: tuple[Replacement, ...] = ()
    # A robot would act on a sign that one diver shows to another, so others are proposed first.
    for signs in (False, True):
        among = [each for each in candidates if (each.sign is not None) == signs]
        if found or not among:
            continue
        gestures = [each.gesture for each in among]
        found = find_replacements(language, wanted.label, gestures, known, advance=advance)
        views = [among[each.candidate].view(each) for each in found]
    people = describe_people(found[0].people) if found else None
    return ReplacementsView(label=wanted.label, people=people, replacements=views)


@router.put("/{language_id}/replacements", responses=problem_responses(404, 409, 412))
@edited
def replace_gesture(draft: ReplacementDraft, edit: CurrentEdit) -> LanguageView:
    """Give a gesture another movement in one revision; label, command and description stay.

    Takes of the test set that show its former movement are set aside.
    """
    where, shown = draft.demonstration, None
    if where is None:
        sample = edit.studio.samples.movements().get(draft.sample or "")
        if sample is None:
            raise ProblemError(404, "not_found", f"there are no samples {draft.sample!r}")
        other = gesture_in(sample, draft.gesture or "")
    else:
        shown = demonstration_at(edit.studio.clips, where, edit.trigger)
        other = Gesture.from_demonstration(draft.label, shown.poses, diver=where.diver)

    former: list[str] = []

    def edit_language(language: Language) -> Language:
        own = gesture_in(language, draft.label)
        former[:] = filter(None, digests_of(language)[own.label])
        return language.with_changed(
            replace(other, label=own.label, command=own.command, description=own.description)
        )

    state = edit.save(f"Change the movement of {draft.label}", edit_language)
    if former:
        edit.studio.takes.set_aside(edit.language_id, draft.label, former)
    if where is not None and shown is not None:
        edit.studio.demonstrations.keep(state, draft.label, where, shown)
    return edit.answer(state)


@dataclass(frozen=True)
class _Candidate:
    """A gesture of a sample language, or of a take of the request at an index."""

    gesture: Gesture
    sample: str | None = None
    index: int | None = None
    sign: str | None = None

    def view(self, found: Replacement) -> ReplacementView:
        """Return it as the API shows it."""
        return ReplacementView(
            sample=self.sample,
            gesture=self.gesture.label,
            index=self.index,
            sign=self.sign,
            image=data_url(mark_gesture(self.gesture)),
            before=found.before,
            after=found.after,
            nearest=None if found.nearest is None else AlikeView.model_validate(found.nearest),
            alike=[AlikeView.model_validate(pair) for pair in found.alike],
        )


def _list_samples(library: Samples, language: Language, own: Gesture) -> Iterator[_Candidate]:
    """Yield the samples' gestures of the kind of `own` whose movement a language lacks."""
    shown = [each for gesture in language.gestures for each in gesture.trajectories]
    samples = library.movements()
    for name in SAMPLES:
        for gesture in samples[name].gestures if name in samples else ():
            movement = gesture.trajectory
            if movement is None or gesture.is_held != own.is_held:
                continue
            if any(np.array_equal(movement.xy, each.xy, equal_nan=True) for each in shown):
                continue
            means_other = name == SIGNS and gesture.label.casefold() != own.label.casefold()
            yield _Candidate(gesture, name, sign=gesture.description if means_other else None)


def _list_takes(
    clips: ClipStore,
    drafts: Sequence[schemas.GestureDraft],
    language: Language,
    advance: Callable[[], None],
) -> Iterator[_Candidate]:
    """Yield the gestures of those drafts that can become one."""
    for index, draft in enumerate(drafts):
        advance()
        try:
            ((gesture, _),) = gestures_from(clips, [draft], language.trigger)
        except (ProblemError, NotFound):
            continue
        yield _Candidate(gesture, index=index)


def _load_known(studio: Studio, state: LanguageState, language: Language) -> list[KnownTake]:
    """Return the takes of the test set and of practice that are no demonstrations."""
    if not language.gestures:
        return []
    known = load_known(studio, state.record.id, recognizer_of(state, "full"))
    return [each for each in known if not each.without]


def _require_few(language: Language, candidates: int) -> None:
    """Refuse more demonstrations than can be compared while somebody waits."""
    count = candidates + sum(1 + len(gesture.further) for gesture in language.gestures)
    if count > MOST_COMPARED:
        detail = (
            f"the language and the candidates have {count} demonstrations; at most "
            f"{MOST_COMPARED} are compared at once"
        )
        raise ProblemError(422, "too_many_gestures", detail)
