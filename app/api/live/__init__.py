"""Live view: frames of a camera in, landmarks and recognitions out, over a websocket."""
