"""From phased poses to cycles: closed curves of poses with their travel."""
