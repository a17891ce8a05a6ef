"""The search over sets of terms, and the sets that these data can't tell apart."""
