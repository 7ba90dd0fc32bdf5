#pragma once
#include <array>
#include <bit>
#include <optional>
#include <vector>

#include "pbrt/bxdfs/bxdf.h"
#include "pbrt/math/vec.h"

namespace pbrt {

/// Slices of values on a regular grid over the unit square (row-major, x fastest, both ends included).
class GridSlices {
  public:
    GridSlices() = default;
    /// `values` holds whole slices; nx, ny >= 2.
    GridSlices(std::vector<Float> values, int nx, int ny) : values_(std::move(values)), nx_(nx), ny_(ny) {}

    /// Bilinear interpolation; p is clamped to the square.
    Float Evaluate(const Point2 &p, size_t slice) const;
    int Nx() const { return nx_; }
    int Ny() const { return ny_; }
    size_t Count() const { return values_.size() / nx_ / ny_; }
    Float At(size_t slice, int x, int y) const { return values_[(slice * ny_ + y) * nx_ + x]; }

  private:
    std::vector<Float> values_;
    int nx_ = 0, ny_ = 0;
};

/// Weighted mean of four slices (weights sum to 1).
struct SliceBlend {
    std::array<size_t, 4> slice;
    std::array<Float, 4> weight;
};

/// Densities over the unit square and the warp that samples a blend of them. Each slice is a density: the bilinear
/// interpolation of its values, normalised to 1.
class BilinearWarp {
  public:
    struct Mapped {
        Point2 p;
        Float pdf;  ///< by area, at the sampled point
    };
    BilinearWarp() = default;
    /// Values must be >= 0, with a positive one in every slice.
    BilinearWarp(const GridSlices &values);

    Mapped Sample(const Point2 &u, const SliceBlend &blend) const;
    Mapped Invert(const Point2 &p, const SliceBlend &blend) const;

  private:
    /// MassBelowRow: integral over the rows below knot row y. Left: integral along knot row y up to knot x. Density:
    /// value at a knot. Lengths are in grid cells.
    Float MassBelowRow(const SliceBlend &blend, int y) const { return Blend(blend, below_, y, ny_); }
    Float Left(const SliceBlend &blend, int x, int y) const { return Blend(blend, left_, Index(x, y), ny_ * nx_); }
    Float Density(const SliceBlend &blend, int x, int y) const {
        return Blend(blend, density_, Index(x, y), ny_ * nx_);
    }
    size_t Index(int x, int y) const { return y * nx_ + x; }
    static Float Blend(const SliceBlend &blend, const std::vector<Float> &table, size_t at, int perSlice) {
        Float sum = 0;
        for (size_t k = 0; k < 4; ++k)
            if (blend.weight[k] != 0) sum += blend.weight[k] * table[blend.slice[k] * perSlice + at];
        return sum;
    }
    Float CellArea() const { return Float(1) / Float((nx_ - 1) * (ny_ - 1)); }

    std::vector<Float> density_, left_, below_;
    int nx_ = 0, ny_ = 0;
};

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

  private:
    const MeasuredBrdf &Brdf() const { return *std::bit_cast<const MeasuredBrdf *>(brdf_); }

    /// The pointer in 32-bit pieces, because a wider alignment would enlarge every Bsdf.
    using Pointer = std::array<uint32_t, sizeof(void *) / sizeof(uint32_t)>;
    Pointer brdf_;
    SampledWavelengths lambda_;
};

}  // namespace pbrt
