"""List responses: serialised once per change, 304 when the caller has the newest."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import lru_cache
from typing import Annotated, Any, TypeVar

from fastapi import Depends, Header, Response
from pydantic import TypeAdapter

from app.store import ClipStore, LanguageStore

NOT_SENT_AGAIN: dict[int | str, dict[str, Any]] = {
    304: {"description": "The list that the caller has is still the newest"}
}
"""OpenAPI ``responses`` of a list."""


Store = TypeVar("Store", ClipStore, LanguageStore)
View = TypeVar("View")
Query = TypeVar("Query", bound=Hashable)


def _tags(
    if_none_match: Annotated[
        str | None, Header(description="The ETag of the answer that the caller has")
    ] = None,
) -> frozenset[str]:
    return frozenset(tag.strip() for tag in (if_none_match or "").split(","))


KnownTags = Annotated[frozenset[str], Depends(_tags)]
"""ETags of the answers that the caller has."""


def list_response(
    read: Callable[[Store, Query], tuple[list[View], dict[str, str]]],
    adapter: TypeAdapter[list[View]],
    kept: int,
) -> Callable[[Store, frozenset[str], Query], Response]:
    """Return a function that answers with the list of a store's entries, or a part of it.

    Every page lists the whole library at its start, maybe a thousand clips that change rarely. So
    the list is read and serialised only after a change, and a browser that has it gets a 304.

    Parameters
    ----------
    read
        Reads the part that a query selects, all for None, and the headers that state its position.
    adapter
        Writes it.
    kept
        Number of serialised parts that are kept until the store changes.

    """

    @lru_cache(kept)
    def written(store: Store, _changes: int, query: Query) -> tuple[bytes, dict[str, str]]:
        views, headers = read(store, query)
        return adapter.dump_json(views), headers

    def answer(store: Store, known: frozenset[str], query: Query) -> Response:
        # Before reading, so that an old list is never sent as new when the store changes meanwhile.
        changes = store.changes
        headers = {"ETag": f'"{changes}"', "Cache-Control": "private, no-cache"}
        if headers["ETag"] in known:
            return Response(status_code=304, headers=headers)
        content, place = written(store, changes, query)
        return Response(content, media_type="application/json", headers=headers | place)

    return answer
