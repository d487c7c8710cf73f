"""Settings of a language over HTTP: what is default, what is changed, and the weights."""

import httpx
import pytest

from tests.api.languages import LANGUAGES, add_gesture


def test_settings_show_defaults_changes_and_weights(
    client: httpx.Client, language_id: str, circle_clip: str, line_clip: str
) -> None:
    place = f"{LANGUAGES}/{language_id}"
    empty = client.get(f"{place}/settings").json()
    assert (empty["profile"], empty["default_profile"], empty["weights"]) == ("full", "full", {})
    add_gesture(client, language_id, circle_clip, "circle")
    add_gesture(client, language_id, line_clip, "line")
    full = client.get(f"{place}/settings").json()
    (voters,) = (each["voters"] for each in full["profiles"] if each["name"] == "full")
    assert {*full["weights"]} == {*voters}
    assert sum(full["weights"].values()) == pytest.approx(1.0)
    tuning = {"weights": {"hu": 3.0}}
    client.patch(place, json={"profile": "paper", "tuning": tuning}).raise_for_status()
    paper = client.get(f"{place}/settings").json()
    assert (paper["profile"], paper["tuning"]["weights"]) == ("paper", {"hu": 3.0})
    assert paper["weights"]["hu"] == pytest.approx(3 / 9)
