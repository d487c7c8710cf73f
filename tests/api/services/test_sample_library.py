"""Samples: added once, at the first start, and not again after deletion."""

from pathlib import Path

import pytest

from app.recognition import Gesture, Language
from app.settings import Settings
from tests.api.recordings import recording_of
from tests.api.running import assert_problem, client_of, running, until
from tests.recognition.damaged_clips import write_clip

LANGUAGES = "/api/v1/languages"


@pytest.fixture
def samples(settings: Settings) -> Path:
    """Return a samples' folder with a language, a broken one and a clip."""
    folder = settings.samples_dir
    (folder / "clips").mkdir(parents=True)
    gesture = Gesture.from_demonstration("circle", recording_of("circle").poses)
    Language("Table 1", [gesture]).save(folder / "table-1.json")
    (folder / "broken.json").write_text("{")
    write_clip(folder / "clips" / "circle_a.mp4")
    return folder


def test_samples_are_brought_once_and_later_ones_are_added(
    settings: Settings, samples: Path
) -> None:
    with running(settings) as server, client_of(server.address) as client:
        (language,) = client.get(LANGUAGES).json()
        client.delete(f"{LANGUAGES}/{language['id']}")
    Language("Table 2").save(samples / "table-2.json")
    with running(settings) as server, client_of(server.address) as client:
        assert [language["name"] for language in client.get(LANGUAGES).json()] == ["Table 2"]


@pytest.mark.slow
@pytest.mark.usefixtures("samples")
def test_a_sample_clip_is_added_like_an_upload(settings: Settings) -> None:
    with running(settings) as server, client_of(server.address) as client:
        (sample,) = client.get("/api/v1/samples").json()
        assert sample["name"] == "circle_a.mp4"
        accepted = client.post("/api/v1/samples", json={"name": sample["name"]})
        assert accepted.status_code == 202
        clip = client.get(f"/api/v1/clips/{accepted.json()['id']}").json()
        assert (clip["name"], clip["size"]) == (sample["name"], sample["size"])
        for name in ("../../secret", "missing.mp4"):
            refused = client.post("/api/v1/samples", json={"name": name})
            assert_problem(refused, 404, "not_found")


@pytest.mark.slow
def test_a_sample_whose_recording_comes_with_it_needs_no_models(
    settings: Settings, samples: Path
) -> None:
    write_clip(samples / "clips" / "other.mp4", frames=5)
    # A diver whom no model could find in these pictures.
    recording_of("circle").save(samples / "clips" / "circle_a.npz")
    with running(settings) as server, client_of(server.address) as client:
        place = "/api/v1/clips"
        chosen = client.post("/api/v1/samples", json={"name": "circle_a.mp4"}).json()["id"]
        until(lambda: client.get(f"{place}/{chosen}").json()["status"] == "done")
        assert len(client.get(f"{place}/{chosen}/takes").json()) == 1
        for picture in ("poster", "filmstrip"):
            assert client.get(f"{place}/{chosen}/{picture}").status_code == 200
        # The same file as an upload is the same clip; another one is not.
        content = (samples / "clips" / "circle_a.mp4").read_bytes()
        same = client.post(place, files={"file": ("mine.mp4", content)}).json()["id"]
        until(lambda: client.get(f"{place}/{same}").json()["status"] == "done")
        assert len(client.get(f"{place}/{same}/takes").json()) == 1
        assert server.studio.samples.find_recording(samples / "clips" / "other.mp4") is None


@pytest.mark.usefixtures("samples")
def test_a_deleted_sample_language_can_be_added_again(settings: Settings) -> None:
    with running(settings) as server, client_of(server.address) as client:
        (language,) = client.get(LANGUAGES).json()
        client.delete(f"{LANGUAGES}/{language['id']}")
        (sample,) = client.get("/api/v1/samples/languages").json()
        assert sample == {"name": "table-1", "title": "Table 1", "labels": ["circle"]}
        added = client.post("/api/v1/samples/languages", json={"name": "table-1"})
        assert added.status_code == 201
        (listed,) = client.get(LANGUAGES).json()
        assert (listed["id"], listed["sample"]) == (added.json()["id"], True)
        refused = client.post("/api/v1/samples/languages", json={"name": "broken"})
        assert_problem(refused, 404, "not_found")
