#include "agreement_statistics.h"

#include <fmt/format.h>

#include <cmath>

#include "pbrt/integrators/render_loop.h"
#include "pbrt/math/statistics.h"
#include "support/statistics.h"

namespace pbrt::test {

namespace {
constexpr double kTileAllowance = 0.01;  ///< relative; the whole image has none
}  // namespace

double StudentTail(double t, double dof) { return std::isfinite(t) ? StudentTwoSidedP(t, dof) : 0; }

void PixelStatistics::Add(const Image &image) {
    resolution_ = image.Resolution();
    size_t n = size_t(resolution_.x) * size_t(resolution_.y) * 3;
    sum_.resize(n);
    squares_.resize(n);
    size_t i = 0;
    for (int y = 0; y < resolution_.y; ++y)
        for (int x = 0; x < resolution_.x; ++x)
            for (int c = 0; c < 3; ++c, ++i) {
                auto v = double(image.Get({x, y}, c));
                sum_[i] += v;
                squares_[i] += v * v;
            }
    ++runs_;
}

PixelStatistics::Mean PixelStatistics::Of(const Bounds2i &block, int channel) const {
    double sum = 0, variance = 0, squaredVariance = 0, n = runs_;
    int pixels = 0;
    for (int y = block.low.y; y < block.high.y; ++y)
        for (int x = block.low.x; x < block.high.x; ++x, ++pixels) {
            size_t i = (size_t(y) * size_t(resolution_.x) + size_t(x)) * 3 + size_t(channel);
            double mean = sum_[i] / n;
            double v = std::max(0.0, (squares_[i] / n - mean * mean) / (n - 1));  // of the pixel's mean
            sum += mean;
            variance += v;
            squaredVariance += v * v;
        }
    Mean out;
    out.value = sum / pixels;
    out.variance = variance / (double(pixels) * pixels);
    if (squaredVariance > 0) out.dof = (n - 1) * variance * variance / squaredVariance;
    return out;
}

Agreement Compare(const PixelStatistics &one, const std::vector<const PixelStatistics *> &others, size_t comparisons,
                  double alpha) {
    Point2i size = one.Resolution();
    std::vector<Bounds2i> blocks = {Bounds2i({0, 0}, size)};
    for (int side : {16, 48})
        for (int y = 0; y < size.y; y += side)
            for (int x = 0; x < size.x; x += side)
                blocks.push_back(Bounds2i({x, y}, {std::min(x + side, size.x), std::min(y + side, size.y)}));

    Agreement out;
    out.level = SidakAlpha(alpha, blocks.size() * 3 * comparisons);
    auto k = double(others.size());
    double sumOne = 0, sumPool = 0, sumVariance = 0;
    for (size_t b = 0; b < blocks.size(); ++b)
        for (int c = 0; c < 3; ++c) {
            PixelStatistics::Mean m = one.Of(blocks[b], c);
            double pool = 0, variance = m.variance, ofVariance = m.variance * m.variance / m.dof;
            for (const PixelStatistics *other : others) {
                PixelStatistics::Mean o = other->Of(blocks[b], c);
                double v = o.variance / (k * k);
                pool += o.value / k;
                variance += v;
                ofVariance += v * v / o.dof;
            }
            if (b == 0) {
                sumOne += m.value;
                sumPool += pool;
                sumVariance += variance;
            }
            double difference = m.value - pool, p = 1;
            // Rare strong samples that a tile has missed lower its mean and its variance together.
            double off = std::max(0.0, std::abs(difference) - (b == 0 ? 0 : kTileAllowance) * pool);
            if (variance > 0) p = StudentTail(off / std::sqrt(variance), variance * variance / ofVariance);
            else if (off > 1e-6 * pool) p = 0;
            if (p < out.worstP) {
                out.worstP = p;
                out.worst = b == 0 ? fmt::format("whole image, {}", "RGB"[c])
                                   : fmt::format("{} px at {},{}, {}: {:+.1f} %", blocks[b].high.x - blocks[b].low.x,
                                                 blocks[b].low.x, blocks[b].low.y, "RGB"[c], 100 * difference / pool);
            }
        }
    out.difference = sumOne / sumPool - 1;
    out.error = std::sqrt(sumVariance) / sumPool;
    return out;
}

Image RenderIndependently(const BuiltScene &built, Integrator &integrator, int samplesPerPixel, int seed) {
    Progress progress;
    PrepareContext prepare = built.Preparation(progress);
    prepare.seed = seed;
    prepare.samplesPerPixel = samplesPerPixel;
    integrator.Prepare(prepare);
    const std::unique_ptr<Film> film = built.film->MakeRgbFilm();
    RenderSettings settings;
    settings.samplesPerPixel = samplesPerPixel;
    DiagnosticSink sink;
    const std::unique_ptr<Sampler> sampler =
        Samplers().Make("independent", ParamSet(), SamplerContext{film->FullResolution(), samplesPerPixel, seed, sink});
    RenderWaves({integrator, *built.camera, *built.filter, *film, *sampler, progress}, settings);
    return film->ToImage();
}

}  // namespace pbrt::test
