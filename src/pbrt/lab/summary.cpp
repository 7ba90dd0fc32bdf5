#include "pbrt/lab/summary.h"

#include <cmath>

#include "pbrt/math/statistics.h"

namespace pbrt::lab {

Summary Summarize(std::span<const double> values) {
    RunningMoments moments;
    for (double v : values) moments.Add(v);
    Summary out;
    out.count = moments.Count();
    out.mean = moments.Mean();
    out.stdDev = std::sqrt(moments.Variance());
    if (out.count > 1) out.standardError = out.stdDev / std::sqrt(static_cast<double>(out.count));
    return out;
}

bool FirefliesDecide(double relL2, double trimmedRelL2, double factor) { return relL2 > factor * trimmedRelL2; }

bool LowerBeyondNoise(const Summary &a, const Summary &b, double level) {
    if (a.count < 2 || b.count < 2 || !(a.mean < b.mean)) return false;
    // Errors vary by factors, so their logarithms are what is nearly normal.
    auto logVariance = [](const Summary &s) {
        const double relative = s.mean > 0 ? s.standardError / s.mean : 0;
        return relative * relative;
    };
    const double va = logVariance(a), vb = logVariance(b), variance = va + vb;
    if (variance == 0 || a.mean <= 0) return true;
    const double dof =
        variance * variance / (va * va / static_cast<double>(a.count - 1) + vb * vb / static_cast<double>(b.count - 1));
    const double t = std::log(b.mean / a.mean) / std::sqrt(variance);
    return StudentTwoSidedP(t, dof) / 2 < level;
}

std::optional<Winner> FindWinner(std::span<const Contender> contenders) {
    std::optional<Winner> winner;
    auto takesPart = [&](size_t i) {
        return contenders[i].eligible && contenders[i].error.count > 0 && std::isfinite(contenders[i].error.mean);
    };
    for (size_t i = 0; i < contenders.size(); ++i)
        if (takesPart(i) && (!winner || contenders[i].error.mean < contenders[winner->index].error.mean))
            winner = Winner{i, true};
    if (!winner) return {};
    for (size_t i = 0; i < contenders.size(); ++i)
        if (i != winner->index && takesPart(i))
            winner->beyondNoise &= LowerBeyondNoise(contenders[winner->index].error, contenders[i].error);
    return winner;
}

}  // namespace pbrt::lab
