#pragma once
#include <nlohmann/json_fwd.hpp>

#include "pbrt/core/factory_table.h"
#include "pbrt/core/online_model.h"
#include "pbrt/integrators/camera_path.h"

namespace pbrt {

/// Extension point: chooses directions and continuation probabilities of camera paths from records of the render, in
/// place of BSDF and throughput alone. It follows whole paths, so that its policy can be a type (CameraPath).
class DirectionSampling : public OnlineModel {
  public:
    /// After the light sampler's. `maxDepth`: of the integrator.
    virtual void Prepare(PrepareContext &prepare, int maxDepth) = 0;
    /// The radiance along a camera ray, by CameraPath with directions of its own.
    virtual SampledSpectrum Li(const CameraPathSetup &setup, const PathStart &start, SampledWavelengths &lambda,
                               Sampler &sampler) = 0;
    /// Model and records for a checkpoint, without those of the light sampler.
    virtual void Save(StateWriter &out) const = 0;
    /// The model for other renders, with another camera or resolution, which do not update it.
    virtual void SaveForOthers(StateWriter &out) const = 0;
    /// Sizes, times and what is gained, for --stats and image metadata.
    virtual void Report(nlohmann::ordered_json &json) const = 0;
    /// The model at a vertex, for pictures. `pixel`: whose path it is.
    virtual void Inspect(const PathVertex &vertex, Point2i pixel, std::vector<InspectedValue> &values) const = 0;
};

/// The kinds of DirectionSampling by name. Their parameters are "name.key" of the integrator.
using DirectionSamplings = FactoryTable<std::unique_ptr<DirectionSampling>, const Scene>;

}  // namespace pbrt
