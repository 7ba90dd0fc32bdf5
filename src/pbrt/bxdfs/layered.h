#pragma once
#include <optional>

#include "pbrt/bxdfs/coat_table.h"
#include "pbrt/bxdfs/conductor.h"
#include "pbrt/bxdfs/diffuse.h"

namespace pbrt {

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

    /// Makes F and Sample use the table, built for this coat's index and thickness, if it covers the coat; otherwise
    /// random walks.
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
        bottom_.Regularize();
        UseWalks();  // the coat has changed
    }

  private:
    /// Straight refracted path through coat and medium, for a direction above the coat.
    struct Passage {
        Vector3 inside;         ///< refracted direction below the coat
        Float transmitted = 0;  ///< fraction of light; 0 if none
    };

  public:
    /// Cheap approximation of F(wo, .) without random walks: coat reflection, plus straight paths through the coat to
    /// the base and back (a metal's reflectance is taken as 1). Terms of wo are computed once.
    class Approximation {
      public:
        Approximation(const CoatedBxdf &coated, const Vector3 &wo);
        Float operator()(const Vector3 &wi) const;

      private:
        const CoatedBxdf &coated_;
        Float side_;
        Vector3 wo_;  ///< above the coat
        Passage in_;
    };

  private:
    enum class ExitWeights { Stock, Consistent };
    enum class Way : uint8_t { Walk, Smooth, Table };

    Passage Through(const Vector3 &w) const;

    template <ExitWeights Weights>
    SampledSpectrum Evaluate(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const;
    template <ExitWeights Weights>
    SampledSpectrum EstimateInside(const Vector3 &wo, const Vector3 &wi, TransportMode mode, Rng &rng) const;
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
