"""Modules of tools/verify."""
