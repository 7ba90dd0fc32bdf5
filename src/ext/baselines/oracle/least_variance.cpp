#include "ext/baselines/oracle/least_variance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ext {
namespace {
constexpr int kMaxSteps = 30;
constexpr double kTolerance = 1e-3;

double Square(Float v) { return double(v) * double(v); }

/// -dS/dp times p^2 for one point of value 1, computed relative to max(p, r) to avoid under- and overflow: 1 for r = 0.
/// Never negative: x^3 - 3x + 4 > 0 for x = p/r >= 0.
double Gain(double p, double r) {
    const double s = std::max(p, r);
    p /= s;
    r /= s;
    const double d = p * p + r * r;
    return p * p * p * (p * p * p - 3 * p * r * r + 4 * r * r * r) / (d * d * d);
}
}  // namespace

bool LeastVariancePmf(std::span<const LightPoint> points, std::span<double> pmf) {
    const size_t lights = pmf.size(), perLight = lights ? points.size() / lights : 0;
    auto of = [&](size_t light) { return points.subspan(light * perLight, perLight); };
    auto root = [&](size_t light) {
        double m = 0;
        for (const LightPoint &y : of(light)) m += Square(y.value);
        return std::sqrt(m);
    };
    double total = 0;
    for (size_t l = 0; l < lights; ++l) total += root(l);
    if (!(total > 0) || !std::isfinite(total)) return false;
    for (size_t l = 0; l < lights; ++l) pmf[l] = root(l) / total;
    const bool anyRatio = std::ranges::any_of(points, [](const LightPoint &y) { return y.value > 0 && y.ratio > 0; });
    if (!anyRatio || lights == 1) return true;

    for (int step = 0; step < kMaxSteps; ++step) {
        double sum = 0, least = std::numeric_limits<double>::infinity(), most = 0;
        for (size_t l = 0; l < lights; ++l) {
            double p = pmf[l], gain = 0;
            if (!(p > 0)) continue;
            for (const LightPoint &y : of(l)) gain += Square(y.value) * Gain(p, double(y.ratio));
            double target = std::sqrt(gain);  // unnormalized
            if (p > kTolerance) {
                least = std::min(least, target / p);
                most = std::max(most, target / p);
            }
            // Half a step in the logarithm: a full step can oscillate around the minimum.
            sum += pmf[l] = std::sqrt(p * target);
        }
        for (size_t l = 0; l < lights; ++l) pmf[l] /= sum;
        if (most <= least * (1 + kTolerance)) break;
    }
    return true;
}

}  // namespace ext
