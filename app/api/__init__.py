"""HTTP API: one router per noun under ``/api/v1``, with middleware, services and jobs."""
