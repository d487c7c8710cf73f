"""Backup: a library as one file, which moves it to another machine or database as well."""

from app.store.backup.archive import DATABASE, restore_backup, write_backup

__all__ = ["DATABASE", "restore_backup", "write_backup"]
