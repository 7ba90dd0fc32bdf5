#pragma once
#include "pbrt/lightsamplers/infinite_share.h"

namespace pbrt {

/// Bounded lights in proportion to the importance of their own bounds at the query point with the geometric normal, all
/// of them looked at for every sample. Infinite lights as InfiniteShare says.
class ExhaustiveLightSampler final : public LightSampler {
  public:
    explicit ExhaustiveLightSampler(std::span<const LightCandidate> candidates);
    std::optional<SampledLight> Sample(const LightQuery &query, Float u) const override;
    Float PMF(const LightQuery &query, LightId light) const override;
    void Report(nlohmann::ordered_json &json) const override;

  private:
    /// Sums of importance over consecutive blocks of lights and over all. On the stack: no allocation per sample.
    static constexpr size_t kBlocks = 128;
    struct Sums {
        double block[kBlocks];
        double total;
    };
    void AddUp(const LightQuery &query, Sums *sums) const;
    Float Importance(size_t i, const LightQuery &query) const;

    std::vector<LightSphere> bounded_;
    std::vector<uint32_t> lights_;     ///< of bounded_
    std::vector<uint32_t> position_;   ///< in bounded_, by light; or one of the two below
    static constexpr uint32_t kInfinite = 0xffffffff, kNever = 0xfffffffe;
    size_t blockSize_ = 1;
    InfiniteShare infinite_;
};

}  // namespace pbrt
