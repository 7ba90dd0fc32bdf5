#include "pbrt/media/rgb_grid_medium.h"

#include "pbrt/core/error.h"

namespace pbrt {

namespace {
/// Measured as for uniformgrid. Lookups are slower here, so tighter majorants pay: 16 cells from 8 voxels on, otherwise
/// at most one cell per voxel.
glm::ivec3 CellsOfRgbGrid(const glm::ivec3 &voxels) { return MajorantCells(voxels, 1, 16); }

Float HighestIn(const std::vector<RgbUnboundedSpectrum> &spectra, const Voxels &voxels, const glm::ivec3 &cell) {
    if (spectra.empty()) return 1;
    return voxels.MaxIn(cell, [&](size_t i) { return spectra[i].MaxValue(); });
}
}  // namespace

RgbGridMedium::RgbGridMedium(Float g, const Transform &renderFromMedium, const Bounds3 &bounds, Grids grids)
    : Medium(g, !grids.emission.empty() && grids.emissionScale > 0 && grids.scale > 0), grids_(std::move(grids)),
      voxels_(grids_.count, CellsOfRgbGrid(grids_.count)) {
    for (const auto *grid : {&grids_.absorption, &grids_.scattering, &grids_.emission})
        PBRT_CHECK(grid->empty() || grid->size() == voxels_.Size());
    PBRT_CHECK(grids_.emission.empty() || grids_.illuminant);
    const glm::ivec3 cells = CellsOfRgbGrid(grids_.count);
    majorants_ = MajorantGrid(cells, [&](const glm::ivec3 &cell) {
        return kMajorantSlack * grids_.scale *
               (HighestIn(grids_.absorption, voxels_, cell) + HighestIn(grids_.scattering, voxels_, cell));
    });
    gridFromRender_ =
        AffineMap::ToBox(bounds.low, bounds.high, cells) * AffineMap(glm::dmat4(renderFromMedium.Matrix())).Inverse();
}

size_t RgbGridMedium::Bytes() const {
    const size_t spectra = grids_.absorption.size() + grids_.scattering.size() + grids_.emission.size();
    return sizeof(*this) + majorants_.Bytes() + spectra * sizeof(RgbUnboundedSpectrum);
}

MediumOnRay RgbGridMedium::On(const Ray &ray, Float tMax, const SampledWavelengths &lambda) const {
    MediumCoefficients unit{SampledSpectrum(grids_.scale), SampledSpectrum(grids_.scale), SampledSpectrum(0)};
    if (IsEmissive()) unit.emission = grids_.emissionScale * grids_.illuminant->Sample(lambda);
    return {*this, GridWalk(majorants_, gridFromRender_, ray, tMax), lambda, unit, SampledSpectrum(1)};
}

MediumCoefficients RgbGridMedium::Evaluate(MediumOnRay &onRay, Float t) const {
    const Point3 p = onRay.Walk().At(t);
    auto multiply = [&](SampledSpectrum &by, const std::vector<RgbUnboundedSpectrum> &spectra) {
        if (!spectra.empty()) by *= voxels_.Interpolate(p, [&](size_t i) { return spectra[i].Sample(onRay.Lambda()); });
    };
    MediumCoefficients c = onRay.Unit();
    multiply(c.absorption, grids_.absorption);
    multiply(c.scattering, grids_.scattering);
    multiply(c.emission, grids_.emission);
    return c;
}

}  // namespace pbrt
