"""What every room stands on: errors, options, registries, spans of frames, files, progress."""
