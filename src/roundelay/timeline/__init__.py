"""What repeats in a take, and how sure that is."""
