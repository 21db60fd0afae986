"""The user's design: tables with their checks, loading, messages, goal and limits."""
