"""What every room stands on: errors, options, thresholds, registries, spans, files, threads."""
