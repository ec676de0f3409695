"""Geometry of articulated skeletons: rotations, forward kinematics, contacts."""
