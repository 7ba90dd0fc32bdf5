#pragma once
#include <string>

#include "pbrt/build/built_scene.h"
#include "render/agreement_statistics.h"

namespace pbrt::test {

/// The ways to find direct light that must have one mean.
enum class Estimator {
    Bsdf,    ///< simplepath without light sampling: rays alone
    Lights,  ///< simplepath with light sampling
    Chosen,  ///< light sampling alone, lights chosen by a light sampler
    Both     ///< path: BSDF and light sampling combined
};

/// Densities that a test spoils: factors on those of every light but the first of the scene.
struct Spoilt {
    Float ofSamples = 1;  ///< what comes with a light sample
    Float ofRays = 1;     ///< what the weight of a ray that hits the light is made of
};

/// Renders of one built scene. The film's size and the depth are the scene's. Of scenes of direct light alone (depth 1)
/// the lamps that the camera sees are left out.
class Studio {
  public:
    explicit Studio(BuiltScene built) : built_(std::move(built)) {}

    /// `lightSampler` ("name", "name:key=value" or either with "+mesh"): for Chosen and Both.
    PixelStatistics Render(Estimator estimator, const std::string &lightSampler, int samplesPerPixel, int runs,
                           int firstSeed, const Spoilt &spoilt = {}) const;

  private:
    BuiltScene built_;
};

}  // namespace pbrt::test
