"""Comparison of scripts/golden: equal outputs agree, and each kind of difference is found."""

import importlib.machinery
import importlib.util
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "golden"
LOADER = importlib.machinery.SourceFileLoader("golden", str(SCRIPT))
golden = importlib.util.module_from_spec(importlib.util.spec_from_loader("golden", LOADER))
LOADER.exec_module(golden)


def column(*texts):
    return {"rows": len(texts), "digest": golden.digest("\n".join(texts).encode()),
            "samples": golden.sampled(list(texts))}


def differs(expected, found, tolerance):
    return bool(list(golden.differences({"value": expected}, {"value": found}, tolerance)))


class Differences(unittest.TestCase):
    def test_equal_outputs_agree(self):
        outputs = {"a.csv": {"x [m]": column("1.5", "", "2"), "verdict": column("ok", "lost")},
                   "summary.json": {"rmse_m": 0.25, "used": 3, "scale": None, "names": ["a"]}}
        self.assertEqual(list(golden.differences(outputs, outputs, 0)), [])
        self.assertEqual(list(golden.differences(outputs, outputs, 1e-9)), [])

    def test_number_differs_beyond_the_ratio_only(self):
        for large in (1.0, 1e-6, 1e6):
            self.assertFalse(differs(large, large * (1 + 0.9e-9), 1e-9))
            self.assertTrue(differs(large, large * (1 + 1.1e-9), 1e-9))
            self.assertTrue(differs(large, large * (1 + 0.9e-9), 0))

    def test_sample_differs_beyond_the_ratio_only(self):
        self.assertFalse(differs(column("", "1.00000000"), column("", "1.00000001"), 1.1e-8))
        self.assertTrue(differs(column("", "1.00000000"), column("", "1.00000001"), 1e-9))
        self.assertTrue(differs(column("0.0001"), column("0.000100001"), 1e-9))

    def test_word_differs_whether_it_is_sampled_or_not(self):
        expected, found = ["ok"] * 1000, ["ok"] * 1000
        found[500] = "lost"
        self.assertEqual(column(*expected)["samples"], column(*found)["samples"])
        self.assertTrue(differs(column(*expected), column(*found), 1e-3))
        self.assertTrue(differs(column("ok", "1"), column("ok", "1.0000001"), 1e-3))

    def test_unknown_value_differs_from_a_number(self):
        self.assertTrue(differs(column("1", ""), column("1", "0"), 1e-3))
        self.assertTrue(differs(column("", ""), column("1", "2"), 1e-3))
        self.assertTrue(differs(None, 0.0, 1e-3))
        self.assertTrue(differs(float("inf"), 1.0, 1e-3))

    def test_count_word_and_length_are_exact(self):
        self.assertTrue(differs(1000, 1001, 0.1))
        self.assertTrue(differs(True, 1, 0.1))
        self.assertTrue(differs("1.0", "1.01", 0.1))
        self.assertTrue(differs([1.0], [1.0, 1.0], 0.1))
        self.assertTrue(differs(column("1", "1"), column("1", "1", "1"), 0.1))
        self.assertTrue(differs({"a": 1.0}, {"a": 1.0, "b": 1.0}, 0.1))


if __name__ == "__main__":
    unittest.main()
