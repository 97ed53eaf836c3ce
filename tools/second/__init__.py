"""A second implementation of what `sortie review` measures; see tools/check_missions.py."""
