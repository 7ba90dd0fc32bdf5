#!/usr/bin/env python3
"""Prints who wins on each scene, and how fast the samplers are against one of them.

    python3 read_results.py hotel-lab/results.json lamp-lab/results.json [--against bvh]
"""
import argparse
import json
import math


def speed_up(sampler, other):
    """Time that `other` needs for the error of `sampler`, over its own time; None where the curves do not tell."""
    return sampler["summary"]["speedUps"].get(other)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results", nargs="+", help="results.json of lightlab")
    parser.add_argument("--against", default="bvh", help="label of a sampler (bvh)")
    options = parser.parse_args()
    ratios = {}
    for path in options.results:
        with open(path, encoding="utf-8") as file:
            results = json.load(file)
        if results["schema"] != 2:
            raise SystemExit(f"{path}: schema {results['schema']}; this program reads 2")
        print(f"{results['sceneName']}: {results['conclusion']['headline']}")
        for sampler in results["samplers"]:
            error = sampler["summary"]["metrics"]["relL2"]
            ratio = speed_up(sampler, options.against)
            print(f"  {sampler['label']:<24} relL2 {error['mean']:.4g} +- {error['standardError']:.2g}"
                  f"  {sampler['summary']['bias']['verdict']:<8}"
                  + (f"  {ratio:.2f} times as fast as {options.against}" if ratio else ""))
            if ratio and not sampler["isOracle"]:
                ratios.setdefault(sampler["label"], []).append(ratio)
    if len(options.results) > 1:
        print("All scenes (geometric mean):")
        for label, values in ratios.items():
            mean = math.exp(sum(map(math.log, values)) / len(values))
            print(f"  {label:<24} {mean:.2f} times as fast as {options.against} ({len(values)} scenes)")


if __name__ == "__main__":
    main()
