#include "pbrt/core/error.h"
#include "pbrt/media/medium_kinds.h"

namespace pbrt {

namespace {

/// Measured by ratio tracking through cubes of 1 to 128^3 voxels, noise and a ball, at optical depths 1 and 8. Of 1 to
/// 32 cells per axis, 1 is fastest in small grids and 4 to 8 in larger ones; stock's 16 take up to twice as long.
glm::ivec3 CellsOfUniformGrid(const glm::ivec3 &voxels) { return MajorantCells(voxels, 4, 8); }
/// Measured as for uniformgrid. Lookups are slower here, so tighter majorants pay: 16 cells from 8 voxels on, otherwise
/// at most one cell per voxel.
glm::ivec3 CellsOfRgbGrid(const glm::ivec3 &voxels) { return MajorantCells(voxels, 1, 16); }

Float HighestIn(const std::vector<RgbUnboundedSpectrum> &spectra, const Voxels &voxels, const glm::ivec3 &cell) {
    if (spectra.empty()) return 1;
    return voxels.MaxIn(cell, [&](size_t i) { return spectra[i].MaxValue(); });
}

}  // namespace

UniformGridMedium::UniformGridMedium(MediumSpectra spectra, Float g, const Transform &renderFromMedium,
                                     const Bounds3 &bounds, Grids grids, const ThermalEmission &thermal)
    : Medium(g, spectra.absorption.MaxValue() > 0 && (spectra.emission.MaxValue() > 0 || !grids.temperature.empty())),
      spectra_(std::move(spectra)), grids_(std::move(grids)), thermal_(thermal),
      voxels_(grids_.count, CellsOfUniformGrid(grids_.count)) {
    PBRT_CHECK(grids_.density.size() == voxels_.Size());
    PBRT_CHECK(grids_.emission.empty() || grids_.emission.size() == voxels_.Size());
    PBRT_CHECK(grids_.temperature.empty() || grids_.temperature.size() == voxels_.Size());
    auto density = [this](size_t i) { return grids_.density[i]; };
    const glm::ivec3 cells = CellsOfUniformGrid(grids_.count);
    majorants_ =
        MajorantGrid(cells, [&](const glm::ivec3 &cell) { return kMajorantSlack * voxels_.MaxIn(cell, density); });
    gridFromRender_ = GridFromRender(renderFromMedium, bounds, cells);
}

size_t UniformGridMedium::Bytes() const {
    const size_t values = grids_.density.size() + grids_.emission.size() + grids_.temperature.size();
    return sizeof(*this) + spectra_.Bytes() + majorants_.Bytes() + values * sizeof(Float);
}

MediumOnRay UniformGridMedium::On(const Ray &ray, Float tMax, const SampledWavelengths &lambda) const {
    const MediumCoefficients unit = spectra_.Sample(lambda);
    return {*this, GridWalk(majorants_, gridFromRender_, ray, tMax), lambda, unit, unit.absorption + unit.scattering};
}

MediumCoefficients UniformGridMedium::Evaluate(MediumOnRay &onRay, Float t) const {
    const Point3 p = onRay.Walk().At(t);
    auto read = [&](const std::vector<Float> &values) {
        return voxels_.Interpolate(p, [&values](size_t i) { return values[i]; });
    };
    const Float density = read(grids_.density);
    const MediumCoefficients &unit = onRay.Unit();
    MediumCoefficients c{unit.absorption * density, unit.scattering * density, unit.emission};
    if (!IsEmissive()) return c;
    if (!grids_.temperature.empty()) c.emission = thermal_.At(read(grids_.temperature), onRay.Lambda());
    if (!grids_.emission.empty()) c.emission *= read(grids_.emission);
    return c;
}

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
    gridFromRender_ = GridFromRender(renderFromMedium, bounds, cells);
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
