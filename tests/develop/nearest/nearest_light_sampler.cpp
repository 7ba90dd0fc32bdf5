#include "nearest_light_sampler.h"

#include "pbrt/lightsamplers/weighted_choice.h"

using namespace pbrt;

namespace {
/// What is weighed at one vertex. `of` points into the same memory.
struct Weights {
    Float sum = 0;
    Float *of = nullptr;  ///< per group
};
}  // namespace

NearestLightSampler::NearestLightSampler(const LightGroups &groups) : GroupLightSampler(groups) {
    for (const LightCandidate &group : groups.Candidates()) {
        Place place;
        place.isFar = group.infinite;
        place.isDark = !(group.power > 0);
        if (group.bounds) {
            const LightSphere sphere = group.bounds->Sphere();
            place.center = sphere.center;
            place.radius = sphere.radius;
        }
        places_.push_back(place);
    }
}

const void *NearestLightSampler::WeighGroups(const LightQuery &query, LightMemory &memory) const {
    auto *weights = memory.Make<Weights>();
    weights->of = memory.Make<Float>(places_.size());
    for (size_t g = 0; g < places_.size(); ++g) {
        const Place &place = places_[g];
        const Float distance2 = place.isFar ? 1 : std::max(DistanceSquared(query.p, place.center), Sqr(place.radius));
        weights->of[g] = place.isDark ? 0 : 1 / std::clamp(distance2, Float(1e-12), Float(1e12));
        weights->sum += weights->of[g];
    }
    return weights;
}

std::optional<NearestLightSampler::ChosenGroup> NearestLightSampler::ChooseGroup(const LightQuery &query,
                                                                                 const void *weights, Float u) const {
    const Weights &w = *static_cast<const Weights *>(weights);
    const auto chosen = ChooseByWeight<Float>(places_.size(), u * w.sum, [&](uint32_t g) { return w.of[g]; });
    if (!chosen) return {};
    return ChosenGroup{chosen.index, chosen.weight / w.sum, InnerNumber(query, u)};
}

Float NearestLightSampler::GroupProbability(const LightQuery &, const void *weights, uint32_t group) const {
    const Weights &w = *static_cast<const Weights *>(weights);
    return w.sum > 0 ? w.of[group] / w.sum : 0;
}

void register_nearest(PluginRegistry &registry) {
    registry.samplers.Add<NoParams>("nearest", "By the inverse square of the distance.",
                                    [](NoParams, const ParamSet &, const LightGroups &groups) {
                                        return std::make_unique<NearestLightSampler>(groups);
                                    },
                                    {.takesGroups = true});
}
