#include "pbrt/bxdfs/layered.h"

#include "pbrt/bxdfs/fresnel.h"
#include "pbrt/bxdfs/shared_table.h"
#include "pbrt/core/parallel.h"
#include "pbrt/math/warps.h"

namespace pbrt {
namespace {

/// Rows of a table for all roughnesses, at squares of equidistant numbers: the values change fastest for small alphas.
constexpr int kAlphas = 28;
constexpr int kDirectionPoints = 1024, kInnerCosines = 256, kInnerPoints = 128, kSmoothPoints = 4096;

/// k-th point of an additive low-discrepancy sequence in the square (Roberts's generalised golden ratio).
Point2 PointOfSquare(int k) {
    constexpr double a = 0.7548776662466927, b = 0.5698402909980532;
    double whole;
    return {Float(std::modf(0.5 + a * k, &whole)), Float(std::modf(0.5 + b * k, &whole))};
}

/// Mean inner Fresnel reflectance, including both crossings of the medium, over cosine-distributed directions.
Float SmoothInner(Float eta, Float thickness) {
    double sum = 0;
    for (int k = 0; k < kSmoothPoints; ++k) {
        const Float cosine = std::sqrt((Float(k) + Float(0.5)) / kSmoothPoints);
        sum += double(FresnelDielectric(-cosine, eta) * std::exp(-2 * thickness / cosine));
    }
    return Float(sum / kSmoothPoints);
}

}  // namespace

CoatTable CoatTable::Compute(Float eta, Float thickness, std::optional<Float> alpha) {
    CoatTable table(eta, thickness);
    table.smoothInner_ = SmoothInner(eta, thickness);
    const Float minAlpha = Float(1e-3);  // TrowbridgeReitz::EffectivelySmooth
    if (!alpha) {
        const Float first = std::sqrt(minAlpha);
        for (int k = 0; k < kAlphas; ++k)
            table.alphas_.push_back(Sqr(first + (std::sqrt(kMaxAlpha) - first) * Float(k) / (kAlphas - 1)));
    } else if (*alpha >= minAlpha && *alpha <= kMaxAlpha) {
        table.alphas_ = {*alpha};
    }
    if (!alpha) table.alphas_.front() = minAlpha;  // before rounding
    // Index 1 has no boundary; below 1, interpolation would blur the edge of total reflection.
    if (!(eta > 1)) table.alphas_.clear();
    table.rows_.resize(table.alphas_.size());
    table.inner_.resize(table.alphas_.size());
    // One more than the knots: the last task of a row computes inner_.
    constexpr size_t kTasks = ClearCoat::kCosines + 1;
    ParallelForEach(int64_t(table.alphas_.size() * kTasks), 16, [&](int64_t i) {
        const size_t row = i / kTasks, knot = i % kTasks;
        const DielectricBxdf top(eta, TrowbridgeReitz(table.alphas_[row], table.alphas_[row]));
        if (knot < ClearCoat::kCosines) table.rows_[row][knot] = table.SharesAt(top, ClearCoat::CosineOf(knot));
        else table.inner_[row] = table.InnerReflectance(top);
    });
    return table;
}

std::shared_ptr<const CoatTable> CoatTable::Shared(Float eta, Float thickness, std::optional<Float> alpha) {
    return SharedTable<CoatTable>(eta, thickness, alpha);
}

std::optional<ClearCoat> CoatTable::At(const TrowbridgeReitz &facets) const {
    if (facets.EffectivelySmooth() || eta_ == 1) return ClearCoat(nullptr, 0, smoothInner_);
    const Float alpha = facets.AlphaX();
    if (alpha != facets.AlphaY()) return {};
    if (alphas_.size() < 2) {
        if (alphas_.empty() || alpha != alphas_[0]) return {};
        return ClearCoat(&rows_[0], 0, inner_[0]);
    }
    if (!(alpha >= alphas_.front() && alpha <= alphas_.back())) return {};
    const Float first = std::sqrt(alphas_.front()), last = std::sqrt(alphas_.back());
    const Float x = (std::sqrt(alpha) - first) / (last - first) * Float(kAlphas - 1);
    const size_t i = std::min(size_t(std::max(x, Float(0))), alphas_.size() - 2);
    const Float fraction = std::clamp(x - Float(i), Float(0), Float(1));
    return ClearCoat(&rows_[i], fraction, Lerp(fraction, inner_[i], inner_[i + 1]));
}

CoatShares CoatTable::SharesAt(const DielectricBxdf &top, Float cosine) const {
    const Vector3 wo(SafeSqrt(1 - cosine * cosine), 0, cosine);
    double through = 0, throughStock = 0, mirrored = 0;
    int refracted = 0;
    for (int k = 0; k < kDirectionPoints; ++k) {
        const Point2 u = PointOfSquare(k);
        mirrored += double(FresnelDielectric(Dot(wo, top.Facets().SampleVisibleByCap(wo, u)), eta_));
        const DielectricBxdf::Drawn drawn = top.DrawTransmission(wo, u, TransportMode::Importance);
        if (!(drawn.weight > 0)) continue;
        ++refracted;
        const Float base = CosineHemispherePdf(AbsCosTheta(drawn.wi));
        const Float transmitted = drawn.weight * Transmittance(thickness_, drawn.wi);
        // Stock weights the way from the base out along wo with the density of leaving, instead of entering.
        const Float leaving = top.EvaluateTransmission(drawn.wi, wo, TransportMode::Radiance).pdf;
        through += double(transmitted);
        throughStock += double(transmitted * (PowerHeuristic(drawn.pdf, base) + PowerHeuristic(base, leaving)));
    }
    auto mean = [](double sum) { return Float(sum / kDirectionPoints); };
    return {mean(through), mean(throughStock), mean(mirrored), mean(refracted)};
}

Float CoatTable::InnerReflectance(const DielectricBxdf &top) const {
    double sum = 0;
    for (int i = 0; i < kInnerCosines; ++i) {
        // Back along a direction from the base, uniform in cos^2.
        const Float cos2 = (Float(i) + Float(0.5)) / kInnerCosines;
        const Vector3 down(-SafeSqrt(1 - cos2), 0, -std::sqrt(cos2));
        double reflected = 0;
        for (int k = 0; k < kInnerPoints; ++k) {
            const DielectricBxdf::Drawn drawn = top.DrawReflection(down, PointOfSquare(i * kInnerPoints + k));
            if (drawn.weight > 0) reflected += double(drawn.weight * Transmittance(thickness_, drawn.wi));
        }
        sum += reflected * double(Transmittance(thickness_, down));
    }
    return Float(sum / (kInnerCosines * kInnerPoints));
}

}  // namespace pbrt
