"""What the user wrote: tables with their checks, loading, messages, goal and limits."""
