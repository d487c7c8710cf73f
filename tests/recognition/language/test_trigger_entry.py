"""A language file keeps its trigger, and one without has a salute."""

import json
from dataclasses import replace
from typing import Any

import pytest

from app.recognition import Language, LanguageError
from app.recognition.triggers.trigger import NO_TRIGGER, SALUTE, Trigger
from tests.posed import BY_BELLY, BY_BELLY_AND_HEAD, posed_language


@pytest.mark.parametrize("trigger", [BY_BELLY, BY_BELLY_AND_HEAD, NO_TRIGGER])
def test_a_trigger_is_read_as_it_was_written(trigger: Trigger) -> None:
    language = Language("pool", trigger=trigger)
    text = language.to_json()
    assert Language.from_json(text).trigger == trigger
    assert Language.from_json(text).to_json() == text


def test_a_salute_is_left_out_so_that_older_programs_read_the_file() -> None:
    assert "trigger" not in json.loads(Language("pool").to_json())
    assert Language.from_json(Language("pool").to_json()).trigger == SALUTE


def test_a_trigger_gesture_is_kept_renamed_and_not_removed() -> None:
    trigger = Trigger("gesture", start_label="circle", stop_label="wedge")
    language = replace(posed_language(), trigger=trigger)
    assert Language.from_json(language.to_json()).trigger == trigger
    renamed = language.renamed("wedge", "vee")
    assert renamed.trigger.stop_label == "vee"
    with pytest.raises(LanguageError, match="the trigger needs a gesture 'circle'") as refused:
        language.without("circle")
    assert refused.value.pointer == "/trigger"
    with pytest.raises(LanguageError, match="needs a gesture 'line'"):
        replace(language, trigger=Trigger("gesture", start_label="line"))


def damaged(**trigger: Any) -> str:
    document = json.loads(replace(Language("pool"), trigger=BY_BELLY_AND_HEAD).to_json())
    document["trigger"] |= trigger
    del document["sha256"]
    return json.dumps(document)


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"kind": "wave"}, "/trigger/kind"),
        ({"kind": "none"}, "/trigger"),
        ({"start": None}, "/trigger"),
        ({"start": {"left_wrist": [0, 0]}}, "/trigger/start/left_elbow"),
        ({"hold": 1}, "/trigger/hold"),
    ],
)
def test_a_trigger_that_is_none_is_refused_with_its_place(
    change: dict[str, Any], pointer: str
) -> None:
    with pytest.raises(LanguageError) as refused:
        Language.from_json(damaged(**change))
    assert refused.value.pointer == pointer
