"""Fitting a set of terms with its calibration, and what each more term could gain."""
