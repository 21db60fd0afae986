"""Run directories, manifest and checkpoint."""
