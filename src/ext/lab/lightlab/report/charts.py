#!/usr/bin/env python3
"""python3 charts.py OUT: draws OUT/results.json of lightlab as OUT/chart-*.svg and .png. Needs Debian's
python3-matplotlib (and python3-numpy, which comes with it)."""
import sys

sys.dont_write_bytecode = True
import lab_results as lab  # noqa: E402

try:
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
    import chart_style
    import chart_crops
    import chart_curves
    import chart_overhead
    import chart_pareto
except ImportError as e:
    print(f"charts.py: no charts, because Python misses {e.name}: install Debian's python3-matplotlib.",
          file=sys.stderr)
    sys.exit(1)


def draw_all(folder):
    results = lab.Results(folder)
    chart_style.apply()
    charts = [("chart-error-time", lambda: chart_curves.draw(results, "seconds")),
              ("chart-error-samples", lambda: chart_curves.draw(results, "samples")),
              ("chart-speed-accuracy", lambda: chart_pareto.draw(results)),
              ("chart-overhead", lambda: chart_overhead.draw(results)),
              ("chart-crops", lambda: chart_crops.draw(results))]
    for name, draw in charts:
        figure = draw()
        for suffix in ("svg", "png"):
            file = results.folder / f"{name}.{suffix}"
            if figure is None:
                file.unlink(missing_ok=True)  # a chart of an earlier run must not pass for one of this run
            elif suffix == "svg":
                figure.savefig(file, metadata={"Date": None})
            else:
                figure.savefig(file, dpi=180)
        if figure is None:
            print(f"{name}: nothing to draw")
        else:
            plt.close(figure)
            print(f"{name}.svg, {name}.png")


if __name__ == "__main__":
    lab.main_with(draw_all)
