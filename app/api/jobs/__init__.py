"""Jobs: work that takes long, with progress and cancel.

A new kind is a task (`app.api.workers.tasks`), which a route runs as a `job.Job` of `run_task`.
"""
