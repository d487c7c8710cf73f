"""Texts with ``{slot}`` in them, and ``[ ]`` around what is left out with its slots."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Set

from app.recognition.phrases.phrase import Value
from app.recognition.text.wording import join_words

SlotValue = Value | list[Value]
"""What a slot came to: a list where it may be filled more than once."""

_PLACEHOLDER = re.compile(r"\{([a-z][a-z0-9_]*)\}")
_STRETCH = re.compile(r"\[([^\[\]]*)\]|([^\[\]]+)")


def find_placeholders(text: str) -> Iterator[str]:
    """Give the slots that a text refers to."""
    return (match[1] for match in _PLACEHOLDER.finditer(text))


def find_template_fault(
    template: str, slots: Collection[str], missing: Collection[str]
) -> str | None:
    """Say what is wrong with a spoken text; None: nothing.

    Parameters
    ----------
    template
        The text.
    slots
        The slots there are.
    missing
        Those that may have no value: they must stand in ``[ ]``.

    """
    if _STRETCH.sub("", template):
        return f"the square brackets in {template!r} do not pair up, or stand in each other"
    for optional, plain in _STRETCH.findall(template):
        names = list(find_placeholders(optional or plain))
        if unknown := [name for name in names if name not in slots]:
            return (
                f"{{{unknown[0]}}} is no slot here; there is {', '.join(sorted(slots)) or 'none'}"
            )
        if optional and not names:
            return f"[{optional}] has no slot in it that could be left out: write it without [ ]"
        if absent := [name for name in names if plain and name in missing]:
            return f"{{{absent[0]}}} may be left out: put what is then not said in [ ]"
    return None


def fill_template(text: str, values: Mapping[str, SlotValue | None]) -> str:
    """Put the values in words into a text; one that is missing leaves nothing."""
    return _PLACEHOLDER.sub(lambda match: speak_value(values.get(match[1])), text)


def find_whole_placeholder(text: str) -> str | None:
    """Return the slot that a text is nothing else than a placeholder of."""
    match = _PLACEHOLDER.fullmatch(text)
    return match[1] if match else None


def speak_template(template: str, values: Mapping[str, SlotValue | None], shown: Set[str]) -> str:
    """Put values into a template.

    Parameters
    ----------
    template
        A spoken text.
    values
        Per slot.
    shown
        The slots that a gesture filled: without one of its own, what is in ``[ ]`` is not said.

    """
    return "".join(
        fill_template(optional or plain, values)
        for optional, plain in _STRETCH.findall(template)
        if plain or shown >= set(find_placeholders(optional))
    )


def speak_value(value: SlotValue | None) -> str:
    """Say a value."""
    if value is None:
        return ""
    if isinstance(value, list):
        return join_words([speak_value(each) for each in value])
    return str(value).removesuffix(".0") if isinstance(value, float) else str(value)
