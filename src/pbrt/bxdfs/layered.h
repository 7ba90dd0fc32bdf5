#pragma once
#include <array>
#include <bit>
#include <memory>
#include <optional>
#include <vector>

#include "pbrt/bxdfs/boundaries.h"
#include "pbrt/bxdfs/diffuse.h"

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
    /// Integrates the table: some thousand directions per roughness.
    static CoatTable Compute(Float eta, Float thickness, std::optional<Float> alpha);

    /// Coat with facets `facets`; empty if not covered.
    std::optional<ClearCoat> At(const TrowbridgeReitz &facets) const;

  private:
    CoatTable(Float eta, Float thickness) : eta_(eta), thickness_(thickness) {}
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

class Rng;

/// Opaque base under a dielectric coat with a homogeneous medium between: optical thickness `thickness` along the
/// normal, single-scattering albedo `albedo`, Henyey-Greenstein asymmetry `g`. Two-sided: the back is the same stack
/// upside down.
///
/// F and Pdf are estimated by random walks between the boundaries (position-free Monte Carlo, Guo et al. 2018), seeded
/// by the directions: equal arguments give equal results. Results average `nSamples` walks of at most `maxDepth`
/// events. Sample() is one walk, unbiased; its f and pdf are proportional to the true ones.
///
/// A clear coat on a Lambertian base needs no walks (UseTable): F is their mean, and Sample uses only the sampler's own
/// numbers. Under a smooth coat the density is exact as well.
///
/// Under a rough coat F is biased on purpose. Stock pbrt-v4 weights the two ways out of the coat with inconsistent
/// densities, which brightens rough coats over bright bases by up to 20 %. F and Pdf follow stock for matching images
/// (conformance: materials/coateddiffuse, coatedconductor). FConsistent is unbiased.
template <class Base>
class CoatedBxdf {
  public:
    CoatedBxdf(const DielectricBxdf &top, const Base &bottom, Float thickness, const SampledSpectrum &albedo, Float g,
               int maxDepth, int nSamples)
        : top_(top), bottom_(bottom), albedo_(albedo), g_(g), thickness_(std::max(thickness, kMinThickness)),
          maxDepth_(maxDepth), nSamples_(std::max(1, nSamples)), scatters_(bool(albedo)) {}

    /// Makes F and Sample use the table, of this coat's index and thickness, if it covers the coat; else random walks.
    void UseTable(const CoatTable &table) requires std::is_same_v<Base, DiffuseBxdf> {
        if (scatters_) return;
        if (std::optional<ClearCoat> coat = table.At(top_.Facets())) {
            clear_ = *coat;
            way_ = clear_.IsSmooth() ? Way::Smooth : Way::Table;
        }
    }
    bool UsesTable() const { return way_ != Way::Walk; }
    void UseWalks() { way_ = Way::Walk; }

    BxdfFlags Flags() const;
    SampledSpectrum F(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const;
    /// F with MIS weights that sum to 1: unbiased.
    SampledSpectrum FConsistent(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const;
    bool IsDirectional() const { return !top_.IsSmooth() || (!scatters_ && Has(bottom_.Flags(), BxdfFlags::Glossy)); }
    std::optional<BsdfSample> Sample(const Vector3 &wo, Float uc, const Point2 &u, TransportMode mode) const;
    Float Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const;
    void Regularize() {
        top_.Regularize();
        if constexpr (requires { bottom_.Regularize(); }) bottom_.Regularize();
        UseWalks();  // the coat has changed
    }

    /// Straight refracted path through coat and medium, for a direction above the coat.
    struct Passage {
        Vector3 inside{};       ///< refracted direction below the coat
        Float transmitted = 0;  ///< fraction of light; 0 if none
    };

    /// Terms of wo for Approximate.
    Passage ApproximationTerms(const Vector3 &wo) const { return Through(wo.z < 0 ? -wo : wo); }
    /// Cheap approximation of F without random walks: coat reflection, plus straight paths through the coat to the base
    /// and back (a metal's reflectance is taken as 1).
    Float Approximate(const Vector3 &wo, const Vector3 &wi, const Passage &in) const;

  private:
    enum class ExitWeights { Stock, Consistent };
    enum class Way : uint8_t { Walk, Smooth, Table };

    Passage Through(const Vector3 &w) const;

    template <ExitWeights Weights>
    SampledSpectrum Evaluate(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const;
    template <ExitWeights Weights>
    SampledSpectrum EstimateInside(const Vector3 &wo, const Vector3 &wi, TransportMode mode, Rng &rng) const;
    /// Between smooth boundaries, light scattered in the medium reaches the coat along `exit` also by mirror
    /// reflections.
    struct MirrorBounces {
        SampledSpectrum fromBase{0};  ///< fraction of what arrives at the base that the coat receives
        SampledSpectrum all{1};       ///< sum over further reflections at coat and base, per light received first
    };
    MirrorBounces MirrorBouncesTo(const Vector3 &exit, TransportMode mode) const;
    Float EstimateDensity(const Vector3 &wo, const Vector3 &wi, TransportMode mode, Rng &rng) const;

    // A clear coat on a Lambertian base; directions are above the coat.

    /// Fraction of light along w that passes a smooth coat, as CoatShares::through.
    Float ThroughSmooth(const Vector3 &w) const;
    /// Base reflectance including all bounces below the coat, with at most `hits` base hits.
    SampledSpectrum BaseSeries(int hits) const;
    template <ExitWeights Weights>
    SampledSpectrum ClearInside(const Vector3 &wo, const Vector3 &wi) const;
    std::optional<BsdfSample> SampleClear(const Vector3 &wo, Float uc, const Point2 &u) const;
    Float ClearDensity(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const;

    static constexpr Float kMinThickness = std::numeric_limits<Float>::min();

    DielectricBxdf top_;
    Base bottom_;
    SampledSpectrum albedo_;
    Float g_, thickness_;
    int maxDepth_, nSamples_;
    bool scatters_;
    Way way_ = Way::Walk;
    ClearCoat clear_;  ///< unless way_ is Walk
};

extern template class CoatedBxdf<DiffuseBxdf>;
extern template class CoatedBxdf<ConductorBxdf>;

using CoatedDiffuseBxdf = CoatedBxdf<DiffuseBxdf>;
using CoatedConductorBxdf = CoatedBxdf<ConductorBxdf>;

}  // namespace pbrt
