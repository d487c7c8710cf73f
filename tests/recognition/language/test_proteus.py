"""The `.ldf` file is read by the published reader's own steps, and says what the gestures are."""

from dataclasses import replace
from xml.etree import ElementTree

import pytest

from app.recognition import Gesture, Language
from app.recognition.language.export_format import to_proteus
from app.recognition.phrases.phrase import SlotType
from tests.recognition.grammars import MISSIONS
from tests.recognition.strategies import circle, recording


@pytest.fixture(scope="module")
def language() -> Language:
    shown = Gesture.from_demonstration("circle", recording(circle), description="a <round> one")
    labels = dict.fromkeys(use.label for use in MISSIONS.uses())
    gestures = [replace(shown, label=label) for label in labels]
    return Language("pool & sea", gestures, author="Ada", grammar=MISSIONS)


def symbols_of(language: Language, side: str = "input") -> dict[str, dict[str, str]]:
    root = ElementTree.fromstring(to_proteus(language).encode())
    found = root.findall(f"{side}/symbols/symbol")
    return {symbol.attrib["name"]: dict(symbol.attrib) for symbol in found}


def test_the_published_reader_finds_what_it_takes_by_place(language: Language) -> None:
    """The steps of ``Language.parse_from_xml`` and ``Symbol.parse_from_xml`` there."""
    root = ElementTree.fromstring(to_proteus(language, robot="LoCO-AUV").encode())
    known = {"meta", "input", "output", "state", "context", "actions"}
    assert [child.tag for child in root if child.tag not in known] == []
    meta = root[0]
    assert [child.tag for child in meta] == ["name", "robot", "description", "directory"]
    assert [child.text for child in meta][:2] == ["pool & sea", "LoCO-AUV"]
    assert all(child.text for child in meta)
    for side in ("input", "output"):
        (part,) = root.findall(side)
        assert [child.tag for child in part] == ["symbols", "vectors", "actions"]
    for symbol in root.findall("input/symbols/symbol"):
        assert set(symbol.attrib) == {"name", "id", "call_type", "description", "tags"}
        assert symbol.attrib["tags"].split(",")
    assert symbols_of(language, "output") == {}


def test_gestures_are_called_by_what_they_give_the_robot(language: Language) -> None:
    symbols = symbols_of(language)
    calls = {name: symbol["call_type"] for name, symbol in symbols.items()}
    assert (calls["photo"], calls["three"], calls["left"]) == ("trigger", "quantity", "directional")
    assert symbols["start"]["tags"] == "conversational,control"
    assert symbols["three"]["tags"] == "information"
    assert symbols["photo"]["description"] == "a <round> one"


def test_a_text_that_is_no_direction_is_a_trigger(language: Language) -> None:
    what = SlotType("animal", "text", {"left": "fish"})
    grammar = replace(MISSIONS, slot_types=(*MISSIONS.slot_types[::2], what), phrases=())
    assert symbols_of(replace(language, grammar=grammar))["left"]["call_type"] == "trigger"


def test_every_id_is_a_parameter_name_of_its_own() -> None:
    shown = Gesture.from_demonstration("circle", recording(circle))
    labels = ("Go Up!", "go-up", "3", "sígueme 🤿", "🤿")
    language = Language("pool", [replace(shown, label=label) for label in labels])
    ids = [symbol["id"] for symbol in symbols_of(language).values()]
    assert ids == ["go_up", "go_up_2", "gesture_3", "sigueme", "gesture"]
