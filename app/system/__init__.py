"""System: reads archives of files, and reports to the service manager."""
