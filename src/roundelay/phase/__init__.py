"""From a circular coordinate to a phase that grows with time."""
