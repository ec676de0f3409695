"""How roundelay is given out: binaries for six systems, what is checked of them, versions."""
