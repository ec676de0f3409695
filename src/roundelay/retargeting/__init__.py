"""A motion of one body on another, through a canonical body that both have."""
