"""Text from outside is read as JSON or refused, cheaply, with a pointer to every fault."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.text.strict_json import (
    MAX_DEPTH,
    MAX_FAULTS,
    MAX_SAFE_INTEGER,
    StrictJSONError,
    build_pointer,
    canonical_json,
    read_json,
)

KB = 1000

json_values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-MAX_SAFE_INTEGER, MAX_SAFE_INTEGER)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(st.characters(exclude_categories=["Cs"])),
    lambda inner: (
        st.lists(inner) | st.dictionaries(st.text(st.characters(exclude_categories=["Cs"])), inner)
    ),
    max_leaves=20,
)


def faults_of(text: str | bytes, max_bytes: int = 10 * KB) -> list[tuple[str, str]]:
    content = text if isinstance(text, bytes) else text.encode()
    with pytest.raises(StrictJSONError) as refusal:
        read_json(content, max_bytes)
    return [(fault.pointer, fault.message) for fault in refusal.value.faults]


@given(json_values)
def test_plain_json_is_read_as_it_is(value: object) -> None:
    assert read_json(json.dumps(value).encode(), 100 * KB) == value


@pytest.mark.parametrize(
    ("text", "pointer", "message"),
    [
        ("", "", "not JSON: Expecting value at line 1, column 1"),
        ("{\n'a': 1}", "", "not JSON: Expecting property name enclosed in double quotes"),
        ("[1, 2", "", "not JSON"),
        (b"\xff\xfe", "", "UTF-16, save it as UTF-8"),
        ('{"a": {"b": 1, "b": 2}}', "/a/b", "this key occurs twice"),
        ('{"a": [0, NaN]}', "/a/1", "not a number that JSON or a double can hold"),
        ('{"a": -Infinity}', "/a", "not a number"),
        ('{"a": 1e400}', "/a", "not a number"),
        ('{"a": 9007199254740992}', "/a", "integer 9007199254740992 is beyond 9007199254740991"),
        ('{"a": ' + "9" * 5000 + "}", "/a", "not a number"),
        (r'{"a": "\ud800"}', "/a", "text with half a surrogate pair"),
        (r'{"\udc00": 1}', "", "a key with half a surrogate pair"),
        ('{"a/b": {"~": NaN}}', "/a~1b/~0", "not a number"),
    ],
)
@pytest.mark.withstands(row="H13")
def test_what_other_readers_would_take_differently_is_refused(
    text: str | bytes, pointer: str, message: str
) -> None:
    [(found_pointer, found_message), *_] = faults_of(text)
    assert found_pointer == pointer
    assert found_message.startswith(message)


def test_every_fault_is_named() -> None:
    pointers = [pointer for pointer, _ in faults_of('{"a": NaN, "b": [1, Infinity], "b": [1e999]}')]
    assert pointers == ["/b", "/a", "/b/0"]


def test_no_more_faults_are_listed_than_a_person_reads() -> None:
    assert len(faults_of(json.dumps([float("nan")] * 1000))) == MAX_FAULTS


def test_a_file_beyond_the_size_limit_is_not_parsed() -> None:
    [(pointer, message)] = faults_of(b"[" * 20 * KB, max_bytes=10 * KB)
    assert pointer == ""
    assert message.startswith("the file is too large")


def test_the_deepest_nesting_allowed_is_read() -> None:
    text = "[" * MAX_DEPTH + "]" * MAX_DEPTH
    assert canonical_json(read_json(text.encode(), KB)) == text


@pytest.mark.parametrize("text", ["[" * 10_000 + "]" * 10_000, '{"a":' * 10_000, "[" * 33])
@pytest.mark.withstands(row="H13")
def test_deeper_nesting_is_refused_before_parsing(text: str) -> None:
    [(_, message)] = faults_of(text, max_bytes=100 * KB)
    assert message.startswith("nested ")


def test_brackets_in_text_are_not_nesting() -> None:
    text = json.dumps({"label": '[[{"' * 100, "note": "\\" * 5 + "[" * 100})
    assert read_json(text.encode(), 10 * KB) == json.loads(text)


def test_an_unterminated_text_full_of_quotes_does_not_take_forever() -> None:
    content = (
        b'"' + b'\\"' * 2_000_000
    )  # work that grows with the square would outlast any test run
    [(_, message)] = faults_of(content, max_bytes=10**7)
    assert message.startswith("not JSON: Unterminated string")


def test_pointers_escape_what_pointers_are_made_of() -> None:
    assert build_pointer("gestures", 0, "a/b~c") == "/gestures/0/a~1b~0c"
    assert build_pointer() == ""


@pytest.mark.parametrize(
    ("number", "text"),
    # The samples of RFC 8785, appendix B, that are JSON numbers, and ECMAScript's boundaries.
    [
        (0.0, "0"),
        (-0.0, "0"),
        (5e-324, "5e-324"),
        (1.7976931348623157e308, "1.7976931348623157e+308"),
        (9007199254740992.0, "9007199254740992"),
        (295147905179352830000.0, "295147905179352830000"),
        (9.999999999999997e22, "9.999999999999997e+22"),
        (1e23, "1e+23"),
        (1e21, "1e+21"),
        (1e20, "100000000000000000000"),
        (333333333.3333332, "333333333.3333332"),
        (-0.0000033333333333333333, "-0.0000033333333333333333"),
        (1e-6, "0.000001"),
        (1e-7, "1e-7"),
        (1.5, "1.5"),
        (-12.25, "-12.25"),
        (1200.0, "1200"),
        (1424953923781206.2, "1424953923781206.2"),
    ],
)
def test_numbers_are_written_as_ecmascript_writes_them(number: float, text: str) -> None:
    assert canonical_json(number) == text


def test_keys_are_sorted_by_utf_16_code_units_and_text_is_escaped_least() -> None:
    # The sample of RFC 8785, section 3.2.3.
    value = {
        "\u20ac": "Euro Sign",
        "\r": "Carriage Return",
        "\ufb33": "Hebrew Letter Dalet With Dagesh",
        "1": "One",
        "\U0001f600": "Emoji: Grinning Face",
        "\x80": "Control",
        "\u00f6": "Latin Small Letter O With Diaeresis",
    }
    assert list(json.loads(canonical_json(value))) == [
        "\r",
        "1",
        "\x80",
        "\u00f6",
        "\u20ac",
        "\U0001f600",
        "\ufb33",
    ]
    assert canonical_json({"b": [True, None, "\u20ac$\n\x1f"], "a": 1}) == (
        '{"a":1,"b":[true,null,"\u20ac$\\n\\u001f"]}'
    )


@given(json_values)
def test_the_canonical_form_means_the_same_and_is_its_own(value: object) -> None:
    text = canonical_json(value)
    # Both as doubles: a large float is written without an exponent, like an integer.
    assert json.loads(text, parse_int=float) == json.loads(json.dumps(value), parse_int=float)
    # As ECMAScript reads it: what is beyond the safe integers is a double.
    again = json.loads(text, parse_int=lambda digits: _read_number(int(digits)))
    assert canonical_json(again) == text


def _read_number(integer: int) -> int | float:
    return integer if abs(integer) <= MAX_SAFE_INTEGER else float(integer)


@pytest.mark.timeout(60)  # counting each key among all others takes minutes
@pytest.mark.withstands(row="H13")
def test_very_many_keys_that_occur_twice_are_refused_at_once() -> None:
    keys = [f'"{index}": 0' for index in range(100_000)]
    document = ("{" + ", ".join(keys + keys) + "}").encode()
    with pytest.raises(StrictJSONError, match="occurs twice"):
        read_json(document, len(document))
