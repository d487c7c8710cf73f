"""Health check of a language: forecast, findings and map."""
