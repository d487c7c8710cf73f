"""Clients of crash rounds: what they change, and what a server has acknowledged of it."""

from __future__ import annotations

import base64
import random
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

import httpx

from app.resources import samples_dir

API: Final = "/api/v1"

MOST_CLIPS = 12
"""Number of clips to keep; further ones are deleted, a change that is checked too."""

UNDONE: Final = 0.1
"""Share of the changes of clips that bring a deleted one back, if there is one."""

TUS: Final = {"Tus-Resumable": "1.0.0"}


@dataclass
class Written:
    """Changes that the server has acknowledged, and the last ones sent without an answer.

    Attributes
    ----------
    languages
        Revision and name by id; None for a deleted language.
    attempts
        Name by id, or None for a deletion, of requests without an answer.
    clips
        By id whether the clip is kept.
    deleting
        Ids of clips whose deletion was sent and not answered.
    parts
        Acknowledged bytes of the resumable uploads that are not complete, by address.
    invitations
        By id the language and the token; the token is None once the invitation is withdrawn.
    takes
        Invitations by the ids of the takes that were sent.
    unaudited
        Ids of acknowledged requests whose entries in the audit log were not looked for yet.
    audited
        Number of those that were found.
    backups
        Number of backups that were restored and compared.
    acknowledged
        Number of changes.
    joined, undone
        Number of uploads of chapters, and of deletions that were undone, among them.
    refused
        Number of uploads that were refused because the process that probed them was killed.
    lost
        Missing or wrong things, in words.
    kills
        Number of rounds by what was killed.
    ends
        Number of the kept clips' jobs, by how they ended.

    """

    languages: dict[str, tuple[int, str] | None] = field(default_factory=dict)
    attempts: dict[str, str | None] = field(default_factory=dict)
    clips: dict[str, bool] = field(default_factory=dict)
    deleting: set[str] = field(default_factory=set)
    parts: dict[str, int] = field(default_factory=dict)
    invitations: dict[str, tuple[str, str | None]] = field(default_factory=dict)
    takes: dict[str, str] = field(default_factory=dict)
    unaudited: set[str] = field(default_factory=set)
    audited: int = 0
    backups: int = 0
    acknowledged: int = 0
    joined: int = 0
    undone: int = 0
    refused: int = 0
    lost: list[str] = field(default_factory=list)
    kills: Counter[str] = field(default_factory=Counter)
    ends: Counter[str] = field(default_factory=Counter)


Client = Callable[[httpx.Client, Written, random.Random], None]


def edit(client: httpx.Client, written: Written, draw: random.Random) -> None:
    """Create, rename or delete a language."""
    # Not a language with an unanswered request: its state is known only after the next start.
    kept = [
        key for key, state in written.languages.items() if state and key not in written.attempts
    ]
    chosen = draw.choice(kept) if kept and draw.random() < 0.8 else None
    name = f"language {draw.randrange(10**9)}"
    if chosen is None:
        made = client.post(f"{API}/languages", json={"name": name}).raise_for_status().json()
        written.languages[made["id"]] = made["revision"], name
    elif len(kept) > 20:
        written.attempts[chosen] = None
        client.delete(f"{API}/languages/{chosen}").raise_for_status()
        written.languages[chosen] = None
        del written.attempts[chosen]
    else:
        written.attempts[chosen] = name
        answer = client.patch(f"{API}/languages/{chosen}", json={"name": name})
        written.languages[chosen] = answer.raise_for_status().json()["revision"], name
        del written.attempts[chosen]
    written.acknowledged += 1


def import_file(client: httpx.Client, written: Written, draw: random.Random) -> None:
    """Import a sample language."""
    file = draw.choice(sorted(samples_dir().glob("*.json")))
    answer = client.post(f"{API}/languages/import", content=file.read_bytes())
    made = answer.raise_for_status().json()
    written.languages[made["id"]] = made["revision"], made["name"]
    written.acknowledged += 1
    time.sleep(0.2)


def upload(client: httpx.Client, written: Written, draw: random.Random, clip: bytes) -> None:
    """Add a clip at once, in two parts or of two chapters; delete one, or undo that."""
    gone = [
        key for key, state in written.clips.items() if not state and key not in written.deleting
    ]
    kept = [key for key, state in written.clips.items() if state and key not in written.deleting]
    if gone and draw.random() < UNDONE:
        chosen = draw.choice(gone)
        written.deleting.add(chosen)
        client.post(f"{API}/clips/{chosen}/restore").raise_for_status()
        written.clips[chosen] = True
        written.deleting.discard(chosen)
        written.undone += 1
    elif len(kept) >= MOST_CLIPS:
        chosen = draw.choice(kept)
        written.deleting.add(chosen)
        client.delete(f"{API}/clips/{chosen}").raise_for_status()
        written.clips[chosen] = False
        written.deleting.discard(chosen)
    elif draw.random() < 0.5:
        answer = client.post(f"{API}/clips", files={"file": ("dive.mkv", clip)})
        written.clips[answer.raise_for_status().json()["id"]] = True
    else:
        chapters = {}
        if draw.random() < 0.5:
            sizes = base64.b64encode(f"{len(clip)},{len(clip)}".encode()).decode()
            chapters = {"Upload-Metadata": f"chapters {sizes}"}
            clip = clip + clip
        announced = TUS | {"Upload-Length": str(len(clip))} | chapters
        place = client.post(f"{API}/uploads", headers=announced).raise_for_status()
        half = len(clip) // 2
        for start, part in ((0, clip[:half]), (half, clip[half:])):
            answer = _send(client, place.headers["location"], start, part)
        written.joined += bool(chapters)
        written.clips[answer.headers["content-location"].rpartition("/")[2]] = True
    written.acknowledged += 1


def go_on(client: httpx.Client, written: Written, draw: random.Random, clip: bytes) -> None:
    """Begin a resumable upload, go on with one, or export the session of a clip."""
    kept = [key for key, state in written.clips.items() if state and key not in written.deleting]
    if kept and draw.random() < 0.1:
        client.get(f"{API}/clips/{draw.choice(kept)}/session.mcap").raise_for_status()
    elif written.parts and draw.random() < 0.7:
        place = draw.choice(list(written.parts))
        answer = client.head(place, headers=TUS).raise_for_status()
        start = int(answer.headers["upload-offset"])
        end = min(len(clip), start + draw.randrange(1, len(clip)))
        answer = _send(client, place, start, clip[start:end])
        written.parts[place] = end
        if "content-location" in answer.headers:
            written.clips[answer.headers["content-location"].rpartition("/")[2]] = True
            del written.parts[place]
    else:
        begun = client.post(f"{API}/uploads", headers=TUS | {"Upload-Length": str(len(clip))})
        written.parts[begun.raise_for_status().headers["location"]] = 0
    written.acknowledged += 1


def invite(client: httpx.Client, written: Written, draw: random.Random, clip: bytes) -> None:
    """Invite others to a language, send a take by a link, or withdraw one."""
    still_open = [(key, *each) for key, each in written.invitations.items() if each[1]]
    chance = draw.random()
    if still_open and chance < 0.7:
        key, _, token = draw.choice(still_open)
        link = {"Authorization": f"Bearer {token}"}
        shown = client.get(f"{API}/invited", headers=link).raise_for_status().json()["gestures"]
        asked = {"label": draw.choice(shown)["label"], "diver": f"{GUEST}{draw.randrange(10**9)}"}
        answer = client.post(
            f"{API}/invited/takes", params=asked, files={"file": ("take.mkv", clip)}, headers=link
        )
        written.takes[answer.raise_for_status().json()["id"]] = key
    elif still_open and chance < 0.8:
        key, language, _ = draw.choice(still_open)
        del written.invitations[key]  # Until it is answered, it may be open or not.
        client.delete(f"{API}/languages/{language}/invitations/{key}").raise_for_status()
        written.invitations[key] = language, None
    else:
        kept = [key for key, state in written.languages.items() if state]
        if not kept:
            time.sleep(0.1)
            return
        language = draw.choice(kept)
        answer = client.post(f"{API}/languages/{language}/invitations", json={"takes": 100})
        made = answer.raise_for_status().json()
        written.invitations[made["id"]] = language, made["link"].rpartition("#")[2]
    written.acknowledged += 1


def _send(client: httpx.Client, place: str, start: int, part: bytes) -> httpx.Response:
    headers = TUS | {"Upload-Offset": str(start), "Content-Type": OFFSETS}
    return client.patch(place, content=part, headers=headers).raise_for_status()


GUEST: Final = "guest "
"""Beginning of the names of invited people, and so of their clips."""

OFFSETS: Final = "application/offset+octet-stream"
