#include "pbrt/images/metrics.h"

#include <fmt/ranges.h>

#include <algorithm>

namespace pbrt {
namespace {

constexpr double kAbsoluteEpsilon = 0.01;

double EpsilonOf(Metric metric, const Image &reference) {
    return metric == Metric::RelL2 ? RelL2Epsilon(reference) : kAbsoluteEpsilon;
}

double Term(Metric metric, const Image &image, const Image &reference, Point2i p, int c, double epsilon) {
    const double x = double(image.Get(p, c)), r = double(reference.Get(p, c)), d = x - r;
    switch (metric) {
        case Metric::MAE: return std::abs(d);
        case Metric::MSE: return d * d;
        case Metric::MRSE: return d * d / ((r + 0.01) * (r + 0.01));
        case Metric::RelL2:
        case Metric::RelL2Abs: return d * d / (r * r + epsilon);
        case Metric::SMAPE: return std::abs(d) / ((std::abs(x) + std::abs(r)) / 2 + 0.01);
        case Metric::FLIP:
        case Metric::HdrFLIP: break;
    }
    return 0;
}

void RequireSameShape(const Image &image, const Image &reference) {
    if (image.Resolution() != reference.Resolution())
        throw UserError("Images of different resolution cannot be compared: {} x {} and {} x {}.", image.Resolution().x,
                        image.Resolution().y, reference.Resolution().x, reference.Resolution().y);
    if (image.Channels() != reference.Channels())
        throw UserError("Images of different channels cannot be compared: {} and {}.", fmt::join(image.Channels(), ","),
                        fmt::join(reference.Channels(), ","));
}

}  // namespace

double RelL2Epsilon(double mean) { return mean != 0 ? 0.01 * mean * mean : kAbsoluteEpsilon; }

double RelL2Epsilon(const Image &reference) {
    const std::vector<int> channels = RgbOrAllChannels(reference);
    FiniteMean mean;
    ForEachPixel(reference, [&](Point2i p) {
        for (const int c : channels) mean.Add(std::abs(double(reference.Get(p, c))));
    });
    return RelL2Epsilon(mean.Mean());
}

double ImageError(const Image &image, const Image &reference, Metric metric, Image *errorImage, size_t *skipped) {
    RequireSameShape(image, reference);
    if (metric == Metric::FLIP || metric == Metric::HdrFLIP) {
        size_t notFinite = 0;
        for (const Image *read : {&image, &reference})
            ForEachValue(*read, [&](Point2i p, int c) { notFinite += !std::isfinite(read->Get(p, c)); });
        if (skipped) *skipped = notFinite;
        return FlipReference(reference, metric == Metric::HdrFLIP).Compare(image, errorImage);
    }
    const double epsilon = EpsilonOf(metric, reference);
    if (errorImage) *errorImage = Image(PixelFormat::Float, image.Resolution(), image.Channels());
    FiniteMean all;
    for (int y = 0; y < image.Resolution().y; ++y) {
        // Row sums keep precision for large images.
        FiniteMean row;
        for (int x = 0; x < image.Resolution().x; ++x)
            for (int c = 0; c < image.ChannelCount(); ++c) {
                const double term = Term(metric, image, reference, {x, y}, c, epsilon);
                if (errorImage) errorImage->Set({x, y}, c, Float(term));
                row.Add(term);
            }
        all += row;
    }
    if (skipped) *skipped = all.skipped;
    return all.Mean();
}

double TrimmedRelL2(const Image &image, const Image &reference, double fraction, Metric metric) {
    RequireSameShape(image, reference);
    const double epsilon = EpsilonOf(metric, reference);
    std::vector<double> terms;
    ForEachPixel(image, [&](Point2i p) {
        FiniteMean mean;
        for (int c = 0; c < image.ChannelCount(); ++c) mean.Add(Term(metric, image, reference, p, c, epsilon));
        if (mean.count) terms.push_back(mean.Mean());
    });
    const auto worst = std::min(size_t(std::ceil(fraction * double(terms.size()))), terms.size());
    const size_t kept = terms.size() - worst;
    if (kept == 0) return 0;
    std::nth_element(terms.begin(), terms.begin() + kept - 1, terms.end());
    return std::accumulate(terms.begin(), terms.begin() + kept, 0.0) / double(kept);
}

}  // namespace pbrt
