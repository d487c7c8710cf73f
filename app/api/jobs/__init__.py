"""Jobs: work that takes long, with progress and cancel; one module per kind.

A new kind is a class with the members of `job.Job`; a route awaits it with `studio.runner.run`.
"""
