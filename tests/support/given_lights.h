#pragma once
#include <span>

#include "pbrt/lights/light_table.h"

namespace pbrt::test {

/// A light that has nothing but what a light sampler weighs: power and bounds, given for each part.
class GivenLight final : public Light {
  public:
    explicit GivenLight(std::vector<LightCandidate> parts)
        : Light(!parts.empty() && parts[0].infinite ? LightKind::DeltaDirection : LightKind::DeltaPosition),
          parts_(std::move(parts)) {}
    explicit GivenLight(const LightCandidate &light) : GivenLight(std::vector{light}) {}
    uint32_t ComponentCount() const override { return uint32_t(parts_.size()); }
    LightPower Phi(const SampledWavelengths &, uint32_t part) const override {
        return {1, SampledSpectrum(parts_[part].power)};
    }
    std::optional<LightLiSample> SampleLi(const LightSampleContext &, const Point2 &, const SampledWavelengths &, bool,
                                          uint32_t) const override {
        return {};
    }
    Float PdfLi(const LightSampleContext &, const Vector3 &, const Point3 &, const Normal3 &, bool,
                uint32_t) const override {
        return 0;
    }
    std::optional<LightLeSample> SampleLe(const Point2 &, const Point2 &, const SampledWavelengths &,
                                          uint32_t) const override {
        return {};
    }
    LightLePdf PdfLe(const Point3 &, const Normal3 &, const Vector3 &, uint32_t) const override { return {}; }
    std::optional<LightBounds> Bounds(uint32_t part) const override { return parts_[part].bounds; }

  private:
    std::vector<LightCandidate> parts_;
};

/// A finished table with a light for each candidate.
inline std::unique_ptr<const LightTable> TableOf(std::span<const LightCandidate> candidates) {
    auto table = std::make_unique<LightTable>();
    for (const LightCandidate &c : candidates) table->Add(std::make_unique<GivenLight>(c));
    table->Finish(Point3(0), 1);
    return table;
}

}  // namespace pbrt::test
