"""viser workspaces over HTTP: routes, playback websocket, reverse proxy."""
