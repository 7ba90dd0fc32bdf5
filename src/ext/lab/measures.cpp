#include "ext/lab/measures.h"

#include <cmath>
#include <limits>

#include "pbrt/images/metrics.h"
#include "pbrt/math/statistics.h"

namespace ext::lab {

Json ToJson(const Measures &measures) {
    Json json;
    for (size_t i = 0; i < MeasureCount; ++i) json[MeasureNames[i]] = measures[i];
    return json;
}

Measures MeasuresFromJson(const Json &json) {
    Measures measures;
    for (size_t i = 0; i < MeasureCount; ++i) {
        const Json &value = json.at(MeasureNames[i]);
        measures[i] = value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
    }
    return measures;
}

MeasuringReference::MeasuringReference(Image reference)
    : reference_(std::move(reference)), flip_(std::make_unique<FlipReference>(reference_)) {}

Measures MeasuringReference::Compare(const Image &image) const {
    auto error = [&](Metric metric) { return ImageError(image, reference_, metric); };
    auto trimmed = [&](Metric metric) { return TrimmedRelL2(image, reference_, 0.001, nullptr, metric); };
    return {error(Metric::RelL2),   error(Metric::MSE),      error(Metric::MRSE),
            error(Metric::MAE),     error(Metric::SMAPE),    flip_->Compare(image),
            trimmed(Metric::RelL2), error(Metric::RelL2Abs), trimmed(Metric::RelL2Abs)};
}

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

namespace {

/// P-value of `mean of b > mean of a` for pairs.
double PairedP(std::span<const double> a, std::span<const double> b) {
    RunningMoments difference;
    for (size_t i = 0; i < a.size(); ++i) difference.Add(b[i] - a[i]);
    if (difference.Variance() == 0) return 0;
    const double n = static_cast<double>(a.size());
    return StudentTwoSidedP(difference.Mean() / std::sqrt(difference.Variance() / n), n - 1) / 2;
}

/// The same for independent runs. Errors vary by factors, so their logarithms are nearly normal.
double WelchP(const Summary &a, const Summary &b) {
    auto logVariance = [](const Summary &s) { return s.standardError * s.standardError / (s.mean * s.mean); };
    const double va = logVariance(a), vb = logVariance(b), variance = va + vb;
    if (variance == 0) return 0;
    const double dof =
        variance * variance / (va * va / static_cast<double>(a.count - 1) + vb * vb / static_cast<double>(b.count - 1));
    return StudentTwoSidedP(std::log(b.mean / a.mean) / std::sqrt(variance), dof) / 2;
}

}  // namespace

bool LowerBeyondNoise(std::span<const double> a, std::span<const double> b, double level) {
    const Summary sa = Summarize(a), sb = Summarize(b);
    if (sa.count < 2 || sb.count < 2 || !(sa.mean < sb.mean)) return false;
    if (sa.mean <= 0) return true;
    const bool paired = sa.count == sb.count && sa.count >= kSeedsToPair;
    return (paired ? PairedP(a, b) : WelchP(sa, sb)) < level;
}

}  // namespace ext::lab
