"""The physics that a scene calls for, and why."""
