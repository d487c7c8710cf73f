"""System: reads archives of files, confines processes, reports to the service manager."""
