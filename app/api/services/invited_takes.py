"""Invited takes: what other people send by an invitation is added to its language, or returned.

A take is judged on the server once its poses are extracted, whether its sender still waits or not.
One that is not read as its gesture, or with doubt, is held: its sender is asked, then its owner.
"""

from __future__ import annotations

import asyncio
import logging
from contextlib import suppress
from datetime import timedelta
from functools import partial
from typing import Final

from starlette.concurrency import run_in_threadpool

from app import store
from app.api.http.problems import ProblemError
from app.api.http.schemas.gestures import DemonstrationDraft
from app.api.jobs.job import compute_in_place
from app.api.services import gesture_edits
from app.api.services.demonstration_sources import faults_of_source
from app.api.services.identities import Identities, Identity
from app.api.services.language_responses import save_revision
from app.api.services.recording_cache import recording_of
from app.api.services.running_studio import Studio
from app.api.services.stored_languages import language_of, recognizer_of
from app.recognition import Gesture, Language, OsgError, Recognition, Recognizer
from app.recognition.explanation.demonstration_faults import FaultKind
from app.recognition.gestures.demonstration import MAX_DEMONSTRATIONS
from app.recognition.recording.clip_range import ClipRange
from app.recognition.recording.salute import FEW_HANDS
from app.recognition.recording.segmentation import find_brackets
from app.recognition.triggers.trigger import Trigger
from app.store.models import now

LOOK_SECONDS: Final = 1.0
"""Seconds between two looks for takes whose poses are found: a person waits for the answer."""

LOST: Final = timedelta(minutes=5)
"""Time after which a take whose clip is not there will have none: storing it takes seconds."""

DOUBT: Final = 0.25
"""Confidence below which a take is read with doubt; at 0.5, 4 to 15 points more of the right takes
would be asked about, see `benchmarks.accuracy.people`."""

FEW_BODIES: Final = 0.2
"""Share of the frames with a body below which nobody is taken to be in a clip: in pictures without
any person the model of the pose finds one now and then."""

MOST_MENDED: Final = 2
"""Ranges that are tried for a take whose first range is not the best one: its stroke, and that
without rest."""

REASONS: Final[dict[FaultKind, str]] = {
    FaultKind.whole_clip: "The gesture was not found. Pause shortly before and after it.",
    FaultKind.contains_salute: "The sign that begins a take is in the middle of it. Show the "
    "gesture once, between two of them.",
    FaultKind.reaches_salute: "The way to the gesture is in it. Pause shortly before and after it.",
    FaultKind.cut_short: "It is cut short. Show all of it.",
    FaultKind.contains_rest: "There is a long rest in it. Show it in one go.",
    FaultKind.other_person: "Somebody else is in the picture. Show it alone.",
    FaultKind.keypoints_jumped: "The arms could not be followed. Show it slower, in better light.",
    FaultKind.keypoints_missing: "An arm is often not seen. Step back until both arms stay in "
    "the picture.",
    FaultKind.no_hand: "Hand not seen. Show it again nearer.",
}
"""What the person who shows is told of a fault: cause, then what to do."""

logger = logging.getLogger(__name__)


class Returned(Exception):
    """Raised when a take is not added; the message is for the person who shows."""


class Doubted(Exception):
    """Raised when a take is not surely its gesture; the message asks the person who shows.

    It tells the label that was read at most, and nothing else of the language.
    """

    def __init__(self, label: str, read: Recognition | None) -> None:
        self.read_as = None if read is None else read.label
        seen = f"This does not look like {label!r}."
        if self.read_as is not None:
            clearly = ", but not clearly" if self.read_as == label else ""
            seen = f"This looks like {self.read_as!r}{clearly}."
        elif read is not None and read.pair is not None and label in read.pair:
            (other,) = {*read.pair} - {label}
            seen = f"This may also be {other!r}."
        super().__init__(f"{seen} Is it {label!r}?")


async def settle_takes(studio: Studio, identities: Identities) -> None:
    """Judge the takes that came in, as long as the server runs."""
    seen: int | None = None
    takes: list[store.InvitedTake] = []
    while True:
        try:
            changes = await run_in_threadpool(lambda: studio.invitations.changes)
            if takes or changes != seen:
                takes = await run_in_threadpool(studio.invitations.waiting)
                for take in takes:
                    look = partial(_look_at, studio, identities, take)
                    if (job := await compute_in_place(studio.turns.edits, look)) is not None:
                        await studio.extractions.cancel(job)
                seen = changes
        except store.StoreError as error:
            logger.warning("invited takes wait for the store: %s", error)
        except Exception:
            # The failure of one take must not end the judging of all others.
            logger.exception("an invited take could not be judged")
        await asyncio.sleep(LOOK_SECONDS)


def _look_at(studio: Studio, identities: Identities, take: store.InvitedTake) -> store.Job | None:
    """Judge a take if its job has ended, and keep the outcome.

    Returns
    -------
    The job that is to be ended, because nothing is added by its invitation any more; else None.

    """
    found = None
    try:
        found = studio.clips.get(take.clip_id)
        ready = store.JobStatus(found.job.status).final
    except store.NotFound:
        # Its clip is being stored, was deleted, or never came because the server ended.
        ready = take.created < now() - LOST
    if not ready and found and _owner_of(studio.invitations, identities, take) is None:
        return found.job
    if not ready or not studio.invitations.claim(take.id):
        return None
    try:
        _judge(studio, identities, take, found)
    except Returned as returned:
        _settle(studio, take, "returned", str(returned), arrived=found is not None)
    except Doubted as doubted:
        studio.invitations.ask(take.id, doubted.read_as, str(doubted))
        studio.broadcast.publish("clips", id=take.clip_id)
    return None


def _owner_of(
    invitations: store.InvitationStore, identities: Identities, take: store.InvitedTake
) -> Identity | None:
    """Return in whose name a take is added; None if its invitation was withdrawn, or they left."""
    invitation = invitations.get(take.invitation_id)
    if invitation.closed == "withdrawn":
        return None
    return identities.of_inviter(invitation.owner, invitation.created)


def _settle(
    studio: Studio,
    take: store.InvitedTake,
    status: str,
    reason: str | None = None,
    *,
    arrived: bool = True,
) -> None:
    """Keep what became of a take, and tell the open pages; a returned one's clip goes."""
    studio.invitations.settle(take.id, status, reason, arrived=arrived)
    if status == "returned":
        with suppress(store.NotFound):
            studio.clips.delete(take.clip_id)
    studio.broadcast.publish("clips", id=take.clip_id)


def answer_question(
    studio: Studio, take: store.InvitedTake, quota: store.Quota, *, confirmed: bool
) -> None:
    """Keep what the person who shows says about a take; nothing happens to one that is not held.

    A take that was read as its gesture is added once it is confirmed. Another one waits for the
    owner. What is not confirmed is returned.
    """
    if not take.held or (confirmed and take.status == "waiting"):
        return
    try:
        if not confirmed:
            raise Returned("Show it again.")
        if take.read_as == take.label:
            add_take(studio, take, quota)
        else:
            read = "no gesture" if take.read_as is None else repr(take.read_as)
            said = f"It is read as {read}. {take.diver} says that it is {take.label!r}."
            _settle(studio, take, "waiting", said)
    except Returned as returned:
        _settle(studio, take, "returned", str(returned))


def remove_take(studio: Studio, take: store.InvitedTake, quota: store.Quota) -> None:
    """Take a take out of its language, and hold it no longer.

    Raises
    ------
    ProblemError
        409 when it is the only demonstration of its gesture.

    """
    language_id = studio.invitations.get(take.invitation_id).language_id

    def without(language: Language) -> Language:
        row = studio.demonstrations.find(language).get(take.label, [])
        for index, source in enumerate(row):
            if source is not None and source.clip_id == take.clip_id:
                return gesture_edits.remove_demonstration_from(language, take.label, index)
        return language

    language = language_of(studio.languages.get(language_id))
    if without(language) is not language:
        words = f"Remove the demonstration of {take.label} by {take.diver}"
        save_revision(studio, quota, language_id, words, without)
        studio.broadcast.publish("languages", id=language_id)
    _settle(studio, take, "removed")


def _judge(
    studio: Studio, identities: Identities, take: store.InvitedTake, found: store.ClipWithJob | None
) -> None:
    """Add a take to its language.

    Raises
    ------
    Returned
        Why it is not added.
    Doubted
        When it has to be asked about.

    """
    if (owner := _owner_of(studio.invitations, identities, take)) is None:
        raise Returned("This invitation was withdrawn.")
    if found is None:
        raise Returned("The clip did not arrive. Show it again.")
    if found.job.status != store.JobStatus.DONE:
        raise Returned(
            f"The clip could not be read: {found.job.error or 'cancelled'}. Record it again."
        )
    quota = store.Quota(owner.name, owner.quota_bytes, owner.quota_clips)
    add_take(studio, take, quota, sure=False)
    language_id = studio.invitations.get(take.invitation_id).language_id
    studio.audit.add(
        store.AuditEntry(
            name=owner.name,
            role=owner.role.value,
            address="invitation",
            method="POST",
            path=f"/api/v1/languages/{language_id}/demonstrations",
            status=201,
            request_id=take.id,
        )
    )


def add_take(
    studio: Studio, take: store.InvitedTake, quota: store.Quota, *, sure: bool = True
) -> None:
    """Add a take to its language, unless it is there already.

    Raises
    ------
    Returned
        Why it is not added.
    Doubted
        When it is not surely read as its gesture, unless somebody is `sure`.

    """
    invitation = studio.invitations.get(take.invitation_id)
    try:
        state = studio.languages.get(invitation.language_id)
        language = language_of(state)
        gesture = gesture_edits.gesture_in(language, take.label)
    except (store.NotFound, ProblemError) as error:
        raise Returned("The language has no such gesture any more.") from error
    known = studio.demonstrations.find(language)[take.label]
    if any(each and each.clip_id == take.clip_id for each in known):
        # Such as by a server that ended before it could say so.
        return _settle(studio, take, "added")
    require_unshown(gesture, take.diver)
    draft = choose_range(studio.clips, take, gesture, language.trigger)
    try:
        shown = gesture_edits.demonstration_at(studio.clips, draft, language.trigger)
        if not sure:
            _require_read(recognizer_of(state), take.label, shown)
        words = f"Add a demonstration of {take.label} by {take.diver}"
        changed = partial(_with_take, draft=draft, shown=shown)
        state = save_revision(studio, quota, invitation.language_id, words, changed)
    except store.QuotaExceeded as error:
        raise Returned("The studio has no room for more. Tell whoever invited you.") from error
    except (OsgError, store.NotFound, ProblemError) as error:
        detail = error.detail if isinstance(error, ProblemError) else error
        raise Returned(f"It cannot be used: {detail}.") from error
    studio.demonstrations.keep(state, take.label, draft, shown, index=-1)
    studio.broadcast.publish("languages", id=invitation.language_id)
    return _settle(studio, take, "added")


def _require_read(recognizer: Recognizer, label: str, shown: ClipRange) -> None:
    """Raise `Doubted` unless a take is surely read as its gesture."""
    read = None
    with suppress(OsgError):
        read = recognizer.recognize(shown.poses, shown.unseen)
    # The confidence of the paper's profile is no probability.
    doubted = read is not None and recognizer.profile != "paper" and read.confidence < DOUBT
    if read is None or read.label != label or doubted:
        raise Doubted(label, read)


def _with_take(language: Language, draft: DemonstrationDraft, shown: ClipRange) -> Language:
    """Return the language with one more demonstration, unless that person or eight have shown it.

    It is made from the newest revision, so that no other take comes in between.
    """
    require_unshown(gesture_edits.gesture_in(language, draft.label), draft.diver)
    return gesture_edits.add_demonstration_to(language, draft, shown)


def require_unshown(gesture: Gesture, diver: str) -> None:
    """Refuse a further take of a person who has shown the gesture, or of a ninth person.

    Raises
    ------
    Returned
        Which of both.

    """
    divers = [each.diver.casefold() for each in gesture.single_demonstrations()]
    if diver.casefold() in divers:
        raise Returned(f"{diver} has shown {gesture.label} already.")
    if len(divers) >= MAX_DEMONSTRATIONS:
        raise Returned(f"{len(divers)} people have shown {gesture.label}, which is enough.")


def choose_range(
    clips: store.ClipStore, take: store.InvitedTake, gesture: Gesture, trigger: Trigger
) -> DemonstrationDraft:
    """Return the take's range without faults.

    Raises
    ------
    Returned
        When there is none.

    """
    draft = DemonstrationDraft(label=take.label, clip_id=take.clip_id, diver=take.diver)
    recording = recording_of(clips, take.clip_id)
    if recording.poses.seen.any(axis=1).mean() < FEW_BODIES:
        raise Returned("Nobody is seen. Stand so that your head and both arms are in the picture.")
    if trigger.kind in ("salute", "pose"):
        closed = [each for each in find_brackets(recording, trigger) if each.closed]
        sign = "salute" if trigger.kind == "salute" else "pose of the arms"
        if len(closed) > 1:
            raise Returned(f"It was shown {len(closed)} times. Show it once in each clip.")
        if not closed:
            hands = sum(map(bool, recording.hands))
            if trigger.kind == "salute" and hands < FEW_HANDS * len(recording.hands):
                raise Returned(REASONS[FaultKind.no_hand])
            raise Returned(f"The {sign} was not seen twice. Hold it longer, before and after.")
        draft = draft.model_copy(update={"start": closed[0].start, "end": closed[0].end})
    first = gesture.single_demonstrations()[0]
    faults = faults_of_source(clips, draft, first, trigger)
    for _ in range(MOST_MENDED):
        if faults and faults[0].remedy == "set_range" and faults[0].start is not None:
            draft = draft.model_copy(update={"start": faults[0].start, "end": faults[0].end})
            faults = faults_of_source(clips, draft, first, trigger)
    if faults:
        raise Returned(REASONS[faults[0].kind])
    return draft
