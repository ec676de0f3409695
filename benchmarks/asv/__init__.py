"""Speed over the history of the project, by asv: ``pip install asv; asv run v0.1.0..main``.

What users run is timed on the bundled captures, and a topology of known size. Other benchmarks
measure against peers and truth; these tell which commit made something slower.
"""
