"""What tests of languages over HTTP share."""

import httpx

LANGUAGES = "/api/v1/languages"


def add_gesture(
    client: httpx.Client, language_id: str, clip_id: str, label: str = "circle"
) -> httpx.Response:
    return client.post(
        f"{LANGUAGES}/{language_id}/gestures", json={"label": label, "clip_id": clip_id}
    )
