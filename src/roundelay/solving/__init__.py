"""Skeletons solved from points: markers and keypoints become bones that turn."""

from roundelay.solving.solution import Solution, solve, solve_skeleton

__all__ = ["Solution", "solve", "solve_skeleton"]
