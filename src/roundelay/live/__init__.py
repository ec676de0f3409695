"""Live: the phase of a known cycle, and periods of none that is known, frame by frame."""
