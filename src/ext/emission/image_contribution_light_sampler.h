#pragma once
#include <vector>

#include "pbrt/core/describe.h"
#include "pbrt/lightsamplers/simple_light_samplers.h"

namespace ext {
using namespace pbrt;

struct ImageContribution {
    /// Sum of the contributions of camera paths with a non-specular vertex, over the squared relative brightness: 0.1
    /// plus the mean of a 16 x 16 pixel tile over the image mean.
    double sum = 0;
    int count = 0;  ///< number of non-zero contributions
};

struct ImageContributionParams {
    Float floor = 0.25f;
    Float budget = 0.01f;
    bool meshlights = true;

    void Describe(auto &&v) {
        v("floor", floor, Range<Float>{0.01f, 1.f}, "part of the probability given by power alone");
        v("budget", budget, Range<Float>{1e-4f, 1.f},
          "paths of the prepass as a part of the render's; from 8,192 to about a million");
        v("meshlights", meshlights,
          "an emissive mesh is one light; inside it a triangle is chosen in proportion to power");
    }
};

/// Selects lights with position-independent probabilities: a fraction `floor` by power, the rest in proportion to
/// sqrt(power * image contribution), relative to image brightness (EstimateImageContributions).
///
/// The square root: a light of power Phi that emits light paths with probability p gives each the power Phi / p. About
/// I / Phi of them reach the image, which receives I. The second moment of a path's contribution is then about Phi I /
/// p. Its sum over all lights is minimal for p proportional to sqrt(Phi I).
///
/// The contribution of unsampled lights is about the number of lights sampled once over the number of samples (Good
/// 1953); it is distributed by power. A group without power has probability 0, as with "power".
///
/// Before Prepare, and without prepass samples, selection is by power.
class ImageContributionLightSampler final : public PowerLightSampler {
  public:
    ImageContributionLightSampler(const LightTable &lights, const ImageContributionParams &params);
    void Prepare(PrepareContext &context) override;
    void Report(nlohmann::ordered_json &json) const override;
    void Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const override;

    /// Per group; empty before Prepare.
    const std::vector<ImageContribution> &Contributions() const { return contributions_; }

  private:
    ImageContributionParams params_;
    std::vector<ImageContribution> contributions_;
    double missed_ = 1, prepassSeconds_ = 0;
    size_t contributingGroups_ = 0;
};

}  // namespace ext
