"""The viser side of the studio: one workspace per browser tab, no HTTP and no database."""
