#include "pbrt/integrators/guide_grid.h"

namespace pbrt {

namespace {

constexpr int kSide = GuideGrid::kSide;
/// A cell whose middle is farther below the horizon than this has no direction above it, or hardly any.
constexpr Float kHorizon = -0.2f;
/// The least cosine of cells that may have directions above the horizon.
constexpr Float kMinCosine = 0.08f;

struct Middles {
    alignas(64) std::array<Float, GuideGrid::kCells> x, y, z;
    Middles() {
        for (size_t i = 0; i < GuideGrid::kCells; ++i) {
            const Vector3 w = EqualAreaSquareToSphere(
                {(static_cast<Float>(i % kSide) + 0.5f) / kSide, (static_cast<Float>(i / kSide) + 0.5f) / kSide});
            x[i] = w.x;
            y[i] = w.y;
            z[i] = w.z;
        }
    }
};
const Middles kMiddles;

}  // namespace

void GuideDirections::Prepare(const GuideGrid &grid, const Vector3 &n, bool bothSides) {
    column_.fill(0);
    for (size_t row = 0; row < kSide; ++row) {
        for (size_t k = 0; k < kSide; ++k) {
            const size_t i = row * kSide + k;
            Float cosine = kMiddles.x[i] * n.x + kMiddles.y[i] * n.y + kMiddles.z[i] * n.z;
            cosine = bothSides ? std::abs(cosine) : cosine;
            const Float weight = cosine > kHorizon ? grid.cell[i] * std::max(cosine, kMinCosine) : 0;
            weight_[i] = weight;
            column_[k] += weight;
        }
    }
    total_ = 0;
    for (const Float sum : column_) total_ += sum;
    perUnit_ = total_ > 0 ? 1 / (total_ * GuideGrid::kCellSolidAngle) : 0;
}

Vector3 GuideDirections::Sample(const Point2 &u, Float *pdf) const {
    // Rounding may lead behind the last cell; then the last one with a weight is taken.
    const auto choose = [](Float number, Float sum, const Float *weights, size_t stride, Float *left) {
        Float x = number * sum;
        size_t chosen = 0;
        for (size_t k = 0; k < kSide; ++k) {
            const Float weight = weights[k * stride];
            if (!(weight > 0)) continue;
            chosen = k;
            if (x < weight) break;
            x -= weight;
        }
        *left = std::clamp(x / weights[chosen * stride], Float(0), OneMinusEpsilon);
        return chosen;
    };
    Point2 inside;
    const size_t column = choose(u.x, total_, column_.data(), 1, &inside.x);
    const size_t row = choose(u.y, column_[column], &weight_[column], kSide, &inside.y);
    *pdf = weight_[row * kSide + column] * perUnit_;
    return EqualAreaSquareToSphere((Point2(static_cast<Float>(column), static_cast<Float>(row)) + inside) /
                                   Float(kSide));
}

}  // namespace pbrt
