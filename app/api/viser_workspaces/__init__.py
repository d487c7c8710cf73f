"""Workspaces in viser: opened, shown, played back and relayed over HTTP."""
