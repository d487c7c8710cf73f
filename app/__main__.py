"""Run the command line as ``python -m app``."""

from app.cli.application import main

if __name__ == "__main__":
    main()
