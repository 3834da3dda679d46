"""Results of a run with pandas: variables and units, extremes, and a history at other times.

usage: results_with_pandas.py RUN-FOLDER        (needs pandas)
"""

import sys
from pathlib import Path

import pandas as pd


def read(folder):
    """The table of a run, by time, with the plain names of the variables; and their units."""
    table = pd.read_csv(Path(folder) / "results.csv", index_col=0)
    parts = [title.rsplit(" [", 1) for title in table.columns]
    table.columns = [name for name, _ in parts]
    return table, {name: unit.rstrip("]") for name, unit in parts}


def main():
    table, units = read(sys.argv[1])
    changing = table.loc[:, table.nunique() > 1]
    extremes = pd.DataFrame({"unit": units, "smallest": changing.min(), "largest": changing.max(), "at": changing.idxmax()})
    print(extremes.dropna().to_string())
    # Ten instants, interpolated in time.
    instants = pd.Index([table.index[-1] * k / 10 for k in range(11)], name="time [s]")
    total = table.filter(like="energy").dropna(axis=1)
    print(total.reindex(table.index.union(instants)).interpolate("index").loc[instants].to_string())


if __name__ == "__main__":
    main()
