"""Vehicle table: which gesture or phrase becomes which action of the vehicle; a closed list.

A gesture or phrase outside the table does nothing. The only actions are those of this module, each
with its limits, so that no file can make the bridge send anything else.
"""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any, ClassVar, Final, Literal

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    IPvAnyAddress,
    PlainValidator,
    ValidationError,
    model_validator,
)
from typing_extensions import Self

from app.recognition import Language
from app.recognition.errors import VehicleError
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.parser import PhraseParser
from app.robot.commands.replies import Reply
from app.robot.commands.rules import (
    CONFIRM_SECONDS,
    EMERGENCY_AGE_SECONDS,
    EMERGENCY_CONFIDENCE,
    STALE_SECONDS,
    Rules,
    to_number,
)

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

FORMAT: Final = "osg-studio/vehicle-table"

GIVE_UP_SECONDS: Final = 10.0
"""Seconds, heard or not, for the vehicle to carry out an action: ten heartbeats and twenty
repetitions, enough when a fifth of all packets is lost. Then the diver has given up too."""

DEEPEST: Final = 30.0
"""Largest depth in metres, unless a table sets its own limit: a number below the depths of sport
divers is more likely misread than meant."""

MOST_BYTES: Final = 65_536
"""Largest size of a table in bytes: some hundred gestures."""

KEY_BYTES: Final = 32
"""Size of the key of MAVLink's signatures."""

ModeName = Literal[
    "STABILIZE",
    "ALT_HOLD",
    "AUTO",
    "GUIDED",
    "CIRCLE",
    "SURFACE",
    "POSHOLD",
    "MANUAL",
    "SURFTRAK",
]
"""ArduSub's modes that a gesture may choose: all but ACRO, in which nothing keeps the vehicle
level, and the detection of motors."""


class _Entry(BaseModel):
    # Strict: a number is no text or truth value, as in Rules.
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Hold(_Entry):
    """Keep depth and heading: mode ``ALT_HOLD``."""

    do: Literal["hold"] = "hold"

    mode: ClassVar[str] = "ALT_HOLD"
    words: ClassVar[str] = "hold"


class Surface(_Entry):
    """Go up to the surface: mode ``SURFACE``."""

    do: Literal["surface"] = "surface"

    mode: ClassVar[str] = "SURFACE"
    words: ClassVar[str] = "surface"


class Mode(_Entry):
    """Change the mode."""

    do: Literal["mode"]
    mode: ModeName

    @property
    def words(self) -> str:
        """The action in words."""
        return f"mode {self.mode}"


class Lights(_Entry):
    """Set the lights, in percent of their brightness."""

    do: Literal["lights"]
    percent: Annotated[float, Field(ge=0, le=100)]

    @property
    def words(self) -> str:
        """The action in words."""
        return f"lights {self.percent:g} %"


class Camera(_Entry):
    """Take one picture."""

    do: Literal["camera"]

    words: ClassVar[str] = "camera"


class SlotName(_Entry):
    """A slot of the phrase, whose value is used."""

    slot: str


class Depth(_Entry):
    """Go to a depth below the surface and hold it, in metres; in a phrase also a slot's value."""

    do: Literal["depth"]
    metres: Annotated[float, Field(gt=0)] | SlotName

    @property
    def words(self) -> str:
        """The action in words."""
        if isinstance(self.metres, SlotName):
            return f"depth of {self.metres.slot!r}"
        return f"depth {self.metres:g} m"


Action = Annotated[Hold | Surface | Mode | Lights | Camera | Depth, Field(discriminator="do")]

EMERGENCIES: Final[dict[str, Hold | Surface]] = {"hold": Hold(), "surface": Surface()}


def build_emergency(value: object) -> tuple[Hold | Surface, ...]:
    """Build the actions of an emergency from their names, or from one name."""
    names = [value] if isinstance(value, str) else value
    if not (isinstance(names, list) and names and all(each in [*EMERGENCIES] for each in names)):
        raise ValueError("Input should be 'hold' or 'surface', or a list of both")
    return tuple(EMERGENCIES[name] for name in names)


Emergency = Annotated[tuple[Hold | Surface, ...], PlainValidator(build_emergency)]
"""Actions of an emergency, tried in order: the next one when one fails."""


class Vehicle(_Entry):
    """Address of the vehicle on its MAVLink network, and limits.

    Attributes
    ----------
    system, component
        MAVLink ids of the autopilot.
    address
        IP address from which the vehicle sends to ``udpin``; None: from any.
    camera_component
        MAVLink id of the component that takes pictures; by default the autopilot, which triggers a
        camera.
    lights_servo
        Servo output that dims the lights: 13 on a BlueROV2 with a Navigator.
    deepest
        Largest depth that an action may ask for, in metres.
    repeat_seconds
        Seconds between two repetitions of a command that was not acknowledged.
    give_up_seconds
        Seconds, heard or not, after which an action that the vehicle has not done counts as failed.
    key_file
        File of the key that signs all messages (MAVLink 2), beside the table; None: no signatures.

    """

    system: Annotated[int, Field(ge=1, le=255)] = 1
    component: Annotated[int, Field(ge=1, le=255)] = 1
    address: IPvAnyAddress | None = None
    camera_component: Annotated[int, Field(ge=1, le=255)] = 1
    lights_servo: Annotated[int, Field(ge=1, le=32)] = 13
    deepest: Annotated[float, Field(gt=0, le=1000)] = DEEPEST
    repeat_seconds: Annotated[float, Field(ge=0.01, le=5)] = 0.5
    give_up_seconds: Annotated[float, Field(gt=0, le=120)] = GIVE_UP_SECONDS
    key_file: Annotated[str, Field(min_length=1)] | None = None


Pulses = Annotated[int, Field(ge=1, le=9)]


class Replies(_Entry):
    """How the vehicle replies to the diver; see `app.robot.commands.replies`.

    Attributes
    ----------
    show
        What shows the pulses: ``lights`` blink, ``tilt`` nods the camera. The camera that films the
        diver must be another one, because its picture would move.
    listening, repeat, one_of_two, done, refused
        Number of pulses of each reply, all different.

    """

    show: Annotated[tuple[Literal["lights", "tilt"], ...], Field(min_length=1, strict=False)]
    listening: Pulses = Reply.listening.pulses
    repeat: Pulses = Reply.repeat.pulses
    one_of_two: Pulses = Reply.one_of_two.pulses
    done: Pulses = Reply.done.pulses
    refused: Pulses = Reply.refused.pulses

    @model_validator(mode="after")
    def _check(self) -> Self:
        """Refuse what a diver could not tell apart."""
        counts = [self.count_pulses(reply) for reply in Reply]
        if twice := sorted({each for each in counts if counts.count(each) > 1}):
            raise ValueError(f"two answers have {twice[0]} pulses; give each its own number")
        if len(set(self.show)) < len(self.show):
            raise ValueError(f"show names {self.show[0]!r} twice; name it once")
        return self

    def count_pulses(self, reply: Reply) -> int:
        """Return the number of blinks or nods of a reply."""
        return int(getattr(self, reply.value))


class VehicleTable(_Entry):
    """Table of the actions that gestures and phrases have, read from a file.

    Attributes
    ----------
    gestures
        Action of each gesture, by label; done when the diver has repeated the gesture.
    phrases
        Action of each phrase, by its name; done when the diver has repeated the message.
    emergency
        Labels of gestures that are obeyed at once: ``surface``, ``hold``, or both in the order in
        which they are tried; nothing else.
    cancel
        Labels of gestures that cancel a gesture or message that waits for its repetition.
    confirm_seconds, stale_seconds, least_confidence, emergency_seconds, emergency_confidence
        As in `app.robot.commands.rules.Rules`.
    vehicle
        Address of the vehicle, and its limits.
    answers
        How it replies to the diver; None: it does not.

    """

    format: Literal["osg-studio/vehicle-table"]
    version: Literal[1]
    gestures: dict[str, Action] = {}
    phrases: dict[str, Action] = {}
    emergency: dict[str, Emergency] = {}
    cancel: Annotated[tuple[str, ...], Field(strict=False)] = ()
    confirm_seconds: Annotated[float, Field(ge=1, le=300)] = CONFIRM_SECONDS
    stale_seconds: Annotated[float, Field(ge=0.1, le=60)] = STALE_SECONDS
    least_confidence: Annotated[float, Field(ge=0, le=1)] = 0.0
    emergency_seconds: Annotated[float, Field(ge=0.1, le=60)] = EMERGENCY_AGE_SECONDS
    emergency_confidence: Annotated[float, Field(ge=0, le=1)] = EMERGENCY_CONFIDENCE
    vehicle: Vehicle = Vehicle()
    answers: Replies | None = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        """Refuse contradictory values, which would move the vehicle at the wrong moment."""
        if not (self.gestures or self.phrases or self.emergency):
            raise ValueError("it has no action: add one under [gestures], [phrases] or [emergency]")
        roles = [*self.gestures, *self.emergency, *self.cancel]
        if twice := sorted({label for label in roles if roles.count(label) > 1}):
            raise ValueError(f"{twice} have two meanings; keep one of them")
        for name, action in (*self.gestures.items(), *self.phrases.items()):
            if not isinstance(action, Depth):
                continue
            if isinstance(action.metres, SlotName):
                if name in self.gestures:
                    raise ValueError(f"{name!r} is a gesture and has no slots; give metres")
            elif action.metres > self.vehicle.deepest:
                raise ValueError(
                    f"{name!r} goes to {action.metres:g} m, deeper than {self.vehicle.deepest:g}; "
                    "correct it, or set vehicle.deepest"
                )
        return self

    @property
    def rules(self) -> Rules:
        """Rules of the dialogue with the diver: every command but an emergency is confirmed."""
        numbers = {each.name for each in fields(Rules)} - {"cancel", "emergency"}
        cancel, emergency = frozenset(self.cancel), frozenset(self.emergency)
        return Rules(cancel=cancel, emergency=emergency, **self.model_dump(include=numbers))

    def find_actions(self, label: str) -> Sequence[Action]:
        """Return what a gesture does; of an emergency what is tried, in order; empty: nothing."""
        roles = self.list_roles()
        return roles["emergency"].get(label) or roles["gesture"].get(label, ())

    def list_roles(self) -> dict[str, dict[str, Sequence[Action]]]:
        """Return what emergencies, gestures and phrases do, by role and name."""
        return {
            "emergency": dict(self.emergency),
            "gesture": {name: (action,) for name, action in self.gestures.items()},
            "phrase": {name: (action,) for name, action in self.phrases.items()},
        }

    def list_modes(self) -> Iterator[str]:
        """Yield the modes that its actions set, those of emergencies first."""
        every = (actions for each in self.list_roles().values() for actions in each.values())
        modes = (getattr(action, "mode", "") for actions in every for action in actions)
        yield from filter(None, dict.fromkeys(modes))

    def resolve_mission(self, mission: list[dict[str, Any]]) -> tuple[Action, ...]:
        """Return the actions of a message's phrases, in order, with the values of its slots.

        Parameters
        ----------
        mission
            Phrases as in a ``phrase_heard`` line.

        Raises
        ------
        VehicleError
            When a phrase has no action, or a depth is not a number or out of range.

        """
        return tuple(self._resolve(meaning["phrase"], meaning["slots"]) for meaning in mission)

    def _resolve(self, phrase: str, slots: dict[str, Any]) -> Action:
        action = self.phrases.get(phrase)
        if action is None:
            raise VehicleError(f"{phrase!r} is not in the table")
        if not (isinstance(action, Depth) and isinstance(action.metres, SlotName)):
            return action
        shown = slots.get(action.metres.slot)
        with suppress(ValueError):
            shown = float(shown) if isinstance(shown, str) else shown
        if not 0 < (metres := to_number(shown)) <= self.vehicle.deepest:
            raise VehicleError(f"no depth: {shown!r}, of 0 to {self.vehicle.deepest:g} m")
        return Depth(do="depth", metres=metres)

    def list_faults(
        self, language: Language, *, without_salutes: bool = False
    ) -> Iterator[tuple[bool, str]]:
        """Yield what is wrong with the table in a language, and whether nothing may be commanded.

        Without triggers a movement would confirm itself: only messages may act. An
        emergency that begins a message would be obeyed with each one. What is only in vain is no
        danger: what the language lacks, and a gesture that counts within phrases alone.
        """
        grammar = language.grammar or Grammar()
        phrases = [phrase.name for phrase in grammar.phrases]
        words = {use.label for use in grammar.uses()} if phrases else set()
        alone = sorted({*self.gestures, *self.emergency} - (words - {*self.emergency}))
        spots = without_salutes or language.trigger.spots
        if spots and (alone or not phrases):
            why = f"{', '.join(alone)} would act alone" if phrases else "there are no phrases"
            yield True, f"no commands without salutes: {why}"
        for label in PhraseParser(grammar).expected:
            if label in self.emergency:
                yield True, f"no commands: emergency.{label} begins messages"
        for role, names, known in (
            ("emergency.", self.emergency, language.labels),
            ("gestures.", self.gestures, language.labels),
            ("cancel ", self.cancel, language.labels),
            ("phrases.", self.phrases, phrases),
        ):
            for name in names:
                if name not in known:
                    yield False, f"{role}{name} is not in the language {language.name!r}"
        for label in sorted(words.intersection(self.gestures)):
            yield False, f"gestures.{label} counts within phrases only"


def describe_actions(actions: Sequence[Action]) -> str:
    """Describe what is tried, in order, such as ``surface, else hold``."""
    return ", else ".join(action.words for action in actions)


def read_vehicle_table(path: str | Path) -> VehicleTable:
    """Read a vehicle table from a TOML file, or a JSON file by its ending.

    Raises
    ------
    VehicleError
        When the file is not valid; the message names the key.
    OSError
        When the file cannot be read.

    """
    return parse_vehicle_table(Path(path).read_bytes(), path)


def parse_vehicle_table(content: bytes, path: str | Path) -> VehicleTable:
    """Parse the content of a vehicle table, TOML, or JSON by the path's ending.

    Raises
    ------
    VehicleError
        When it is not valid; the message names the key.

    """
    try:
        if len(content) > MOST_BYTES:
            raise ValueError(f"it has {len(content)} bytes, a table has at most {MOST_BYTES}")
        text = content.decode("utf-8")
        found = json.loads(text) if Path(path).suffix == ".json" else tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise VehicleError(f"{path} cannot be read: {error}") from error
    try:
        return VehicleTable.model_validate(found)
    except ValidationError as error:
        fault = error.errors()[0]
        place = ".".join(str(part) for part in fault["loc"])
        message = fault["msg"].removeprefix("Value error, ")
        where = f"{place}: " if place else ""
        raise VehicleError(f"{path}: {where}{message}; see docs/robots/mavlink.md") from error


def read_signing_key(table: VehicleTable, path: str | Path) -> bytes | None:
    """Read the key that signs the messages; None if the table names none.

    A file of 32 bytes is the key; any other text is a passphrase, whose SHA-256 is the key, as
    ground stations make it.

    Parameters
    ----------
    table
        The vehicle table.
    path
        Its file, whose folder the key's path is relative to.

    Raises
    ------
    VehicleError
        When the file is empty, or longer than a passphrase.
    OSError
        When it cannot be read.

    """
    if table.vehicle.key_file is None:
        return None
    file = Path(path).parent / table.vehicle.key_file
    with file.open("rb") as opened:
        content = opened.read(MOST_BYTES + 1)
    if len(content) == KEY_BYTES:
        return content
    phrase = content.strip()
    if not phrase or len(content) > MOST_BYTES:
        raise VehicleError(
            f"vehicle.key_file: {file} is no key; it holds {KEY_BYTES} bytes, or a passphrase"
        )
    return hashlib.sha256(phrase).digest()
