"""Gait: when each foot comes down and leaves the ground, and strides as a table."""
