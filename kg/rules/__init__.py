"""Rules: files in three notations, one internal form, run to a fixpoint, kept true, explained."""
