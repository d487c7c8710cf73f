"""Frame sources of a robot: cameras, streams, clips, dive recordings."""
