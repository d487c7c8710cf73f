"""Only ids of clips become paths, wherever they come from."""

from __future__ import annotations

from datetime import timedelta
from pathlib import Path

import pytest
from sqlalchemy import text

from app.store import ClipStore, Database, NotFound
from app.store.models import now
from tests.store.conftest import add_clip


@pytest.mark.parametrize("clip_id", ["../../victim", "..", "", "/etc", "A" * 32, "0" * 33])
def test_the_files_of_what_is_no_clip_have_no_place(clips: ClipStore, clip_id: str) -> None:
    with pytest.raises(NotFound, match="there is no clip"):
        clips._files.home(clip_id)


@pytest.mark.withstands(row="H32")
@pytest.mark.parametrize("clip_id", ["../victim", "../../victim", "..", "{victim}"])
def test_the_removal_of_a_clip_never_leaves_the_folder(
    sqlite: Database, tmp_path: Path, clip_id: str
) -> None:
    victim = tmp_path / "victim"
    victim.mkdir()
    (victim / "kept").write_text("kept")
    clips = ClipStore(sqlite, tmp_path / "data" / "clips")
    added = add_clip(clips)
    evil = clip_id.format(victim=victim)
    with sqlite.engine.begin() as connection:
        connection.execute(text("DELETE FROM job"))
        changed = "UPDATE clip SET id = :evil, deleted = '2020-01-01 00:00:00'"
        connection.execute(text(changed), {"evil": evil})
    assert clips.purge(now() - timedelta(days=1)) == 1
    assert (victim / "kept").read_text() == "kept"
    assert (tmp_path / "data" / "clips" / added.clip.id / "video").exists()
