#pragma once
#include "pbrt/core/error.h"
#include "pbrt/media/medium_kinds.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt {

/// Regular voxels in a box, x fastest. Values are at voxel centres, interpolated trilinearly. As in stock pbrt-v4,
/// voxels outside the box are 0, so values fade in the outer half of the outermost voxels.
///
/// Points are in the coordinates of a MajorantGrid over the same box. Callers pass a function of the voxel index.
class Voxels {
  public:
    Voxels(const glm::ivec3 &count, const glm::ivec3 &gridResolution)
        : count_(count), perCell_(Vector3(count) / Vector3(gridResolution)) {}

    size_t Size() const { return size_t(1) * count_.x * count_.y * count_.z; }

    auto Interpolate(const Point3 &p, auto &&valueOf) const {
        const Vector3 v = ToVoxels(p), low = glm::floor(v), w = v - low;
        const glm::ivec3 first(low);
        using Value = decltype(valueOf(size_t(0)));
        Value sum{};
        for (int z = 0; z < 2; ++z)
            for (int y = 0; y < 2; ++y)
                for (int x = 0; x < 2; ++x) {
                    const glm::ivec3 at = first + glm::ivec3(x, y, z);
                    if (!Has(at)) continue;
                    const Float weight = (x ? w.x : 1 - w.x) * (y ? w.y : 1 - w.y) * (z ? w.z : 1 - w.z);
                    if (weight > 0) sum += valueOf(IndexOf(at)) * weight;
                }
        return sum;
    }
    /// Largest value of all voxels that influence a grid cell; at least 0.
    Float MaxIn(const glm::ivec3 &cell, auto &&valueOf) const {
        const glm::ivec3 low = glm::max(glm::ivec3(glm::floor(ToVoxels(Point3(cell)))), glm::ivec3(0));
        const glm::ivec3 high = glm::min(glm::ivec3(glm::ceil(ToVoxels(Point3(cell + 1)))), count_ - 1);
        Float max = 0;
        for (int z = low.z; z <= high.z; ++z)
            for (int y = low.y; y <= high.y; ++y)
                for (int x = low.x; x <= high.x; ++x) max = std::max(max, valueOf(IndexOf({x, y, z})));
        return max;
    }

  private:
    /// Voxel units, centre of voxel i at i. The fused operation rounds identically wherever it is inlined, and is
    /// monotonic in p, so a cell's voxels are those between its ends.
    Vector3 ToVoxels(const Point3 &p) const {
        return {std::fma(p.x, perCell_.x, Float(-0.5)), std::fma(p.y, perCell_.y, Float(-0.5)),
                std::fma(p.z, perCell_.z, Float(-0.5))};
    }
    bool Has(const glm::ivec3 &v) const {
        return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < count_.x && v.y < count_.y && v.z < count_.z;
    }
    size_t IndexOf(const glm::ivec3 &v) const { return (size_t(1) * v.z * count_.y + v.y) * count_.x + v.x; }
    glm::ivec3 count_;
    Vector3 perCell_;
};

/// Voxels with a density that multiplies absorption and scattering, optionally an emission factor and a temperature.
class UniformGridMedium final : public Medium {
  public:
    struct Grids {
        glm::ivec3 count{1};             ///< voxels per axis
        std::vector<Float> density;      ///< at least 0
        std::vector<Float> emission;     ///< factor of the emission; empty: 1 in one voxel as large as the box
        std::vector<Float> temperature;  ///< kelvin; empty: none
    };
    /// `bounds`: of the voxels, in medium space. Without temperatures the emission is that of `spectra`.
    UniformGridMedium(MediumSpectra spectra, Float g, const Transform &renderFromMedium, const Bounds3 &bounds,
                      Grids grids, const ThermalEmission &thermal)
        : Medium(g,
                 spectra.absorption.MaxValue() > 0 && (spectra.emission.MaxValue() > 0 || !grids.temperature.empty())),
          spectra_(std::move(spectra)), grids_(std::move(grids)), thermal_(thermal),
          voxels_(grids_.count, CellsOfUniformGrid(grids_.count)),
          emissionVoxels_(grids_.emission.empty() ? glm::ivec3(1) : grids_.count, CellsOfUniformGrid(grids_.count)) {
        if (grids_.emission.empty()) grids_.emission = {1};
        PBRT_CHECK(grids_.density.size() == voxels_.Size());
        PBRT_CHECK(grids_.emission.size() == emissionVoxels_.Size());
        PBRT_CHECK(grids_.temperature.empty() || grids_.temperature.size() == voxels_.Size());
        auto density = [this](size_t i) { return grids_.density[i]; };
        const glm::ivec3 cells = CellsOfUniformGrid(grids_.count);
        majorants_ =
            MajorantGrid(cells, [&](const glm::ivec3 &cell) { return kMajorantSlack * voxels_.MaxIn(cell, density); });
        gridFromRender_ = GridFromRender(renderFromMedium, bounds, cells);
    }
    size_t Bytes() const override {
        const size_t values = grids_.density.size() + grids_.emission.size() + grids_.temperature.size();
        return sizeof(*this) + spectra_.Bytes() + majorants_.Bytes() + values * sizeof(Float);
    }
    MediumOnRay On(const Ray &ray, Float tMax, const SampledWavelengths &lambda) const override {
        return {*this, GridWalk(majorants_, gridFromRender_, ray, tMax), lambda, spectra_.Sample(lambda)};
    }

  private:
    /// Measured: of 1 to 32 cells per axis, 1 is fastest in small grids and 4 to 8 in larger ones.
    static glm::ivec3 CellsOfUniformGrid(const glm::ivec3 &voxels) { return MajorantCells(voxels, 4, 8); }
    MediumCoefficients Evaluate(MediumOnRay &onRay, Float t) const override {
        const Point3 p = onRay.Walk().At(t);
        auto read = [&](const std::vector<Float> &values, const Voxels &voxels) {
            return voxels.Interpolate(p, [&values](size_t i) { return values[i]; });
        };
        const Float density = read(grids_.density, voxels_);
        const MediumCoefficients &unit = onRay.Unit();
        MediumCoefficients c{unit.absorption * density, unit.scattering * density, unit.emission};
        if (!IsEmissive()) return c;
        if (!grids_.temperature.empty()) c.emission = thermal_.At(read(grids_.temperature, voxels_), onRay.Lambda());
        c.emission *= read(grids_.emission, emissionVoxels_);
        return c;
    }

    MediumSpectra spectra_;
    Grids grids_;
    ThermalEmission thermal_;
    Voxels voxels_, emissionVoxels_;
    MajorantGrid majorants_;
    AffineMap gridFromRender_;
};

/// Box of RGB voxels for absorption, scattering and emission. Interpolates the uplifted spectra, not the colours.
class RgbGridMedium final : public Medium {
  public:
    struct Grids {
        glm::ivec3 count{1};                                       ///< voxels per axis
        std::vector<RgbUnboundedSpectrum> absorption, scattering;  ///< empty: 1
        std::vector<RgbUnboundedSpectrum> emission;                ///< without the illuminant; empty: 0
        const Spectrum *illuminant = nullptr;                      ///< factor of the emission
        Float scale = 1;                                           ///< of absorption and scattering
        Float emissionScale = 1;
    };
    /// `bounds`: of the voxels, in medium space.
    RgbGridMedium(Float g, const Transform &renderFromMedium, const Bounds3 &bounds, Grids grids)
        : Medium(g, !grids.emission.empty() && grids.emissionScale > 0 && grids.scale > 0), grids_(std::move(grids)),
          voxels_(grids_.count, CellsOfRgbGrid(grids_.count)) {
        for (const auto *grid : {&grids_.absorption, &grids_.scattering, &grids_.emission})
            PBRT_CHECK(grid->empty() || grid->size() == voxels_.Size());
        PBRT_CHECK(grids_.emission.empty() || grids_.illuminant);
        const glm::ivec3 cells = CellsOfRgbGrid(grids_.count);
        majorants_ = MajorantGrid(cells, [&](const glm::ivec3 &cell) {
            return kMajorantSlack * grids_.scale *
                   (HighestIn(grids_.absorption, cell) + HighestIn(grids_.scattering, cell));
        });
        gridFromRender_ = GridFromRender(renderFromMedium, bounds, cells);
    }
    size_t Bytes() const override {
        const size_t spectra = grids_.absorption.size() + grids_.scattering.size() + grids_.emission.size();
        return sizeof(*this) + majorants_.Bytes() + spectra * sizeof(RgbUnboundedSpectrum);
    }
    MediumOnRay On(const Ray &ray, Float tMax, const SampledWavelengths &lambda) const override {
        MediumCoefficients unit{SampledSpectrum(grids_.scale), SampledSpectrum(grids_.scale), SampledSpectrum(0)};
        if (IsEmissive()) unit.emission = grids_.emissionScale * grids_.illuminant->Sample(lambda);
        return {*this, GridWalk(majorants_, gridFromRender_, ray, tMax), lambda, unit, SampledSpectrum(1)};
    }

  private:
    /// Lookups are slower than in uniformgrid, so tighter majorants pay.
    static glm::ivec3 CellsOfRgbGrid(const glm::ivec3 &voxels) { return MajorantCells(voxels, 1, 16); }
    Float HighestIn(const std::vector<RgbUnboundedSpectrum> &spectra, const glm::ivec3 &cell) const {
        if (spectra.empty()) return 1;
        return voxels_.MaxIn(cell, [&](size_t i) { return spectra[i].MaxValue(); });
    }
    MediumCoefficients Evaluate(MediumOnRay &onRay, Float t) const override {
        const Point3 p = onRay.Walk().At(t);
        auto multiply = [&](SampledSpectrum &by, const std::vector<RgbUnboundedSpectrum> &spectra) {
            if (!spectra.empty())
                by *= voxels_.Interpolate(p, [&](size_t i) { return spectra[i].Sample(onRay.Lambda()); });
        };
        MediumCoefficients c = onRay.Unit();
        multiply(c.absorption, grids_.absorption);
        multiply(c.scattering, grids_.scattering);
        multiply(c.emission, grids_.emission);
        return c;
    }

    Grids grids_;
    Voxels voxels_;
    MajorantGrid majorants_;
    AffineMap gridFromRender_;
};

}  // namespace pbrt
