#pragma once
#include "pbrt/lights/light_bounds.h"
#include "pbrt/lightsamplers/group_light_sampler.h"
#include "pbrt/math/lanes.h"

namespace pbrt {

/// kLanes lights as structure of arrays, with joint importance evaluation. Unset lanes have importance 0.
struct alignas(32) LightPacket {
    static constexpr int kLanes = 8;
    Float centerX[kLanes] = {}, centerY[kLanes] = {}, centerZ[kLanes] = {}, radius[kLanes] = {};
    Float axisX[kLanes] = {}, axisY[kLanes] = {}, axisZ[kLanes] = {}, phi[kLanes] = {};
    Float cosO[kLanes] = {}, sinO[kLanes] = {}, cosE[kLanes] = {};
    Float twoSided[kLanes] = {};  ///< 0 or 1

    void Set(int lane, const LightSphere &s) {
        centerX[lane] = s.center.x;
        centerY[lane] = s.center.y;
        centerZ[lane] = s.center.z;
        radius[lane] = s.radius;
        axisX[lane] = s.w.x;
        axisY[lane] = s.w.y;
        axisZ[lane] = s.w.z;
        phi[lane] = s.phi;
        cosO[lane] = s.cosTheta_o;
        sinO[lane] = detail::SineOf<detail::ScalarOps>(s.cosTheta_o);
        cosE[lane] = s.cosTheta_e;
        twoSided[lane] = s.twoSided ? 1 : 0;
    }

    // noinline: bit-identical results for all call sites.
    [[gnu::noinline]] void Importances(const Point3 &p, const Normal3 &n, Float *out) const {
        using Ops = SimdOps<kLanes>;
        using F = typename Ops::F;
        auto load = [](const Float *v) { return Ops::Load(v); };
        detail::Emitters<F, typename Ops::Mask> e{
            load(centerX), load(centerY), load(centerZ), load(radius), load(axisX), load(axisY),           load(axisZ),
            F(1),          load(phi),     load(cosO),    load(sinO),   load(cosE),  load(twoSided) != F(0)};
        Ops::Store(detail::ImportanceOf<Ops>(e, p, n), out);
    }
};

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
    static constexpr size_t kLanes = LightPacket::kLanes;
    static constexpr size_t kBlocks = 64;
    /// Sums of importance per block of packets, and total.
    struct Sums {
        double block[kBlocks];
        double total;
        /// Importances in the last packet of each block; all lights if a block is one packet.
        Float lane[kBlocks][kLanes];
    };
    /// Importances in a packet: from `sums` if stored there, else recomputed into `scratch`.
    const Float *Lanes(size_t packet, const LightQuery &query, const Sums &sums, Float *scratch) const {
        if (blockSize_ == 1) return sums.lane[packet];
        packets_[packet].Importances(query.p, query.n, scratch);
        return scratch;
    }

    std::vector<LightPacket> packets_;
    std::vector<uint32_t> lights_;    ///< group of each lane, over all packets
    std::vector<uint32_t> position_;  ///< lane of each group, or kNever
    static constexpr uint32_t kNever = 0xffffffff;
    size_t blockSize_ = 1;  ///< packets per block
    InfiniteShare infinite_;
};

}  // namespace pbrt
