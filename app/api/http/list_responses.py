"""List responses: serialised once per change, 304 when the caller has the newest."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import lru_cache
from typing import Annotated, Any, Protocol, TypeVar

from fastapi import Depends, Header, Response
from pydantic import TypeAdapter

NOT_SENT_AGAIN: dict[int | str, dict[str, Any]] = {
    304: {"description": "The list that the caller has is still the newest"}
}
"""OpenAPI ``responses`` of a list."""


class Counted(Hashable, Protocol):
    """A store that counts its changes."""

    @property
    def changes(self) -> int:
        """Grows with every change."""


Store = TypeVar("Store", bound=Counted)
View = TypeVar("View")
Query = TypeVar("Query", bound=Hashable)


def _tags(
    if_none_match: Annotated[
        str | None, Header(description="The ETag of the list that the caller has")
    ] = None,
) -> frozenset[str]:
    return frozenset(tag.strip() for tag in (if_none_match or "").split(","))


KnownTags = Annotated[frozenset[str], Depends(_tags)]
"""The ETags of what the caller has."""


def list_response(
    views: Callable[[Store], list[View]], adapter: TypeAdapter[list[View]]
) -> Callable[[Store, frozenset[str]], Response]:
    """Return a function that answers with the list of what is in a store.

    A library of a thousand clips is listed by every page at every start, and changes rarely: its
    list is read and written after a change only, and a browser that has it gets a 304.

    Parameters
    ----------
    views
        Reads the list.
    adapter
        Writes it.

    """

    def read(store: Store, _query: None) -> tuple[list[View], dict[str, str]]:
        return views(store), {}

    answer_page = page_response(read, adapter, kept=1)

    def answer(store: Store, known: frozenset[str]) -> Response:
        return answer_page(store, known, None)

    return answer


def page_response(
    read: Callable[[Store, Query], tuple[list[View], dict[str, str]]],
    adapter: TypeAdapter[list[View]],
    kept: int,
) -> Callable[[Store, frozenset[str], Query], Response]:
    """Return a function that answers with a part of the list of what is in a store.

    Parameters
    ----------
    read
        Reads the part that a query names, and the headers that say where it stands.
    adapter
        Writes it.
    kept
        Parts that are kept written, until the store changes.

    """

    @lru_cache(kept)
    def written(store: Store, _changes: int, query: Query) -> tuple[bytes, dict[str, str]]:
        views, headers = read(store, query)
        return adapter.dump_json(views), headers

    def answer(store: Store, known: frozenset[str], query: Query) -> Response:
        # Before reading: what changes meanwhile makes this list old, never a new one taken for old.
        changes = store.changes
        headers = {"ETag": f'"{changes}"', "Cache-Control": "private, no-cache"}
        if headers["ETag"] in known:
            return Response(status_code=304, headers=headers)
        content, place = written(store, changes, query)
        return Response(content, media_type="application/json", headers=headers | place)

    return answer
