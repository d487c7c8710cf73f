"""Response bodies of stored languages and gestures."""

from __future__ import annotations

import json
from urllib.parse import urlencode

from fastapi import Response

from app.api.http.revisions import revision_tag
from app.api.http.schemas.gestures import GestureView, SourceView
from app.api.http.schemas.languages import LanguageSummary, LanguageView
from app.api.services.demonstration_sources import sources_in
from app.api.services.studio import Studio
from app.recognition.gestures.gesture import Gesture
from app.recognition.language.grammar_entry import grammar_to_entry
from app.recognition.language.tuning_entry import tuning_to_entry
from app.store import LanguageState


def announce(studio: Studio, state: LanguageState, response: Response) -> LanguageView:
    """Publish that a language changed, and answer with it."""
    studio.broadcast.publish("languages", id=state.record.id)
    return answer(studio, state, response)


def answer(studio: Studio, state: LanguageState, response: Response) -> LanguageView:
    """Answer with a language, its ETag in the head."""
    response.headers["ETag"] = revision_tag(state.revision.revision)
    language = studio.language(state)
    sources = sources_in(studio, language)
    return LanguageView(
        **view_summary(state).model_dump(),
        gestures=[
            view_gesture(state, gesture, sources.get(gesture.label))
            for gesture in language.gestures
        ],
        grammar=None if language.grammar is None else grammar_to_entry(language.grammar),
        profile=language.profile,
        tuning=tuning_to_entry(language.tuning),
        tuning_words=language.tuning.words,
    )


def view_summary(state: LanguageState) -> LanguageSummary:
    """Return a language as it stands in a list."""
    record, row = state.record, state.revision
    return LanguageSummary(
        id=record.id,
        name=row.name,
        revision=row.revision,
        author=row.author,
        change=row.change,
        labels=json.loads(row.labels),
        sample=record.sample,
        created=record.created,
        updated=row.created,
    )


def view_gesture(
    state: LanguageState, gesture: Gesture, source: SourceView | None = None
) -> GestureView:
    """Return a gesture of a revision; `source` is the clip of its demonstration."""
    # The revision in the address lets browsers keep the picture until the gesture changes.
    query = urlencode({"label": gesture.label, "revision": state.revision.revision})
    switches = gesture.switches
    return GestureView(
        direction=switches.direction,
        tempo=switches.tempo,
        mirror=switches.mirror,
        label=gesture.label,
        description=gesture.description,
        command=gesture.command,
        salient=list(gesture.salient),
        thumbnail=f"/api/v1/languages/{state.record.id}/gestures/image?{query}",
        has_trajectory=gesture.trajectory is not None,
        source=source,
    )
