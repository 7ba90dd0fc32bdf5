#pragma once
#include "pbrt/lightsamplers/group_light_sampler.h"
#include "pbrt/lightsamplers/light_packet.h"

namespace pbrt {

/// Selects bounded lights in proportion to the importance of their bounds at the query point with the geometric normal;
/// evaluates every light per query. Infinite lights: see InfiniteShare.
class ExhaustiveLightSampler final : public GroupLightSampler {
  public:
    explicit ExhaustiveLightSampler(const LightGroups &groups);
    const void *WeighGroups(const LightQuery &query, LightMemory &memory) const override;
    std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *weights, Float u) const override;
    Float GroupProbability(const LightQuery &query, const void *weights, uint32_t group) const override;
    void Report(nlohmann::ordered_json &json) const override;

  private:
    static constexpr size_t kLanes = 8;
    static constexpr size_t kBlocks = 64;
    /// Sums of importance per block of packets, and total.
    struct Sums {
        double block[kBlocks];
        double total;
        /// Importances in the last packet of each block; all lights if a block is one packet.
        Float lane[kBlocks][kLanes];
    };
    void Importances(size_t packet, const LightQuery &query, Float *out) const;
    /// Importances in a packet: from `sums` if stored there, else recomputed into `scratch`.
    const Float *Lanes(size_t packet, const LightQuery &query, const Sums &sums, Float *scratch) const {
        if (blockSize_ == 1) return sums.lane[packet];
        Importances(packet, query, scratch);
        return scratch;
    }

    std::vector<LightPacket<kLanes>> packets_;
    std::vector<uint32_t> lights_;    ///< group of each lane, over all packets
    std::vector<uint32_t> position_;  ///< lane of each group, or kNever
    static constexpr uint32_t kNever = 0xffffffff;
    size_t blockSize_ = 1;  ///< packets per block
    InfiniteShare infinite_;
};

}  // namespace pbrt
