"""Upload of language and vehicle table: own page only, validated, shown, and then replaced."""

from __future__ import annotations

import http.client
import json
from collections.abc import Iterator, Mapping
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from app.cli.robots.channels import describe_event
from app.robot import ActiveLanguage
from app.robot.publishing.robot_files import MOST_BYTES, FileKind, RobotFiles
from app.robot.publishing.status_page import UPLOAD_TYPE, StatusPage
from tests.robot.languages import language_of

OLD_TABLE = """
format = "osg-studio/vehicle-table"
version = 1
cancel = ["line"]
[gestures]
"circle backwards" = { do = "hold" }
[emergency]
circle = "surface"
"""
NEW_TABLE = """
format = "osg-studio/vehicle-table"
version = 1
[gestures]
line = { do = "depth", metres = 5 }
[emergency]
circle = "hold"
"circle backwards" = "surface"
[vehicle]
system = 2
"""


class Robot:
    """A page with files, and a visitor who sends to it."""

    def __init__(self, folder: Path) -> None:
        self.replaced: list[FileKind] = []
        self.language = folder / "language.json"
        self.table = folder / "vehicle.toml"
        self.files = RobotFiles(self.language, self.table, None, self.replaced.append)
        self.page = StatusPage("127.0.0.1", 0, describe_event, self.files)

    def send(
        self,
        kind: str,
        content: bytes | str,
        token: str | None = None,
        headers: Mapping[str, str | None] | None = None,
    ) -> tuple[int, dict[str, Any]]:
        """Send a file; a header of None is left out."""
        host = f"127.0.0.1:{self.page.port}"
        sent: dict[str, str | None] = {
            "Host": host,
            "Origin": f"http://{host}",
            "Content-Type": UPLOAD_TYPE,
            "Confirm": token,
            **(headers or {}),
        }
        body = content.encode() if isinstance(content, str) else content
        sent.setdefault("Content-Length", str(len(body)))
        connection = http.client.HTTPConnection("127.0.0.1", self.page.port, timeout=20)
        with closing(connection):
            connection.putrequest("POST", f"/files/{kind}", skip_host=True)
            for name, value in sent.items():
                if value is not None:
                    connection.putheader(name, value)
            connection.endheaders(body)
            answer = connection.getresponse()
            return answer.status, json.loads(answer.read())

    def confirm(self, kind: str, content: str) -> list[str]:
        """Send a file, and again with the token; return the changes shown."""
        status, proposal = self.send(kind, content)
        assert status == 200
        assert self.send(kind, content, proposal["token"]) == (200, {"replaced": True})
        changes: list[str] = proposal["changes"]
        return changes


@pytest.fixture
def robot(tmp_path: Path) -> Iterator[Robot]:
    made = Robot(tmp_path)
    with closing(made.page):
        yield made


def test_files_that_are_missing_are_taken_and_stored_as_they_came(robot: Robot) -> None:
    assert robot.page.read_status()["files"] == {"missing": ["language", "vehicle"]}
    language = language_of("circle", "line", "circle backwards").to_json()
    changes = robot.confirm("language", language)
    assert changes[0] == "gesture 'circle': added"
    code = robot.page.read_status()
    assert code["files"] == {"missing": ["vehicle"]}
    assert robot.language.read_text() == language
    robot.confirm("vehicle", OLD_TABLE)
    assert robot.table.read_text() == OLD_TABLE
    assert robot.replaced == ["language", "vehicle"]
    assert [file.name for file in sorted(robot.language.parent.iterdir())] == [
        "language.json",
        "vehicle.toml",
    ]


def test_the_page_tells_what_the_table_would_send_and_sends_nothing(robot: Robot) -> None:
    pytest.importorskip("pymavlink", reason="needs the extra mavlink")
    assert robot.files.list_actions() == []
    robot.table.write_text(
        NEW_TABLE + '[phrases]\ndive = { do = "depth", metres = { slot = "metres" } }\n'
        'light = { do = "lights", percent = 50 }\n'
    )
    connection = http.client.HTTPConnection("127.0.0.1", robot.page.port, timeout=20)
    with closing(connection):
        connection.request("GET", "/files/vehicle")
        listed = json.loads(connection.getresponse().read())["actions"]
    assert [(each["role"], each["name"], each["does"], each["sends"]) for each in listed] == [
        ("emergency", "circle", "hold", "DO_SET_MODE ALT_HOLD"),
        ("emergency", "circle backwards", "surface", "DO_SET_MODE SURFACE"),
        (
            "gesture",
            "line",
            "depth 5 m",
            "DO_SET_MODE ALT_HOLD, then SET_POSITION_TARGET_GLOBAL_INT depth 5 m",
        ),
        (
            "phrase",
            "dive",
            "depth of 'metres'",
            "DO_SET_MODE ALT_HOLD, then SET_POSITION_TARGET_GLOBAL_INT depth metres m, at most 30",
        ),
        ("phrase", "light", "lights 50 %", "DO_SET_SERVO 13, 1500"),
    ]


def test_nothing_is_replaced_before_its_changes_are_confirmed(robot: Robot) -> None:
    robot.table.write_text(OLD_TABLE)
    status, proposal = robot.send("vehicle", NEW_TABLE)
    assert (status, robot.table.read_text(), robot.replaced) == (200, OLD_TABLE, [])
    other = robot.send("vehicle", NEW_TABLE.replace("5", "6"), proposal["token"])
    assert other[0] == 409
    robot.table.write_text(OLD_TABLE + "\n# somebody else was faster\n")
    assert robot.send("vehicle", NEW_TABLE, proposal["token"])[0] == 409
    assert robot.send("vehicle", NEW_TABLE, "")[0] == 409
    assert robot.replaced == []


def test_changes_of_emergencies_come_first(robot: Robot) -> None:
    language_of("circle", "line", "circle backwards").save(robot.language)
    robot.table.write_text(OLD_TABLE)
    _, proposal = robot.send("vehicle", NEW_TABLE)
    assert proposal["changes"] == [
        "EMERGENCY 'circle': surface becomes hold",
        "EMERGENCY 'circle backwards': nothing becomes surface",
        "gesture 'circle backwards': hold becomes nothing",
        "gesture 'line': nothing becomes depth 5 m",
        "cancel: ('line',) becomes ()",
        "vehicle.system: 1 becomes 2",
    ]
    _, proposal = robot.send("language", language_of("circle backwards", "line").to_json())
    changes = proposal["changes"]
    assert changes[:2] == [
        "vehicle table: emergency.circle is not in the language 'pool'",
        "EMERGENCY gesture 'circle': removed",
    ]
    code = ActiveLanguage.from_json(language_of("circle backwards", "line").to_json())
    assert code.sha256 != ""
    assert changes[-1].startswith("language 'pool', revision 1, code ")


def test_the_file_that_is_there_changes_nothing(robot: Robot) -> None:
    robot.table.write_text(OLD_TABLE)
    language_of("circle", "line", "circle backwards").save(robot.language)
    assert robot.send("vehicle", OLD_TABLE)[1]["changes"] == []
    assert robot.send("language", robot.language.read_bytes())[1]["changes"] == []


@pytest.mark.parametrize(
    ("kind", "content", "what"),
    [
        ("language", "{}", "not a language file"),
        ("language", "[" * 100_000, "nested"),
        ("language", b"\xff\xfe", "UTF-16, save it as UTF-8"),
        ("vehicle", "[gestures", "cannot be read"),
        ("vehicle", "version = 1", "format: Field required"),
        ("vehicle", "a = " + "[" * 20_000, "cannot be read"),
        ("vehicle", b"\xff", "cannot be read"),
        ("vehicle", "#" * 70_000, "a table has at most 65536"),
    ],
)
def test_a_file_that_the_robot_could_not_read_is_refused(
    robot: Robot, kind: str, content: bytes | str, what: str
) -> None:
    robot.table.write_text(OLD_TABLE)
    status, answer = robot.send(kind, content)
    assert status == 422
    assert what in answer["detail"]
    assert robot.table.read_text() == OLD_TABLE
    assert robot.replaced == []


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Origin": "http://evil.example"}, 403),
        ({"Origin": "null"}, 403),
        ({"Origin": None}, 403),
        ({"Origin": "http://["}, 403),
        ({"Host": "evil.example", "Origin": "http://evil.example"}, 403),
        ({"Host": "evil.example:9850", "Origin": "http://evil.example:9850"}, 403),
        ({"Host": None}, 403),
        ({"Content-Type": "text/plain"}, 415),
        ({"Content-Type": "multipart/form-data; boundary=x"}, 415),
        ({"Content-Type": None}, 415),
        ({"Content-Length": None}, 411),
        ({"Content-Length": "-1"}, 411),
        ({"Content-Length": "9" * 5000}, 413),
        ({"Content-Length": str(MOST_BYTES + 1)}, 413),
    ],
)
def test_a_foreign_page_or_program_changes_nothing(
    robot: Robot, headers: dict[str, str | None], status: int
) -> None:
    robot.table.write_text(OLD_TABLE)
    proposal = robot.files.propose("vehicle", NEW_TABLE.encode())
    answered, _ = robot.send("vehicle", NEW_TABLE, proposal.token, headers)
    assert answered == status
    assert robot.table.read_text() == OLD_TABLE


def test_a_page_without_files_takes_none(tmp_path: Path) -> None:
    robot = Robot(tmp_path)
    robot.page.close()
    with closing(StatusPage("127.0.0.1", 0, describe_event)) as plain:
        robot.page = plain
        assert robot.send("language", language_of("circle").to_json())[0] == 404
        assert plain.read_status()["files"] is None
    robot = Robot(tmp_path)
    with closing(robot.page):
        assert robot.send("../vehicle", "")[0] == 404
        assert robot.send("key", "")[0] == 404


def test_a_disk_that_is_full_keeps_the_old_file(
    robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot.table.write_text(OLD_TABLE)
    proposal = robot.files.propose("vehicle", NEW_TABLE.encode())
    robot.files._paths["vehicle"] = Path("/dev/full/vehicle.toml")
    monkeypatch.setattr(robot.files, "propose", lambda kind, content: proposal)
    status, answer = robot.send("vehicle", NEW_TABLE, proposal.token)
    assert status == 507
    assert answer["detail"].startswith("the file cannot be written: ")
    assert robot.replaced == []


def test_what_must_not_be_replaced_now_stays(robot: Robot) -> None:
    robot.table.write_text(OLD_TABLE)
    robot.files._find_obstacle = lambda kind: f"not now: {kind}"
    _, proposal = robot.send("vehicle", NEW_TABLE)
    assert robot.send("vehicle", NEW_TABLE, proposal["token"]) == (
        422,
        {"detail": "not now: vehicle"},
    )
    assert robot.table.read_text() == OLD_TABLE
    assert robot.replaced == []
