"""A grammar in the language file: kept to the byte, refused with a pointer, renamed as it is."""

import json
from collections.abc import Callable
from dataclasses import replace
from hashlib import sha256
from typing import Any

import jsonschema
import numpy as np
import pytest

from app.recognition import Gesture, Language, LanguageError
from app.recognition.language.file import seal
from app.recognition.phrases.grammar import DEFAULT_TIMEOUT, Grammar
from app.recognition.phrases.parser import PhraseParser
from app.recognition.phrases.phrase import OneOf
from tests.published_schemas import LANGUAGE_FILE
from tests.recognition.grammars import MISSIONS
from tests.recognition.language.test_language import GOLDEN
from tests.recognition.strategies import circle, recording

Entry = dict[str, Any]
LABELS = tuple(dict.fromkeys(use.label for use in MISSIONS.uses()))


@pytest.fixture(scope="module")
def language() -> Language:
    shown = Gesture.from_demonstration("circle", recording(circle))
    gestures = [
        Gesture(label=label, salient=(), image=np.zeros_like(shown.image))
        for label in (*LABELS, "spare")
    ]
    return Language("pool", gestures, grammar=MISSIONS)


def test_a_grammar_goes_through_the_file_as_it_was(language: Language) -> None:
    text = language.to_json()
    again = Language.from_json(text)
    assert again.grammar == MISSIONS
    assert again.to_json() == text
    jsonschema.Draft202012Validator(LANGUAGE_FILE.content).validate(json.loads(text))


def test_a_phrase_takes_one_line_so_that_revisions_can_be_compared(language: Language) -> None:
    lines = language.to_json().splitlines()
    assert sum(line.startswith('{"name":"photo"') for line in lines) == 1


def test_a_file_without_a_grammar_is_the_same_to_the_byte() -> None:
    content = GOLDEN.read_bytes()
    assert b'"grammar"' not in content
    again = Language.from_json(content)
    assert again.grammar is None
    assert sha256(again.to_json().encode()).hexdigest() == sha256(content).hexdigest()


def test_what_has_its_usual_value_is_left_out_of_the_file() -> None:
    plain = json.loads(Language("pool", grammar=Grammar()).to_json())["grammar"]
    assert plain == {"timeout": DEFAULT_TIMEOUT, "phrases": []}


def first(grammar: Entry) -> Entry:
    phrase: Entry = grammar["phrases"][0]
    return phrase


def part(number: int, **changes: object) -> Callable[[Entry], object]:
    return lambda grammar: first(grammar)["parts"][number].update(changes)


def phrase(**changes: object) -> Callable[[Entry], object]:
    return lambda grammar: first(grammar).update(changes)


@pytest.mark.parametrize(
    ("change", "pointer", "complaint"),
    [
        (
            part(0, gestures=["photo", "wave"]),
            "/phrases/0/parts/0/gestures/1",
            "needs a gesture 'wave'",
        ),
        (part(0, gestures=[]), "/phrases/0/parts/0/gestures", "at least 1 item"),
        (part(0, gestures=["photo", "photo"]), "/phrases/0/parts/0/gestures", "each once"),
        (part(0, gestures=["cancel"]), "/phrases/0/parts/0/gestures/0", "is the cancel gesture"),
        (part(0, most=0), "/phrases/0/parts/0/most", "greater than or equal to 1"),
        (part(0, most=11), "/phrases/0/parts/0/most", "less than or equal to 10"),
        (part(0, least=2), "/phrases/0/parts/0/most", "0 <= least <= most"),
        (part(0, least=0), "/phrases/0/parts", "without any gesture"),
        (part(0, colour="red"), "/phrases/0/parts/0/colour", "Extra inputs"),
        (part(1, slot="Times"), "/phrases/0/parts/1/slot", "match pattern"),
        (
            part(1, type="colour"),
            "/phrases/0/parts/1/type",
            "no slot type 'colour'; there is number",
        ),
        (part(1, default="one"), "/phrases/0/parts/1/default", "reads number, got 'one'"),
        (part(1, slot="depth"), "/phrases/0/parts/2/parts/1/slot", "a second slot 'depth'"),
        (part(2, parts=[]), "/phrases/0/parts/2/parts", "at least 1 item"),
        (part(2, most=2), "/phrases/0/parts/2/parts/1/most", "may both be repeated"),
        (
            part(2, parts=[{"gestures": ["down"], "least": 0}]),
            "/phrases/0/parts/2/parts",
            "not optional",
        ),
        (part(2, parts=[{"parts": []}]), "/phrases/0/parts/2/parts/0", "a group no groups"),
        (phrase(parts=[{}]), "/phrases/0/parts/0", 'the key "gestures", "slot" or "parts"'),
        (phrase(parts=[]), "/phrases/0/parts", "at least 1 item"),
        (phrase(parts=[{"gestures": ["photo"]}] * 41), "/phrases/0/parts", "may take 41 gestures"),
        (phrase(name="go"), "/phrases/1/name", "'go' occurs twice"),
        (phrase(name=" "), "/phrases/0/name", "printable"),
        (phrase(command="{speed}"), "/phrases/0/command", "{speed} is no slot of 'photo'"),
        (phrase(command={"a": [{"b": "{speed}"}]}), "/phrases/0/command", "{speed} is no slot"),
        (phrase(command={"text": "x" * 5000}), "/phrases/0/command", "too large"),
        (phrase(says="photo {speed}"), "/phrases/0/says", "{speed} is no slot here"),
        (
            phrase(says="photo at {depth}"),
            "/phrases/0/says",
            "put the text that depends",
        ),
        (phrase(says="photo [now]"), "/phrases/0/says", "no slot in it"),
        (phrase(says="photo [[{depth}]]"), "/phrases/0/says", "do not pair up"),
        (lambda grammar: grammar.update(start="wave"), "/start", "the start gesture needs"),
        (lambda grammar: grammar.update(cancel="end"), "/end", "is the cancel gesture"),
        (lambda grammar: grammar.update(timeout=0), "/timeout", "greater than 0"),
        (lambda grammar: grammar.update(timeout=601), "/timeout", "at most 600 seconds"),
        (lambda grammar: grammar.update(most_phrases=9), "/most_phrases", "must be 1 to 8"),
        (lambda grammar: grammar.pop("end"), "/most_phrases", "needs an end gesture"),
        (
            lambda grammar: grammar["slot_types"][0]["values"][1].update(gesture="two"),
            "/slot_types/0/values/1/gesture",
            "a second value of 'two'",
        ),
        (
            lambda grammar: grammar["slot_types"][0]["values"][1].update(value="three"),
            "/slot_types/0/values/1/value",
            "must be a number, got 'three'",
        ),
        (
            lambda grammar: grammar["slot_types"][2]["values"][1].update(value=10),
            "/slot_types/2/values/1/value",
            "must be a digit",
        ),
        (
            lambda grammar: grammar["slot_types"][0]["values"][1].update(value=True),
            "/slot_types/0/values/1/value",
            "valid",
        ),
        (
            lambda grammar: grammar["slot_types"].append(grammar["slot_types"][0]),
            "/slot_types/3/name",
            "'number' occurs twice",
        ),
    ],
)
def test_what_contradicts_itself_is_refused_with_a_pointer(
    language: Language, change: Callable[[Entry], object], pointer: str, complaint: str
) -> None:
    content = json.loads(language.to_json())
    change(content["grammar"])
    content["sha256"] = seal(content)
    with pytest.raises(LanguageError, match=complaint) as refusal:
        Language.from_json(json.dumps(content))
    assert refusal.value.pointer == "/grammar" + pointer
    assert "\n" not in str(refusal.value)


def test_a_renamed_gesture_is_renamed_in_every_phrase(language: Language) -> None:
    grammar = language.renamed("three", "trident").renamed("start", "hello").grammar
    assert grammar is not None
    used = {use.label for use in grammar.uses()}
    assert {"trident", "hello"} <= used
    assert not {"three", "start"} & used
    parser = PhraseParser(grammar)
    for label in ("hello", "photo", "trident"):
        parser.feed(label, 0, 0)
    (event,) = parser.feed("end", 0, 0)
    assert event.text == "mission: photo, 3 times"


def test_a_gesture_that_a_phrase_needs_is_not_taken_out(language: Language) -> None:
    with pytest.raises(LanguageError, match="needed by the phrase 'photo': change the phrases"):
        language.without("down")
    with pytest.raises(LanguageError, match=r"slot type 'number', .* and the phrase 'photo'"):
        language.without("three")
    with pytest.raises(LanguageError, match="the cancel gesture"):
        language.without("cancel")
    assert "spare" not in language.without("spare").labels


def test_a_grammar_too_large_to_be_checked_is_refused() -> None:
    photo = replace(
        MISSIONS.phrases[1], parts=(OneOf(("go",), most=10),) * 4, command=None, says=""
    )
    many = tuple(replace(photo, name=f"photo {number}") for number in range(26))
    with pytest.raises(LanguageError, match="1040 gestures in all, the limit is 1000"):
        replace(MISSIONS, phrases=many)
