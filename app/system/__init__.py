"""What the operating system gives: archives of files, and the manager of services."""
