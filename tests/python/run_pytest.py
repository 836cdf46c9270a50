#!/usr/bin/env python3
"""Runs pytest on the given files; exit status 77, skipped, where pytest or numpy is absent."""

import sys

try:
    import numpy  # noqa: F401
    import pytest
except ImportError as absent:
    print(f"skipped: {absent.name} is not installed; run scripts/install-dependencies python")
    sys.exit(77)

sys.exit(pytest.main(["-q", "-p", "no:cacheprovider", *sys.argv[1:]]))
