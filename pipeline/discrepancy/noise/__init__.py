"""The noise of a recording: its model, how it is learnt, and its whitening."""
