"""ASGI middleware: access, body limits, response headers, shutdown."""
