"""Command line ``osg-studio``: one module for each command, and modules that commands share."""
