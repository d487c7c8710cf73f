"""Server health: reported at the root and under the API."""

import httpx

from app import __version__


def test_health_tells_version_and_models(client: httpx.Client) -> None:
    health = client.get("/healthz").json()
    assert health == client.get("/api/v1/healthz").json()
    assert health["version"] == __version__
    assert set(health["models"].values()) <= {"ok", "missing", "damaged"}
    assert "pose_landmark_full" in health["models"]
