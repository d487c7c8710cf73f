"""The check of a language before the dive: simulated trials, findings, remedies."""
