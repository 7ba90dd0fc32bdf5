#include "pbrt/images/metrics.h"

#include <fmt/ranges.h>

#include <cmath>

#include "pbrt/core/error.h"

namespace pbrt {

namespace {

double Term(Metric metric, double x, double r) {
    const double d = x - r;
    switch (metric) {
        case Metric::MAE: return std::abs(d);
        case Metric::MSE: return d * d;
        case Metric::MRSE: return d * d / ((r + 0.01) * (r + 0.01));
        case Metric::RelL2: return d * d / (r * r + 0.01);
    }
    return 0;
}

}  // namespace

std::optional<Metric> ParseMetric(const std::string &name) {
    if (name == "MAE") return Metric::MAE;
    if (name == "MSE") return Metric::MSE;
    if (name == "MRSE") return Metric::MRSE;
    if (name == "relL2") return Metric::RelL2;
    return {};
}

double ImageError(const Image &image, const Image &reference, Metric metric, Image *errorImage, size_t *skipped) {
    if (image.Resolution() != reference.Resolution())
        throw UserError(fmt::format("Images of different resolution cannot be compared: {} x {} and {} x {}.",
                                    image.Resolution().x, image.Resolution().y, reference.Resolution().x,
                                    reference.Resolution().y));
    if (image.Channels() != reference.Channels())
        throw UserError(fmt::format("Images of different channels cannot be compared: {} and {}.",
                                    fmt::join(image.Channels(), ","), fmt::join(reference.Channels(), ",")));
    if (errorImage) *errorImage = Image(PixelFormat::Float, image.Resolution(), image.Channels());
    double sum = 0;
    size_t counted = 0, dropped = 0;
    for (int y = 0; y < image.Resolution().y; ++y) {
        // Summed by rows, so that the precision does not fall with the size.
        double row = 0;
        for (int x = 0; x < image.Resolution().x; ++x)
            for (int c = 0; c < image.ChannelCount(); ++c) {
                Point2i p(x, y);
                double term =
                    Term(metric, static_cast<double>(image.Get(p, c)), static_cast<double>(reference.Get(p, c)));
                if (errorImage) errorImage->Set(p, c, static_cast<Float>(term));
                if (std::isfinite(term)) {
                    row += term;
                    ++counted;
                } else {
                    ++dropped;
                }
            }
        sum += row;
    }
    if (skipped) *skipped = dropped;
    return counted ? sum / static_cast<double>(counted) : 0;
}

}  // namespace pbrt
