"""The corrected simulation, how sure it is, and what a diagnosis says."""
