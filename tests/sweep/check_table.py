"""Checks the table of the parameter study in docs/examples/sweep.

    python check_table.py TABLE

The frequency of a clamped plate goes with the square root of Young's modulus: 6.0577 Hz at 1 MPa (1.8751040687^2 / (2 pi l^2)
sqrt(EJ / rho_l), the scene free_decay) is 191.56 Hz at 1 GPa and 270.91 Hz at 2 GPa.
"""

import csv
import math
import sys


def main():
    with open(sys.argv[1], newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 4, rows
    for row in rows:
        exact = 6.0577 * math.sqrt(float(row["body.base.member.plate.youngs_modulus"]) / 1e6)
        found = float(row["first natural frequency"])
        assert abs(found - exact) < 5e-4 * exact, f"{found} Hz, expected {exact}"
        assert row["first natural frequency: verdict"] == "outside the limit" and row["missed"] == "1", row
        assert row["status"] == "complete" and row["warnings"] == "", row
    figures = {(row["first natural frequency"], row["largest tip deflection"]) for row in rows}
    assert len(figures) == len(rows), f"rows are alike: {figures}"
    print("the parameter study: 4 rows that differ, with their verdicts")


if __name__ == "__main__":
    main()
