"""Metrics of a server for Prometheus, by the client library of that project."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Mapping
from functools import partial

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, generate_latest
from prometheus_client.exposition import CONTENT_TYPE_PLAIN_0_0_4

MEDIA_TYPE = CONTENT_TYPE_PLAIN_0_0_4

REQUEST_SECONDS = (0.005, 0.02, 0.05, 0.1, 0.3, 1.0, 3.0, 10.0, 60.0)
JOB_SECONDS = (1.0, 3.0, 10.0, 30.0, 60.0, 300.0, 1800.0, 7200.0)
LAG_SECONDS = (0.005, 0.02, 0.1, 0.3, 1.0, 3.0)

LAG_EVERY = 1.0
"""Seconds between two measurements of the event loop's lag."""


class Metrics:
    """Counts of one server.

    Attributes
    ----------
    requests, request_seconds
        Counts and durations by method, route (its pattern, so that the number of series is bounded)
        and status.
    jobs
        Seconds of jobs by kind and outcome.
    stalls
        Worker processes that were ended because they made no progress for too long.
    loop_lag
        Seconds by which the event loop was late; while it is late, no request is answered.

    """

    def __init__(self) -> None:
        registry = self._registry = CollectorRegistry()
        count, measure = partial(Counter, registry=registry), partial(Histogram, registry=registry)
        self.requests = count("osg_requests", "Requests answered", ["method", "route", "status"])
        self.request_seconds = measure(
            "osg_request_seconds",
            "Seconds until the answer began",
            ["method", "route"],
            buckets=REQUEST_SECONDS,
        )
        self.jobs = measure(
            "osg_job_seconds",
            "Seconds of a job by its kind and how it ended",
            ["kind", "outcome"],
            buckets=JOB_SECONDS,
        )
        self.stalls = count("osg_worker_stalls", "Worker processes ended for their silence")
        self.loop_lag = measure(
            "osg_event_loop_lag_seconds",
            "Seconds by which the event loop was late",
            buckets=LAG_SECONDS,
        )
        self._gauges: dict[str, Gauge] = {}

    def set(self, name: str, meaning: str, values: Mapping[str, float]) -> None:
        """Set a value, or several by their label ``of``; the empty one has no label."""
        if name not in self._gauges:
            labels = [] if "" in values else ["of"]
            self._gauges[name] = Gauge(name, meaning, labels, registry=self._registry)
        for label, value in values.items():
            gauge = self._gauges[name]
            (gauge.labels(label) if label else gauge).set(value)

    def write(self) -> bytes:
        """Return all metrics in the text format of Prometheus."""
        return generate_latest(self._registry)

    async def watch_loop(self) -> None:
        """Measure the event loop's lag until cancelled."""
        while True:
            began = time.monotonic()
            await asyncio.sleep(LAG_EVERY)
            self.loop_lag.observe(max(0.0, time.monotonic() - began - LAG_EVERY))
