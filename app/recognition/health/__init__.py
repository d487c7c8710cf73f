"""Health check of a language: simulated trials, findings and remedies."""
