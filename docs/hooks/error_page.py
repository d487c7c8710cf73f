"""Errors: the exceptions of the core, and the codes of the HTTP interface's problem documents."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

from mkdocs.exceptions import PluginError
from tables import cell, table

import app.api
from app.recognition import OsgError, errors

MEANINGS = {
    "already_shown": "this person has shown the gesture already, or eight people have",
    "bad_request": "the request states the length of its body twice",
    "check_cancelled": "the health check was cancelled by another request",
    "client_left": "the client closed the connection before it was answered",
    "clip_deleted": "the clip of this `Idempotency-Key` was deleted",
    "clip_not_ready": "the keypoints of the clip are not extracted yet",
    "disk_full": "the server's disk is full",
    "expected_missing": "an explanation needs the gesture that was meant",
    "field_invalid": "a form field or `Upload-Metadata` key is not valid",
    "foreign_origin": "the request comes from a page of another server",
    "demonstration_needed": "the only demonstration of a gesture cannot be removed",
    "gesture_needed": "a phrase uses the gesture that should be deleted",
    "gesture_unusable": "the take cannot become a gesture, for instance because nothing moves",
    "idempotency_key_reused": "this `Idempotency-Key` came with another file before",
    "idempotency_key_unknown": "only `POST /clips` understands an `Idempotency-Key`",
    "internal": "unexpected error; the server's log has the details",
    "take_not_held": "an invited take was returned, or is looked at still: reload the list",
    "take_unusable": "an invited take cannot be a demonstration, for the reason that is given",
    "too_many_invitations": "a language has as many open invitations as are listed: withdraw one",
    "invitation_closed": "the invitation is withdrawn, over, or its limit is reached (`reason`)",
    "invitation_unknown": "no invitation has this token",
    "is_demonstration": "a take that is a demonstration of its gesture proves nothing as a test",
    "no_pictures": "a clip of keypoints has no pictures to turn",
    "job_not_needed": "the job is done, or the topic is chosen already",
    "label_taken": "another gesture of the language has this label, or one that looks like it",
    "name_taken": "another language has a name that looks like this one",
    "language_invalid": "the language or its file is not valid; `errors` has the JSON pointer",
    "malformed_upload": "the upload is not valid multipart or tus",
    "model_missing": "a pose or hand model is not installed",
    "no_demonstration": "the gesture has no demonstration, only an image",
    "no_gestures": "nobody can be invited to a language without gestures",
    "not_found": "no such clip, language, gesture, job or recognition",
    "queue_full": "too many clips of this client are waiting",
    "range_empty": "the range holds no keypoints",
    "range_not_satisfiable": "the requested byte range lies outside the file",
    "request_invalid": "a parameter or the body is not valid; `errors` lists each fault",
    "revision_conflict": "the language has a newer revision than `If-Match`",
    "server_stopping": "the server is shutting down",
    "service_unavailable": "no further viser workspace can be opened, or recording be read, now",
    "storage_unavailable": "the server's storage cannot be read or written",
    "store_unavailable": "the database, the audit log or the list of tokens cannot be used now",
    "take_ambiguous": "the range holds several takes",
    "test_run_cancelled": "the run of the test set was cancelled by another request",
    "test_set_full": "the test set of the language holds as many takes as it may",
    "token_required": "the token is missing, wrong or withdrawn, or the session has ended",
    "too_many_gestures": "the language and the candidates have more demonstrations than a choice "
    "compares at once",
    "too_large": "the body is above the limit for its kind",
    "quota_exceeded": "this name may keep no more clips, or bytes of them; 413 for a clip that is "
    "larger than the whole quota",
    "role_required": "the role of this token does not allow it",
    "too_many_guesses": "too many wrong tokens came from this address",
    "topic_needed": "the recording has several usable topics; choose one first",
    "topic_unusable": "a topic was given for a file that is no bag",
    "trigger_unusable": "the range holds no pose of the arms that can begin or end takes",
    "tus_version": "the upload uses another version of tus than 1.0.0",
    "unsupported_media_type": "the file is neither a video, a bag nor a known keypoint file",
    "upload_broken_off": "the connection ended before the upload was complete",
    "upload_offset": "the part does not begin where the upload stands",
    "upload_too_slow": "the upload is slower than the limit",
    "video_unreadable": "the video cannot be read",
}


def core_errors() -> str:
    """Return the tree of the core's exceptions as a table."""
    return table(["exception", "raised"], list(_tree(OsgError, 0)))


def problem_codes() -> str:
    """Return the table of the codes that the API's source raises; each needs its meaning here."""
    raised = dict(_raised())
    if unmatched := raised.keys() ^ MEANINGS.keys():
        raise PluginError(f"problem codes without meaning, or no longer used: {sorted(unmatched)}")
    return table(
        ["code", "status", "meaning"],
        [(f"`{code}`", raised[code], cell(MEANINGS[code])) for code in sorted(raised)],
    )


def _raised() -> Iterator[tuple[str, str]]:
    """Yield each code with its status, or with both where a condition chooses one."""
    for path in sorted(Path(app.api.__path__[0]).rglob("*.py")):
        for call in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            match call:
                case ast.Call(
                    func=ast.Name(id="ProblemError"),
                    args=[ast.Constant(value=int(status)), ast.Constant(value=str(code)), *_],
                ):
                    yield code, str(status)
                case ast.Call(
                    func=ast.Name(id="ProblemError"),
                    args=[
                        ast.IfExp(
                            body=ast.Constant(value=int(one)), orelse=ast.Constant(value=int(other))
                        ),
                        ast.Constant(value=str(code)),
                        *_,
                    ],
                ):
                    yield code, f"{one} or {other}"


def _tree(kind: type[Exception], depth: int) -> Iterator[tuple[str, str]]:
    summary = (kind.__doc__ or "").split("\n\n")[0]
    yield f"{'&nbsp;' * 4 * depth}`{kind.__name__}`", cell(summary)
    for child in kind.__subclasses__():
        if child.__module__ == errors.__name__:
            yield from _tree(child, depth + 1)
