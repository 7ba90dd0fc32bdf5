#include "ext/neepp/neepp_gate.h"

#include <nlohmann/json.hpp>

#include "pbrt/core/effective_params_text.h"

namespace ext {

void NeeppGate::Prepare(PrepareContext &context) { map_.Prepare(context, groups_); }

Float NeeppGate::TraceProbability(const LightQuery &query, LightId light, const Point3 &onLight) const {
    if (!map_.Prepared()) return 1;
    uint32_t target = map_.Targets().Find(map_.Grid(), light, query.p, onLight);
    if (target == LightTargets::None) return 1;
    auto visible = static_cast<Float>(map_.Row(map_.Grid().Index(query.p))[target]);
    return std::max(params_.minimum, visible / static_cast<Float>(map_.Samples()));
}

void NeeppGate::Report(nlohmann::ordered_json &report) const {
    report["parameters"] = EffectiveParamsText(params_);
    map_.Report(report);
}

}  // namespace ext
