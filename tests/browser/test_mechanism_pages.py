# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of pages with mechanisms, and of pages whose result says odd things, in one browser (those of reports: test_pages)."""
import unittest

MODULES = ["test_show", "test_odd", "test_view"]


def load_tests(loader, _tests, _pattern):
    return loader.loadTestsFromNames(MODULES)


if __name__ == "__main__":
    unittest.main()
