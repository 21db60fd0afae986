"""Which physics a scene calls for, and why."""
