"""Names and lists as people say them."""

import pytest

from app.recognition.text.wording import all_readable, listed, readable


def test_identifiers_are_said_as_words() -> None:
    assert readable("wrist_bend") == "wrist bend"
    assert all_readable(["hu", "left_foot_index"]) == ["hu", "left foot index"]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [(["a"], "a"), (["a", "b"], "a and b"), (["a", "b", "c"], "a, b and c")],
)
def test_a_list_ends_with_and(words: list[str], sentence: str) -> None:
    assert listed(words) == sentence
