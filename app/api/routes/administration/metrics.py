"""Route of the metrics for Prometheus, for administrators."""

from __future__ import annotations

import shutil

from fastapi import APIRouter, Request, Response

from app.api.observation.metrics import MEDIA_TYPE
from app.api.services.running_studio import CurrentStudio

router = APIRouter()


@router.get("/metrics", include_in_schema=False)
def get_metrics(request: Request, studio: CurrentStudio) -> Response:
    """Return counts and gauges as text; only for the role admin where tokens are needed."""
    metrics = studio.metrics
    metrics.set("osg_jobs_open", "Jobs by status", studio.jobs.count_by_status())
    uploads = studio.uploads.active()
    metrics.set("osg_uploads_open", "Resumable uploads under way", {"": len(uploads)})
    missing = sum(upload.to_come for upload in uploads)
    metrics.set("osg_upload_bytes_to_come", "Bytes that they still announce", {"": missing})
    disk = shutil.disk_usage(studio.settings.data_dir)
    metrics.set("osg_disk_free_bytes", "Free space of the data folder's disk", {"": disk.free})
    metrics.set("osg_disk_total_bytes", "Size of that disk", {"": disk.total})
    connections = len(request.app.state.connections)
    metrics.set("osg_connections_open", "Open connections", {"": connections})
    return Response(metrics.write(), media_type=MEDIA_TYPE)
