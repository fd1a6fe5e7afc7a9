"""Run many decks as one batch: lists, runs, journals, the table, Slurm."""
