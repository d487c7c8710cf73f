"""Helpers for tests of languages over HTTP."""

from dataclasses import replace

import httpx

from app.recognition import Gesture, Language, takes_in
from tests.api.recordings import recording_of
from tests.robot.languages import ambiguous

LANGUAGES = "/api/v1/languages"


def add_gesture(
    client: httpx.Client, language_id: str, clip_id: str, label: str = "circle"
) -> httpx.Response:
    return client.post(
        f"{LANGUAGES}/{language_id}/gestures", json={"label": label, "clip_id": clip_id}
    )


def add_ambiguous_language(client: httpx.Client) -> str:
    """Add a language in which a circle lies between two gestures, and return its address."""
    content = ambiguous().recognizer.language.to_json()
    return f"{LANGUAGES}/{client.post(f'{LANGUAGES}/import', content=content).json()['id']}"


def listed(client: httpx.Client) -> dict[str, dict[str, object]]:
    """Return the languages of the list by their ids."""
    return {str(each["id"]): each for each in client.get(LANGUAGES).json()}


def many_gestures(count: int) -> str:
    """Return a language file of so many gestures, alike but for their labels."""
    gesture = Gesture.from_demonstration("circle", takes_in(recording_of("circle"))[0].poses)
    gestures = [replace(gesture, label=f"circle {number}") for number in range(count)]
    return Language("many", gestures).to_json()
