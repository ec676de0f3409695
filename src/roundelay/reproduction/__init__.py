"""The papers to the letter, where the product goes another way."""
