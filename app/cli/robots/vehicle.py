"""Vehicle of ``osg-studio robot --mavlink``: opens the bridge, once its table fits the language."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from app.recognition.errors import VehicleError
from app.robot import LandmarkListener, Source
from app.robot.sources.live import LiveSource

if TYPE_CHECKING:
    from app.robot.mavlink.bridge import MavlinkBridge


def open_bridge(
    address: str,
    table_file: Path,
    listener: LandmarkListener,
    source: Source,
    tell: Callable[[str], None],
    *,
    without_salutes: bool,
) -> MavlinkBridge:
    """Open the bridge to a vehicle.

    Parameters
    ----------
    address
        Address of the vehicle.
    table_file
        Vehicle table.
    listener, source
        What recognises gestures, and where its frames come from.
    tell
        Called with every line about the vehicle, from any thread.
    without_salutes
        Whether gestures are spotted without triggers, whatever the language's.

    Raises
    ------
    VehicleError
        When its library is missing, the table is invalid or names a label or phrase that the
        language lacks, a continuous movement could confirm itself, or the vehicle's address cannot
        be used.
    OSError
        When the table or its key cannot be read.

    """
    try:
        from app.robot.mavlink.bridge import MavlinkBridge
        from app.robot.mavlink.links import open_link
        from app.robot.mavlink.table import read_signing_key, read_vehicle_table
    except ModuleNotFoundError as error:
        raise VehicleError(
            f"--mavlink needs {error.name}, which is not installed; install it with: "
            'pip install "osg-studio[mavlink]"'
        ) from error
    table = read_vehicle_table(table_file)
    language = listener.language.recognizer.language
    if unknown := list(table.list_unknown(language)):
        raise VehicleError(
            f"{table_file}: {', '.join(unknown)} is not in the language {language.name!r}, which "
            f"has {', '.join(language.labels)}; correct the table or choose its language"
        )
    spots = without_salutes or listener.language.trigger.spots
    if spots and (reason := table.find_unguarded(language)):
        raise VehicleError(
            f"without salutes a movement would confirm itself, and {reason}: command the vehicle "
            "by phrases alone, or with salutes"
        )
    key = read_signing_key(table, table_file)
    link = open_link(address, table.vehicle.system, table.vehicle.component, key)
    now = source.now if isinstance(source, LiveSource) else None
    return MavlinkBridge(
        table, link, lambda: listener.language, tell, now, without_salutes=without_salutes
    )
