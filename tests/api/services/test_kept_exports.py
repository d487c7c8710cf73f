"""Exports that wait to be fetched: each can be fetched once, and their number is limited."""

from __future__ import annotations

import asyncio
from pathlib import Path

from app.api.services.kept_exports import MOST_KEPT, KeptExports


def test_the_oldest_goes_when_there_are_too_many_and_all_at_the_end(tmp_path: Path) -> None:
    async def keep_too_many() -> None:
        kept = KeptExports()
        paths = [tmp_path / f"{number}.part" for number in range(MOST_KEPT + 2)]
        for path in paths:
            path.touch()
            kept.keep("clip", path.stem, path)
        assert [path.exists() for path in paths] == [False, False, *[True] * MOST_KEPT]
        assert kept.take("clip", "0") is None
        assert kept.take("another clip", paths[-1].stem) is None
        assert kept.take("clip", paths[-1].stem) == paths[-1]
        assert kept.take("clip", paths[-1].stem) is None
        kept.clear()
        # A fetched export belongs to its caller.
        assert [*tmp_path.iterdir()] == [paths[-1]]

    asyncio.run(keep_too_many())
