#include "pbrt/lights/light_table.h"

#include "pbrt/lights/environment_light.h"

namespace pbrt {

Float LightBounds::Importance(const Point3 &p, const Normal3 &n) const { return Sphere().Importance(p, n); }

LightBounds Union(const LightBounds &a, const LightBounds &b) {
    const bool neutralA = !(a.phi > 0), neutralB = !(b.phi > 0);
    if (neutralA || neutralB) return neutralA ? b : a;
    auto normals = [](const LightBounds &light) { return DirectionCone{light.w, light.cosTheta_o}; };
    const DirectionCone joint = Union(normals(a), normals(b));
    return {.bounds = Union(a.bounds, b.bounds),
            .w = joint.w,
            .phi = a.phi + b.phi,
            .cosTheta_o = joint.cosTheta,
            .cosTheta_e = std::min(a.cosTheta_e, b.cosTheta_e),  // wider falloff
            .twoSided = a.twoSided || b.twoSided};
}

void LightTable::Finish(const Point3 &sceneCenter, Float sceneRadius, const Bounds3 &receivers) {
    constexpr double kMinShare = 1e-30;  // minimum power of an emitting light, relative to the maximum
    constexpr double kMaxPower = 1e100;  // image sums stay finite
    PBRT_CHECK(!byComponent_);
    receivers_ = receivers;
    for (const Entry &entry : lights_) entry.light->Preprocess(sceneCenter, sceneRadius);
    std::vector<double> power(Size());
    double minPower = kMaxPower, maxPower = 0;
    for (uint32_t i = 0; i < Size(); ++i) {
        const double phi = (*this)[LightId(i)].Phi(SampledWavelengths::WholeRange()).Average();
        if (!(phi > 0)) continue;
        power[i] = std::min(phi, kMaxPower);
        minPower = std::min(minPower, power[i]);
        maxPower = std::max(maxPower, power[i]);
    }
    if (maxPower > 0) {
        const double radius = sceneRadius > 0 ? double(sceneRadius) : 1;
        unit_ = std::exp2(std::round(std::log2(std::max(minPower, kMinShare * maxPower)) / 2 + std::log2(maxPower) / 2 -
                                     std::log2(radius)));
    }
    power_.resize(Size());
    for (uint32_t i = 0; i < Size(); ++i)
        power_[i] = Float(power[i] > 0 ? std::max(power[i], kMinShare * maxPower) / unit_ : 0);
    for (LightId id : infinite_)
        if (const EnvironmentLight *light = (*this)[id].Parent().AsEnvironment(); light && !light->Opening())
            environments_.push_back(id);
    byComponent_ = std::make_unique<LightGroups>(*this, false);
    byLight_ = std::make_unique<LightGroups>(*this, true);
}

double LightTable::RadiiFromReceivers(const LightCandidate &candidate) const {
    if (!candidate.bounds || receivers_.IsEmpty()) return 0;
    const LightBounds &light = *candidate.bounds;
    const double radius = glm::length(glm::dvec3(receivers_.Diagonal())) / 2;
    const double distance = glm::length(glm::dvec3(light.Centroid()) - glm::dvec3(receivers_.Center())) -
                            glm::length(glm::dvec3(light.bounds.Diagonal())) / 2;
    return radius > 0 ? distance / radius : 0;
}

std::optional<LightId> LightTable::FirstTooFarForLightPaths() const {
    constexpr double kRadii = 0x1p20;  // here a direction's rounding is a sixteenth of the receivers' radius
    for (uint32_t i = 0; i < Size(); ++i)
        if (power_[i] > 0 && RadiiFromReceivers(Candidate(LightId(i))) > kRadii) return LightId(i);
    return {};
}

Float LightTable::PowerTowardsReceivers(const LightCandidate &candidate) const {
    const double radii = RadiiFromReceivers(candidate);
    constexpr double kNear = 2;
    if (!(radii > kNear)) return candidate.power;
    const LightBounds &light = *candidate.bounds;
    // Fractions of the sphere that the receivers cover, relative to that at the distance kNear, and that is lit.
    auto fraction = [](double sine) { return sine * sine / (2 * (1 + std::sqrt(1 - sine * sine))); };
    const double covered = fraction(1 / radii) / fraction(1 / kNear);
    const double edge = std::acos(std::clamp(double(light.cosTheta_o), -1.0, 1.0)) +
                        std::acos(std::clamp(double(light.cosTheta_e), -1.0, 1.0));
    const double lit = edge < std::numbers::pi ? (1 - std::cos(edge)) / 2 * (light.twoSided ? 2 : 1) : 1.0;
    // Beams aimed at the receivers keep their power.
    const double share = lit > covered ? covered / std::min(lit, 1.0) : 1.0;
    return std::max(Float(double(candidate.power) * std::min(share, 1.0)),
                    candidate.power > 0 ? std::numeric_limits<Float>::min() : Float(0));
}

LightGroups::LightGroups(const LightTable &lights, bool byLight) : lights_(lights), lightCount_(lights.Size()) {
    if (!byLight || lights.LightCount() == lights.Size()) return;
    const auto n = uint32_t(lights.Size());
    share_.resize(n);
    cdf_.resize(n);
    std::vector<double> powers;  // of the group's components
    for (uint32_t i = 0, end = 0; i < n; i = end) {
        LightCandidate group;
        double power = 0;
        powers.clear();
        for (end = i; end < n && lights.LightOf(LightId(end)) == lights.LightOf(LightId(i)); ++end) {
            const LightCandidate component = lights.Candidate(LightId(end));
            powers.push_back(double(component.power));
            power += powers.back();
            group.infinite = component.infinite;
            if (component.bounds)
                group.bounds = group.bounds ? Union(*group.bounds, *component.bounds) : *component.bounds;
        }
        group.power = Float(power);
        double running = 0;
        for (uint32_t k = i; k < end; ++k) {
            const double share = power > 0 ? powers[k - i] / power : 1.0 / double(end - i);
            running += share;
            share_[k] = Float(share);
            cdf_[k] = Float(running);
        }
        first_.push_back(i);
        candidates_.push_back(group);
    }
    first_.push_back(n);
}

LightCandidate LightGroups::Candidate(uint32_t group) const {
    return candidates_.empty() ? lights_.Candidate(LightId(group)) : candidates_[group];
}

uint32_t LightGroups::LightOf(LightId light) const { return lights_.LightOf(light); }

LightId LightGroups::SampleWithin(uint32_t group, Float u) const {
    const uint32_t begin = FirstOf(group), end = begin + CountOf(group);
    if (end - begin == 1) return LightId(begin);
    auto it = std::upper_bound(cdf_.begin() + begin, cdf_.begin() + end, u);
    auto index = uint32_t(it - cdf_.begin());
    if (index == end) {  // rounding left the last sum below 1: use the last light with a share
        index = end - 1;
        while (index > begin && share_[index] == 0) --index;
    }
    return LightId(index);
}

}  // namespace pbrt
