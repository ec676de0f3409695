"""Cycles changed: aligned, blended, feet held, limbs parted."""
