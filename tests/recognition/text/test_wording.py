"""Names and lists as people say them."""

import pytest

from app.recognition.text.wording import humanize, join_words


def test_identifiers_are_said_as_words() -> None:
    assert humanize("wrist_bend") == "wrist bend"


@pytest.mark.parametrize(
    ("words", "sentence"),
    [(["a"], "a"), (["a", "b"], "a and b"), (["a", "b", "c"], "a, b and c")],
)
def test_a_list_ends_with_and(words: list[str], sentence: str) -> None:
    assert join_words(words) == sentence
