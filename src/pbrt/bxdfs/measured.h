#pragma once
#include <bit>
#include <optional>

#include "pbrt/bxdfs/bilinear_warp.h"
#include "pbrt/bxdfs/bxdf.h"

namespace pbrt {

/// Measured BRDF in the adaptive parameterization of Dupuy and Jakob 2018. Half vectors are points of the unit square:
/// (sqrt(2 theta / Pi), phi / 2 Pi + 1/2), phi relative to the view's if isotropic. A visible-normal warp maps the
/// square of measurements to that of half vectors.
class MeasuredBrdf {
  public:
    struct Tables {
        std::vector<Float> phi, theta;   ///< of the views; at most two phi: isotropic
        std::vector<Float> wavelengths;  ///< nm, increasing
        GridSlices ndf, sigma;           ///< one slice each: normal distribution by half vector, projected area by view
        BilinearWarp visibleNormals;     ///< slice by (phi, theta) of the view: density by half vector
        BilinearWarp luminance;          ///< the same slices: density by measured point
        GridSlices spectra;              ///< slice by (phi, theta, wavelength): value at a measured point
    };
    explicit MeasuredBrdf(Tables tables) : t_(std::move(tables)), isotropic_(t_.phi.size() <= 2) {}

    /// Both directions above the surface.
    SampledSpectrum F(const Vector3 &wo, const Vector3 &wi, const SampledWavelengths &lambda) const;
    Float Pdf(const Vector3 &wo, const Vector3 &wi) const;
    std::optional<BsdfSample> Sample(const Vector3 &wo, const Point2 &u, const SampledWavelengths &lambda) const;

  private:
    struct View;
    View ViewFrom(const Vector3 &wo) const;
    Point2 SquareOfHalf(const View &view, const Vector3 &half) const;
    SampledSpectrum Value(const View &view, const Point2 &measured, const Point2 &half, Float cosI,
                          const SampledWavelengths &lambda) const;

    Tables t_;
    bool isotropic_;
};

/// Measured BRDF at one path's wavelengths, the same on both sides. `brdf` must outlive it.
class MeasuredBxdf {
  public:
    MeasuredBxdf(const MeasuredBrdf &brdf, const SampledWavelengths &lambda)
        : brdf_(std::bit_cast<Pointer>(&brdf)), lambda_(lambda) {}

    BxdfFlags Flags() const { return BxdfFlags::Glossy | BxdfFlags::Reflection; }
    SampledSpectrum F(const Vector3 &wo, const Vector3 &wi, TransportMode) const;
    std::optional<BsdfSample> Sample(const Vector3 &wo, Float uc, const Point2 &u, TransportMode) const;
    Float Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode) const;
    void Regularize() {}

  private:
    const MeasuredBrdf &Brdf() const { return *std::bit_cast<const MeasuredBrdf *>(brdf_); }

    /// The pointer in 32-bit pieces, because a wider alignment would enlarge every Bsdf.
    using Pointer = std::array<uint32_t, sizeof(void *) / sizeof(uint32_t)>;
    Pointer brdf_;
    SampledWavelengths lambda_;
};

}  // namespace pbrt
