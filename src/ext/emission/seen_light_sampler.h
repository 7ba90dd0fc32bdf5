#pragma once
#include "ext/emission/seen_light.h"
#include "ext/emission/seen_params.h"
#include "pbrt/math/distributions.h"

namespace ext {

/// Chooses lights with the same probabilities everywhere: the share `floor` by power, the rest in proportion to
/// sqrt(seen power), where `seen` is what the picture gets of a light, relative to its brightness there
/// (FindSeenLight).
///
/// Why the root: a light of power Phi that begins light paths with probability p gives each of them the power Phi / p.
/// A part of about I / Phi of them is seen in the picture, which gets I of it. The second moment of what a path brings
/// is then about Phi I / p, and over all lights its sum is least where p is in proportion to sqrt(Phi I).
///
/// Of lights that were seen once, as many again are there that were not seen at all, as a rule: the share of light that
/// the prepass missed is about the number of lights found by a single sample over the number of samples (Good 1953).
/// That share of `seen` is spread by power. A group without power has probability 0, as with "power".
///
/// Before Prepare, and if the prepass found nothing, lights are chosen by power.
class SeenLightSampler final : public GroupLightSampler {
  public:
    SeenLightSampler(const LightTable &lights, const SeenParams &params);
    void Prepare(PrepareContext &context) override;
    std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *weights, Float u) const override;
    Float GroupProbability(const LightQuery &query, const void *weights, uint32_t group) const override;
    void Report(nlohmann::ordered_json &json) const override;
    void Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const override;

    /// Of all groups, what Prepare found; empty before.
    const std::vector<SeenLight> &Seen() const { return seen_; }

  private:
    SeenParams params_;
    std::vector<SeenLight> seen_;
    AliasTable table_;
    double missed_ = 1, prepassSeconds_ = 0;
    size_t groupsSeen_ = 0;
};

}  // namespace ext
