"""Response bodies of stored languages and gestures."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import zip_longest
from urllib.parse import urlencode

from fastapi import Response

from app.api.http.revisions import revision_tag
from app.api.http.schemas.gestures import DemonstrationView, GestureView, SourceView
from app.api.http.schemas.languages import LanguageSummary, LanguageView
from app.api.services.language_documents import draft_of
from app.api.services.running_studio import Studio
from app.api.services.stored_languages import DocumentCache, language_of
from app.recognition import Language
from app.recognition.explanation.strokes import transcribe_gesture
from app.recognition.explanation.transcript import describe_strokes
from app.recognition.gestures.gesture import Gesture
from app.recognition.language.file import seal, short_code
from app.recognition.language.file_schema import trigger_to_entry, tuning_to_entry
from app.recognition.language.grammar_entry import grammar_to_entry
from app.store import Draft, LanguageRevision, LanguageState, Quota


def save_revision(
    studio: Studio,
    quota: Quota,
    language_id: str,
    words: str,
    change: Callable[[Language], Language],
    expected: int | None = None,
) -> LanguageState:
    """Store the revision that `change` makes of the newest one, with `words` for its history.

    Errors as `LanguageStore.edit`.
    """

    def edit(head: LanguageRevision, number: int) -> Draft:
        language = change(Language.from_json(head.document))
        return draft_of(replace(language, revision=number), words)

    return studio.keep_within(
        quota, lambda: studio.languages.edit(language_id, edit, expected, quota)
    )


def add_language(
    studio: Studio,
    quota: Quota,
    draft: Draft,
    revision: int,
    response: Response,
    sample: str | None = None,
) -> LanguageView:
    """Store a new language, publish it and answer with it; errors as `LanguageStore.create`."""
    create = partial(studio.languages.create, draft, revision, sample=sample, quota=quota)
    return announce(studio, studio.keep_within(quota, create), response)


def announce(studio: Studio, state: LanguageState, response: Response) -> LanguageView:
    """Publish that a language changed, and answer with it."""
    studio.broadcast.publish("languages", id=state.record.id)
    return answer(studio, state, response)


def answer(studio: Studio, state: LanguageState, response: Response) -> LanguageView:
    """Answer with a language, and set its ETag header."""
    response.headers["ETag"] = revision_tag(state.revision.revision)
    language = language_of(state)
    sources = studio.demonstrations.view(language)
    return LanguageView(
        **view_summary(state).model_dump(),
        gestures=[
            view_gesture(state, gesture, sources[gesture.label]) for gesture in language.gestures
        ],
        grammar=None if language.grammar is None else grammar_to_entry(language.grammar),
        sha256=(sha256 := _checksums.get(state.revision.document)),
        code=short_code(sha256),
        profile=language.profile,
        tuning=tuning_to_entry(language.tuning),
        tuning_words=language.tuning.words,
        most_refused=language.most_refused,
        trigger=trigger_to_entry(language.trigger),
        trigger_words=language.trigger.words,
    )


_checksums = DocumentCache(lambda document: seal(json.loads(document)))


def view_summary(state: LanguageState) -> LanguageSummary:
    """Return a language as it stands in a list."""
    row = state.revision
    return LanguageSummary(
        **state.record.model_dump(include={"id", "sample", "created"}),
        **row.model_dump(include={"name", "revision", "author", "change"}),
        labels=row.labels,
        updated=row.created,
    )


def view_gesture(
    state: LanguageState, gesture: Gesture, sources: Sequence[SourceView | None] = ()
) -> GestureView:
    """Return a gesture of a revision; `sources` are the clips of its demonstrations."""
    # With the revision in the address, browsers can keep the picture until the gesture changes.
    query = urlencode({"label": gesture.label, "revision": state.revision.revision})
    return GestureView(
        **vars(gesture.switches),
        label=gesture.label,
        description=gesture.description,
        command=gesture.command,
        salient=list(gesture.salient),
        held_shapes=len(gesture.held_shapes),
        thumbnail=f"/api/v1/languages/{state.record.id}/gestures/image?{query}",
        has_trajectory=gesture.trajectory is not None,
        source=sources[0] if sources else None,
        demonstrations=view_demonstrations(state, gesture, sources),
    )


def view_demonstrations(
    state: LanguageState, gesture: Gesture, sources: Sequence[SourceView | None] = ()
) -> list[DemonstrationView]:
    """Return the demonstrations of a gesture of a revision."""
    place = f"/api/v1/languages/{state.record.id}/demonstrations"
    query = urlencode({"label": gesture.label, "revision": state.revision.revision})
    return [
        DemonstrationView(
            index=index,
            diver=shown.diver,
            salient=list(shown.salient),
            held_shapes=len(shown.held_shapes),
            seconds=None if shown.trajectory is None else float(shown.trajectory.time[-1]),
            strokes=describe_strokes(transcribe_gesture(shown)),
            thumbnail=f"{place}/{index}/image?{query}",
            source=source,
        )
        for index, (shown, source) in enumerate(
            zip_longest(gesture.single_demonstrations(), sources)
        )
    ]
