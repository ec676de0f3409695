"""Motions of skeletons, and what the search sees of them."""
