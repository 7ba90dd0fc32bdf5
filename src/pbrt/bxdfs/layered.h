#pragma once
#include <optional>

#include "pbrt/bxdfs/coat_table.h"
#include "pbrt/bxdfs/conductor.h"
#include "pbrt/bxdfs/diffuse.h"

namespace pbrt {

class Rng;

/// An opaque base under a dielectric coat, with a homogeneous medium between them: optical thickness `thickness` along
/// the normal, single-scattering albedo `albedo`, Henyey-Greenstein asymmetry `g`. Two-sided: seen from behind it is
/// the same stack upside down.
///
/// F and Pdf are estimates by random walks between the boundaries (position-free Monte Carlo, Guo et al. 2018), with
/// random numbers derived from the directions: the same arguments give the same result. A walk has at most `maxDepth`
/// events; a result is the mean of `nSamples` walks. Sample() is one walk, unbiased; its f and pdf are proportional to
/// the true ones.
///
/// A clear coat on a Lambertian base needs no walks: UseTable. Then F is the mean of those walks, and Sample draws from
/// the sampler's own numbers alone; under a smooth coat the density is exact as well.
///
/// Under a rough coat F is biased on purpose: stock pbrt-v4 weights the two ways out of the coat with densities that do
/// not belong together, which makes rough coats over bright bases brighter by up to 20 %. Pictures must agree with
/// stock, so F and Pdf follow it (conformance: materials/coateddiffuse, coatedconductor). FConsistent is the unbiased
/// value.
template <class Base>
class CoatedBxdf {
  public:
    CoatedBxdf(const DielectricBxdf &top, const Base &bottom, Float thickness, const SampledSpectrum &albedo, Float g,
               int maxDepth, int nSamples)
        : top_(top), bottom_(bottom), albedo_(albedo), g_(g), thickness_(std::max(thickness, kMinThickness)),
          maxDepth_(maxDepth), nSamples_(std::max(1, nSamples)), scatters_(static_cast<bool>(albedo)) {}

    /// Lets F and Sample use the table, made for this coat's index and thickness, if it covers the coat. Random walks
    /// are used otherwise.
    void UseTable(const CoatTable &table) requires std::is_same_v<Base, DiffuseBxdf> {
        if (scatters_) return;
        if (std::optional<ClearCoat> coat = table.At(top_.Facets())) {
            clear_ = *coat;
            way_ = clear_.IsSmooth() ? Way::Smooth : Way::Table;
        }
    }
    bool UsesTable() const { return way_ != Way::Walk; }
    /// From now on all is estimated by random walks.
    void UseWalks() { way_ = Way::Walk; }

    BxdfFlags Flags() const;
    SampledSpectrum F(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const;
    /// As F, with MIS weights that add up to 1: unbiased.
    SampledSpectrum FConsistent(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const;
    /// True if F has a glossy lobe, of the coat or of the base.
    bool IsDirectional() const { return !top_.IsSmooth() || (!scatters_ && Has(bottom_.Flags(), BxdfFlags::Glossy)); }
    std::optional<BsdfSample> Sample(const Vector3 &wo, Float uc, const Point2 &u, TransportMode mode,
                                     ReflTransFlags which) const;
    Float Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode mode, ReflTransFlags which) const;
    void Regularize() {
        top_.Regularize();
        bottom_.Regularize();
        UseWalks();  // the coat is another one
    }

  private:
    /// Light that passes straight through coat and medium, only refracted.
    struct Passage {
        Vector3 inside;         ///< refracted direction of travel below the coat
        Float transmitted = 0;  ///< fraction of the light; 0 if none passes
    };

  public:
    /// A cheap approximation of F(wo, .) without random walks: reflection by the coat, plus light that goes through the
    /// coat to the base and back along the refracted directions (the reflectance of a metal is taken as 1). What
    /// depends on wo is computed once.
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
    /// How light inside the coat is found.
    enum class Way : uint8_t { Walk, Smooth, Table };

    /// The passage for a direction w above the coat.
    Passage Through(const Vector3 &w) const;

    template <ExitWeights Weights>
    SampledSpectrum Evaluate(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const;
    template <ExitWeights Weights>
    SampledSpectrum EstimateInside(const Vector3 &wo, const Vector3 &wi, TransportMode mode, Rng &rng) const;
    Float EstimateDensity(const Vector3 &wo, const Vector3 &wi, TransportMode mode, Rng &rng) const;

    // A clear coat on a Lambertian base; directions are above the coat.

    /// The share of the light along w that passes a smooth coat, as CoatShares::through.
    Float ThroughSmooth(const Vector3 &w) const;
    /// Reflectance of the base with all bounces below the coat, of which the base sees at most `hits`.
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
