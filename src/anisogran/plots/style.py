"""What the pictures share: their colours and the sheet of axes that they are drawn on."""

from matplotlib.figure import Figure

COLOURS = {"dem": "#1b4965", "fit": "#d1495b", "local": "#8d99ae", "nonlocal": "#d1495b", "exponential": "#edae49"}
SERIES = ("#1b4965", "#2a9d8f", "#edae49", "#e76f51", "#d1495b", "#6a4c93")
GRAIN = "#e9e4d8"
WALL = "#9a9184"


def figure(columns, rows=1, width=4.4, height=3.5):
    """A Figure with an array of axes, shape (rows, columns)."""
    fig = Figure(figsize=(width * columns, height * rows), layout="constrained")
    return fig, fig.subplots(rows, columns, squeeze=False)
