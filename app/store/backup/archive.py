"""Archive of a library: one file with the database, the clips and a manifest of both.

It may be written while a server works. The database is copied first, as one consistent state; every
file that a row refers to is on disk by then, and stays until the next start of the server. The
archive's database is always SQLite, so that it can be restored into any other kind.
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
import re
import shutil
import sqlite3
import tempfile
import zipfile
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import IO, Any

from sqlalchemy.exc import DataError, ProgrammingError

from app.recognition.errors import OsgError
from app.recognition.text.atomic_files import sync_directory
from app.store.atomic_files import PARTIAL_SUFFIX, publish
from app.store.backup.checked_copy import copy_checked, copy_rows
from app.store.clips import FILMSTRIP, POSTER, RECORDING
from app.store.database import Database
from app.store.models import UPRIGHT, VIDEO, JobStatus, SignIn
from app.store.objects import ObjectStore, SharedFolder

FORMAT = "osg-studio/backup"
VERSION = 1
DATABASE = "studio.db"
MANIFEST = "manifest.json"

_CLIP_FILE = re.compile(r"clips/[0-9a-f]{32}/[a-z]{1,16}(\.[a-z]{1,5})?")
_RESTORING = ".restoring-"
_DAMAGE = (zipfile.BadZipFile, KeyError, ValueError, AttributeError, RuntimeError)
_PIECE = 1024 * 1024


def write_backup(
    data_dir: Path,
    target: Path,
    *,
    clips: Path | None = None,
    objects: ObjectStore | None = None,
    url: str | None = None,
) -> int:
    """Write a backup of a library, also of one that a server uses.

    Parameters
    ----------
    data_dir
        Data folder of the library.
    target
        The file to write, readable by its owner alone; an existing file is replaced once the new
        one is complete.
    clips
        Folder of the clips' files, by default the one in `data_dir`.
    objects
        Object store of the files that are not in that folder.
    url
        SQLAlchemy URL of the database, by default SQLite's file in `data_dir`.

    Returns
    -------
    Number of clips in the backup.

    Raises
    ------
    OsgError
        When there is no database, it is damaged, or a file of a clip is missing.
    StoreUnavailable
        When the object store or the database does not answer.

    """
    clips, objects = clips or data_dir / "clips", objects or SharedFolder()
    partial = target.with_name(target.name + PARTIAL_SUFFIX)
    try:
        with tempfile.TemporaryDirectory(dir=target.parent) as scratch:
            copy = Path(scratch) / DATABASE
            _copy_database(data_dir, url, copy)
            kept = _files_by_clip(copy)
            # Videos and recordings are compressed already.
            with (
                _open_secret(partial) as file,
                zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive,
            ):
                digests = {DATABASE: _add(archive, DATABASE, copy)}
                for clip_id, names in kept.items():
                    for name in names:
                        place = f"clips/{clip_id}/{name}"
                        with _fetch(f"{clip_id}/{name}", clips, objects, Path(scratch)) as path:
                            digests[place] = _add(archive, place, path)
                manifest = {"format": FORMAT, "version": VERSION, "files": digests}
                archive.writestr(MANIFEST, json.dumps(manifest))
        publish(partial, target)
    except FileNotFoundError as error:
        raise OsgError(
            f"{error.filename} is missing, though the database refers to it; if the server was "
            "restarted meanwhile, run the backup again"
        ) from error
    finally:
        partial.unlink(missing_ok=True)
    return len(kept)


def restore_backup(
    source: Path,
    data_dir: Path,
    *,
    clips: Path | None = None,
    objects: ObjectStore | None = None,
    url: str | None = None,
) -> int:
    """Restore a backup into a data folder that holds no database, or into an empty PostgreSQL.

    Every file and every row is verified before the database is written, as if a stranger had sent
    the backup; an interrupted restore leaves an empty library and can be repeated. `clips`,
    `objects` and `url` are as in `write_backup`; files of the same name in the object store are
    replaced.

    Returns
    -------
    The number of clips restored.

    Raises
    ------
    OsgError
        When the file is no backup, is damaged, holds what no backup does, or the database exists
        and is not empty.
    StoreUnavailable
        When the object store or the database does not answer.

    """
    objects = objects or SharedFolder()
    if url is None and (data_dir / DATABASE).exists():
        raise OsgError(f"{data_dir} holds a database already; restore into an empty folder")
    data_dir.mkdir(parents=True, exist_ok=True, mode=0o700)
    clips = clips or data_dir / "clips"
    if clips.is_dir() and any(clips.iterdir()):
        raise OsgError(f"{clips} is not empty; restore into an empty folder")
    for killed in data_dir.glob(f"{_RESTORING}*"):  # It holds a whole library.
        shutil.rmtree(killed, ignore_errors=True)
    with (
        _open_backup(source) as (archive, digests),
        tempfile.TemporaryDirectory(prefix=_RESTORING, dir=data_dir) as scratch,
    ):
        folder = Path(scratch)
        checked = _unpack_checked(archive, digests, folder, source.name)

        def place_clips() -> None:
            for name in digests:
                if name != DATABASE:
                    objects.upload(folder / name, name.removeprefix("clips/"))
            if (folder / "clips").is_dir():
                shutil.rmtree(clips, ignore_errors=True)
                # The target may be on another disk, where a rename is not possible.
                shutil.move(folder / "clips", clips)

        if url is None:
            place_clips()
            sync_directory(data_dir)
            publish(checked, data_dir / DATABASE)
        else:
            _restore_rows(checked, url, place_clips)
    return len({name.split("/")[1] for name in digests if name.startswith("clips/")})


def _open_secret(path: Path) -> IO[bytes]:
    """Create a file that nobody else may read: a backup holds everything."""
    path.unlink(missing_ok=True)
    return os.fdopen(os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600), "w+b")


def _unpack_checked(
    archive: zipfile.ZipFile, digests: dict[str, str], folder: Path, called: str
) -> Path:
    """Unpack and verify all files; return a new database with the rows of the received one."""
    for name, digest in digests.items():
        place = folder / name
        place.parent.mkdir(parents=True, exist_ok=True)
        with archive.open(name) as packed, place.open("wb") as file:
            if _copy(packed, file) != digest:
                raise OsgError(f"{name} in {called} is damaged; use another backup")
    checked = folder / "checked.db"
    known = copy_checked(folder / DATABASE, checked)
    if unknown := {name.split("/")[1] for name in digests if name != DATABASE} - known:
        raise OsgError(
            f"{called} holds files of a clip {min(unknown)} that its database does not have; use "
            "another backup"
        )
    return checked


@contextmanager
def _fetch(name: str, folder: Path, objects: ObjectStore, scratch: Path) -> Iterator[Path]:
    """Yield the path of a file in the clips' folder, or of its copy from the object store.

    The copy is in `scratch` meanwhile.
    """
    here, fetched = folder / name, scratch / "fetched"
    if here.is_file() or not objects.download(name, fetched):
        yield here
        return
    try:
        yield fetched
    finally:
        fetched.unlink()


def _copy_database(data_dir: Path, url: str | None, target: Path) -> None:
    """Copy the database of a library into a file of SQLite."""
    if url is not None:
        with closing(Database(url)) as source:
            file = source.file
            if file is None:
                _copy_rows(source, target)
                return
    else:
        file = data_dir / DATABASE
    if not file.is_file():
        raise OsgError(f"{file.parent} holds no {file.name}; give the data folder with --data-dir")
    _copy_file(file, target)


def _copy_rows(source: Database, target: Path) -> None:
    with closing(Database(f"sqlite:///{target}")) as copy:
        copy.migrate()
        try:
            # One consistent state, also while servers use the database.
            with source.reading() as rows, copy.writing() as written:
                copy_rows(rows, written)
        except ProgrammingError as error:
            reason = " ".join(str(error.orig).split())
            raise OsgError(
                f"the database is not of this version ({reason}); start a server of this version "
                "on it once, or run the version that uses it"
            ) from error
    _check_database(target)


def _restore_rows(file: Path, url: str, place_clips: Callable[[], None]) -> None:
    """Copy the rows of a restored file into another database, and place the clips."""
    with closing(Database(f"sqlite:///{file}")) as source, closing(Database(url)) as target:
        if not target.shared:
            raise OsgError("OSG_DATABASE_URL names SQLite; restore into a data folder instead")
        for database in (source, target):
            database.migrate()
        with source.reading() as rows, target.writing() as written:
            try:
                copy_rows(rows, written)
            except DataError as error:
                reason = " ".join(str(error.orig).split())
                raise OsgError(
                    f"the database in the backup holds values that this one does not take "
                    f"({reason}); restore it into a data folder"
                ) from error
            # Before the rows are committed, because no row may refer to a missing file.
            place_clips()


def _copy_file(database: Path, target: Path) -> None:
    with (
        closing(sqlite3.connect(f"{database.resolve().as_uri()}?mode=ro", uri=True)) as source,
        closing(sqlite3.connect(target)) as copy,
    ):
        try:
            source.backup(copy)
        except sqlite3.Error as error:
            raise OsgError(f"the database cannot be copied now: {error}; try again") from error
        # Sessions that are ended later must not come back with the library. A database that no
        # server of this version has used has none.
        with suppress(sqlite3.OperationalError):
            copy.execute(f"DELETE FROM {SignIn.__tablename__}")
            copy.commit()
        # No journal beside the file, whatever mode the server uses.
        copy.execute("PRAGMA journal_mode=DELETE")
    _check_database(target)


def _check_database(database: Path) -> None:
    try:
        with closing(sqlite3.connect(database)) as connection:
            (verdict,) = connection.execute("PRAGMA quick_check(1)").fetchone()
    except sqlite3.Error as error:
        verdict = str(error)
    if verdict != "ok":
        raise OsgError(f"the database is damaged ({verdict})")


def _files_by_clip(database: Path) -> dict[str, list[str]]:
    """Return the names of the files of each clip that the database refers to."""
    with closing(sqlite3.connect(database)) as connection:
        rows = connection.execute(
            "SELECT clip.id, clip.source, EXISTS (SELECT 1 FROM job WHERE job.clip_id = clip.id "
            "AND job.status = ?) FROM clip",
            [JobStatus.DONE.value],
        ).fetchall()
    # The files of an unfinished job are left out: the job writes them again.
    made = (VIDEO, *UPRIGHT.values(), RECORDING, POSTER, FILMSTRIP)
    return {
        clip_id: list(dict.fromkeys([source, *(made if done else ())]))
        for clip_id, source, done in rows
    }


def _add(archive: zipfile.ZipFile, name: str, path: Path) -> str | None:
    """Add a file and return its SHA-256; pictures may be missing, and are left out."""
    optional = (POSTER, FILMSTRIP, *(f"/{each}" for each in (VIDEO, *UPRIGHT.values())))
    if name.endswith(optional) and not path.is_file():
        return None
    with path.open("rb") as file, archive.open(name, "w", force_zip64=True) as packed:
        return _copy(file, packed)


def _copy(source: IO[bytes], target: IO[bytes]) -> str:
    digest = hashlib.sha256()
    while piece := source.read(_PIECE):
        digest.update(piece)
        target.write(piece)
    return digest.hexdigest()


@contextmanager
def _open_backup(source: Path) -> Iterator[tuple[zipfile.ZipFile, dict[str, str]]]:
    """Open a backup; yield it with the SHA-256 of each of its files."""
    try:
        with zipfile.ZipFile(source) as archive:
            _require_stored(archive, source)
            manifest: Any = json.loads(archive.read(MANIFEST))
            if manifest.get("format") != FORMAT or manifest.get("version") != VERSION:
                raise OsgError(f"{source.name} is a backup of another version of this program")
            digests = {name: digest for name, digest in manifest["files"].items() if digest}
            for name in digests:
                # Only names that our backups contain become paths.
                if name != DATABASE and not _CLIP_FILE.fullmatch(name):
                    raise OsgError(f"{source.name} holds {name[:80]!r}, which no backup does")
            yield archive, digests
    except (FileNotFoundError, IsADirectoryError) as error:
        raise OsgError(f"cannot read {source}: {error.strerror}") from error
    except OsgError:
        raise
    except (*_DAMAGE, OSError) as error:
        # A damaged archive directory points before the beginning of the file.
        if isinstance(error, OSError) and error.errno != errno.EINVAL:
            raise
        raise OsgError(f"{source.name} is no backup, or is damaged ({error})") from error


def _require_stored(archive: zipfile.ZipFile, source: Path) -> None:
    """Refuse an archive that would unpack to more than its own size: ours are not compressed."""
    entries = archive.infolist()
    packed = any(entry.compress_type != zipfile.ZIP_STORED for entry in entries)
    if packed or sum(entry.file_size for entry in entries) > source.stat().st_size:
        raise OsgError(f"{source.name} is compressed, which no backup is; use another backup")
