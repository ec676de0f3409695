"""How far apart cycles are."""
