"""Backup: a whole library as one file, which any machine and database can restore."""

from app.store.backup.archive import DATABASE, restore_backup, write_backup
