"""User interface in viser: one workspace per browser tab, without HTTP and database."""
