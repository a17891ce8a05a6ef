"""What stays of the best explanation: names, proof, structured rest, verdict."""
