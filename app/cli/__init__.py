"""The command line ``osg-studio``: one module a command, and what commands share."""
