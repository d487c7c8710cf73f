"""Known takes of a language: those of its test set and of practice, whose labels are known."""

from __future__ import annotations

from collections.abc import Iterator

from app import store
from app.api.http.problems import ProblemError
from app.api.services.demonstration_sources import LeftOut, OwnDemonstrations
from app.api.services.running_studio import Studio
from app.recognition import OsgError, Recognizer
from app.recognition.explanation.context import KnownTake
from app.recognition.recording.clip_range import find_clip_range

MOST_KNOWN_TAKES = 60
"""Most known takes by which remedies are judged, the newest first; each is recognised again with
every remedy."""

MOST_APART = 12
"""Most languages without a demonstration that read known takes; each is made for every remedy."""


def list_known(studio: Studio, language_id: str) -> list[store.LabelledTake | store.PracticeTake]:
    """Return the takes of the test set and of practice, the oldest first, each range once."""
    tested = [each.take for each in studio.labelled.of(language_id)]
    takes: list[store.LabelledTake | store.PracticeTake] = [
        *tested,
        *studio.practice.of(language_id),
    ]
    return list({(each.clip_id, round(each.start, 2)): each for each in takes}.values())


def load_known(
    studio: Studio, language_id: str, recognizer: Recognizer, *, but: str | None = None
) -> Iterator[KnownTake]:
    """Yield the known takes of a language, the newest first.

    One that is a demonstration is read without it; where its gesture has no other one, it is left
    out.

    Parameters
    ----------
    studio
        Running studio with the takes.
    language_id
        The language's.
    recognizer
        Of a revision of it.
    but
        A clip whose takes are left out.

    """
    language = recognizer.language
    own, count, apart = OwnDemonstrations(studio, language), 0, set[LeftOut]()
    for take in reversed(list_known(studio, language_id)):
        former = take.former if isinstance(take, store.LabelledTake) else None
        if take.clip_id == but or take.expected not in language.labels:
            continue
        if own.show_former(take.expected, former):
            continue
        if count == MOST_KNOWN_TAKES:
            return
        end = take.end if isinstance(take, store.LabelledTake) else None
        try:
            recording = studio.recording(take.clip_id)
            found = find_clip_range(recording, take.start, end, trigger=language.trigger)
            without = own.find(take.clip_id, found.start, found.end)
            is_new = without and without not in apart
            if not own.leave_one(take.expected, without) or (is_new and len(apart) == MOST_APART):
                continue
            if is_new:
                apart.add(without)
            yield KnownTake(take.expected, recognizer.query(found.poses), without)
        except (OsgError, ProblemError, store.NotFound):
            continue
        count += 1
