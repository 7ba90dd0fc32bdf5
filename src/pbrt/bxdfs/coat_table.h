#pragma once
#include <array>
#include <bit>
#include <memory>
#include <optional>
#include <vector>

#include "pbrt/bxdfs/dielectric.h"

namespace pbrt {

/// Of a medium of extinction 1, over the height dz along w.
inline Float Transmittance(Float dz, const Vector3 &w) { return std::exp(-std::abs(dz / w.z)); }

/// Effect of a clear coat on light from one direction above it, averaged over its facets.
struct CoatShares {
    Float through = 0;       ///< fraction of light that reaches the base, including the medium's absorption
    Float throughStock = 0;  ///< the same, with the weights of stock pbrt-v4 for the two ways out of a coat
    Float mirrored = 0;      ///< Fresnel reflectance of the visible facets
    Float refracted = 0;     ///< probability that the direction refracted at a visible facet goes down
};

/// Coat of given roughness at a surface point. Points into a CoatTable.
class ClearCoat {
  public:
    /// Knots over the cosine, at squares of equidistant numbers: the values change fastest at grazing angles.
    static constexpr size_t kCosines = 64;
    static Float CosineOf(size_t knot) { return std::max(Sqr(Float(knot) / Float(kCosines - 1)), Float(1e-4)); }
    using Row = std::array<CoatShares, kCosines>;

    ClearCoat() = default;
    /// `row` null: smooth coat. Else interpolates between `row` and the next one by `fraction`.
    ClearCoat(const Row *row, Float fraction, Float inner)
        : row_(std::bit_cast<Pointer>(row)), fraction_(fraction), inner_(inner) {}

    bool IsSmooth() const { return !std::bit_cast<const Row *>(row_); }
    /// Values for a direction of this cosine, above 0. Only for rough coats.
    CoatShares At(Float cosine) const;
    /// Fraction of light from a Lambertian base that the coat reflects back to it.
    Float Inner() const { return inner_; }

  private:
    /// The pointer in 32-bit pieces: see MeasuredBxdf.
    using Pointer = std::array<uint32_t, sizeof(void *) / sizeof(uint32_t)>;
    Pointer row_{};
    Float fraction_ = 0, inner_ = 0;
};

/// Tabulated clear isotropic coats of one index and thickness, for one or all roughnesses. A Lambertian base removes
/// directional dependence. Light that enters along wo, is reflected k + 1 times by a base of reflectance R, and leaves
/// along wi is
///
///     through(wo) through(wi) / eta^2  (R / pi)  (R Inner)^k,
///
/// so random walks in the coat estimate a geometric series (CoatedBxdf). The integrals are computed once, by quadrature
/// with fixed points; with interpolation they are exact to a few 1e-4 of the mean over directions. Coats of an index
/// below 1 are covered only if smooth.
class CoatTable {
  public:
    static constexpr Float kMaxAlpha = 1;

    /// Shared table of these arguments, freed with its last owner. `alpha`: the only roughness; without it the table
    /// covers all up to kMaxAlpha. `thickness` as in CoatedBxdf.
    static std::shared_ptr<const CoatTable> Shared(Float eta, Float thickness, std::optional<Float> alpha);
    CoatTable(Float eta, Float thickness, std::optional<Float> alpha);

    /// Coat with facets `facets`; empty if not covered.
    std::optional<ClearCoat> At(const TrowbridgeReitz &facets) const;

  private:
    CoatShares SharesAt(const DielectricBxdf &top, Float cosine) const;
    Float InnerReflectance(const DielectricBxdf &top) const;

    Float eta_, thickness_;
    Float smoothInner_ = 0;
    std::vector<Float> alphas_;  ///< increasing
    std::vector<ClearCoat::Row> rows_;
    std::vector<Float> inner_;  ///< by row
};

inline CoatShares ClearCoat::At(Float cosine) const {
    const Float x = std::sqrt(std::min(cosine, Float(1))) * Float(kCosines - 1);
    const size_t i = std::min(size_t(x), kCosines - 2);
    const Float right = x - Float(i), left = 1 - right;
    auto blend = [](const CoatShares &a, Float wa, const CoatShares &b, Float wb) {
        return CoatShares{a.through * wa + b.through * wb, a.throughStock * wa + b.throughStock * wb,
                          a.mirrored * wa + b.mirrored * wb, a.refracted * wa + b.refracted * wb};
    };
    const Row *row = std::bit_cast<const Row *>(row_);
    const CoatShares here = blend(row[0][i], left, row[0][i + 1], right);
    if (fraction_ == 0) return here;
    return blend(here, 1 - fraction_, blend(row[1][i], left, row[1][i + 1], right), fraction_);
}

}  // namespace pbrt
