#pragma once
#include <nlohmann/json_fwd.hpp>

#include "pbrt/core/factory_table.h"
#include "pbrt/core/online_model.h"
#include "pbrt/integrators/camera_path.h"

namespace pbrt {

/// Extension point: learned directions and continuation probabilities of camera paths, instead of BSDF sampling and
/// throughput. It traces whole paths, so that its policy can be a type (CameraPath).
class DirectionSampling : public OnlineModel {
  public:
    /// Called after the light sampler's Prepare. `maxDepth`: of the integrator.
    virtual void Prepare(PrepareContext &prepare, int maxDepth) = 0;
    /// Radiance along a camera ray, by CameraPath with its own directions.
    virtual SampledSpectrum Li(const CameraPathSetup &setup, const CameraPathStart &start, SampledWavelengths &lambda,
                               Sampler &sampler) = 0;
    /// Saves model and records for a checkpoint, excluding the light sampler's. Without `withLearning`: the model for
    /// other renders, whose camera or resolution may differ; those do not update it.
    virtual void SaveLearned(StateWriter &out, bool withLearning) const = 0;
    /// Sizes, times and gain, for --stats and image metadata.
    virtual void Report(nlohmann::ordered_json &json) const = 0;
    /// Model state at a vertex of a path of `pixel`, for visualization.
    virtual void Inspect(const PathVertex &vertex, Point2i pixel, std::vector<InspectedValue> &values) const = 0;
};

struct DirectionRequest {
    /// False: neither scene nor command line requests it, but the light sampler does (LightSampler::LearnsRoulette).
    /// Then makers return roulette with BSDF directions, or null if the parameters switch that off.
    bool isGuided;
};

/// DirectionSampling implementations by name. Their parameters are "name.key" of the integrator.
using DirectionSamplings = FactoryTable<std::unique_ptr<DirectionSampling>, const DirectionRequest>;

}  // namespace pbrt
