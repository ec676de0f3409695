"""Cycles as loops: what engines are told of them, how good they are, what is wrong with them."""
