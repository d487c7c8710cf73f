"""Routers of recognitions and of the page that explains one."""
