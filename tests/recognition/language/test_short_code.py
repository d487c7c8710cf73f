"""Short code: the same for a language and its file, another after any change."""

import json
from dataclasses import replace

from app.recognition import Language
from app.recognition.language.short_code import short_code
from tests.conftest import ROOT

FILE = ROOT / "languages" / "osg-table-1.json"


def test_the_code_is_the_beginning_of_the_files_checksum() -> None:
    sha256 = json.loads(FILE.read_text("utf-8"))["sha256"]
    code = short_code(sha256)
    assert len(code) == 9
    assert code.replace("-", "").lower() == sha256[:8]


def test_another_revision_has_another_code() -> None:
    language = Language.load(FILE)
    texts = (language.to_json(), replace(language, revision=language.revision + 1).to_json())
    codes = {short_code(json.loads(text)["sha256"]) for text in texts}
    assert len(codes) == 2
