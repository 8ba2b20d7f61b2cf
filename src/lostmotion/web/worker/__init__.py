"""The process that reads, diagnoses and studies, and its jobs."""
