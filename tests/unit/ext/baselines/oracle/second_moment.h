#pragma once
#include <algorithm>
#include <limits>

#include "ext/baselines/oracle/oracle_light_sampler.h"

namespace ext {

/// Term of S(p) for one point of value 1, computed relative to max(p, r) to avoid under- and overflow.
inline double Moment(double p, double r) {
    const double s = std::max(p, r);
    if (!(s > 0)) return std::numeric_limits<double>::infinity();
    p /= s;
    r /= s;
    const double d = p * p + r * r;
    return (p * p * p + r * r * r) / (d * d * s);
}

/// S(p) of MinVariancePmf for these points.
inline double SecondMoment(std::span<const LightPoint> points, std::span<const double> pmf) {
    const size_t perLight = pmf.empty() ? 0 : points.size() / pmf.size();
    double sum = 0;
    for (size_t l = 0; l < pmf.size(); ++l)
        for (const LightPoint &y : points.subspan(l * perLight, perLight))
            if (y.value > 0)
                sum += double(y.value) * double(y.value) * Moment(pmf[l], double(y.ratio)) / double(perLight);
    return sum;
}

}  // namespace ext
