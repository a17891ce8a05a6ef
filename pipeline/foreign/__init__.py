"""Readers of other people's files: each format to named columns, without any meaning yet."""
