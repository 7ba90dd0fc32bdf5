#pragma once
#include <memory>
#include <span>

#include "ext/groups/emitter.h"
#include "ext/octree/sky_parts.h"
#include "ext/octree/visibility_tree.h"
#include "ext/prepass/prepass.h"
#include "pbrt/lights/sky_windows.h"

namespace ext {

/// Chooses the window through which a sky gets the shadow ray, or the rest of the sky (SkyWindows):
///
///   P(part | x, sky) = (1 - e) G a / sum + e b
///
/// G of a window is the integral of the radiance over what x sees of it, times a mean cosine; of the rest, that of the
/// whole sky. a is how much of G the prepass found in the leaf, from a tree of cells as lamps have it
/// (VisibilityTreeBuilder). b, the floor, gives one half to the rest, and the other half to the windows by G.
class WindowChoice final : public SkyParts {
  public:
    /// `skies`: of lights.Skies(), at most kMaxSkies.
    WindowChoice(const LightTable &lights, std::span<const LightId> skies, Float floor);

    /// Finds windows (FindWindows) and learns where each of them is seen. False: there are none that pay.
    bool Find(PrepareContext &context, std::span<const SkyLook> looks, std::span<const PrepassVertex> vertices);

    size_t Count() const override { return skies_.size(); }
    LightId Sky(size_t k) const override { return lights_.Skies()[skies_[k].index]; }
    std::vector<LightId> PartsOf(size_t k) const override;
    const Weights *Weigh(const LightQuery &query, LightMemory &memory) const override;
    std::optional<SampledLight> Sample(const Weights &weights, size_t k, Point2 *u) const override;
    Float PMF(const Weights &weights, size_t k, LightId light) const override;
    LightId PartTowards(const Weights &weights, size_t k, const Point3 &p, const Vector3 &d) const override;
    void Save(StateWriter &writer, bool goesOn) const override;
    void Load(StateReader &reader) override;
    void Report(nlohmann::ordered_json &report) const override;
    void Inspect(const Point3 &p, std::vector<InspectedValue> &values) const override;
    std::string Describe() const override;
    size_t Bytes() const override;

  private:
    static constexpr size_t kMostParts = SkyWindows::kMost + 1;
    struct OfSky {
        size_t index = 0;   ///< of lights_.Skies()
        Emitter whole;      ///< dark if the whole is never sampled
        Float perMean = 0;  ///< G's units over those of SkyWindows::Integral
        std::shared_ptr<const SkyWindows> windows;
        std::shared_ptr<const uint32_t> set;  ///< see Light::AddWindows
    };
    struct AtVertex : Weights {
        Float part[kMaxSkies][kMostParts];  ///< probabilities given the sky
    };
    size_t PartCount() const { return windows_.size() + 1; }
    LightId PartId(const OfSky &sky, size_t part) const {
        return lights_.TileId(sky.index, SkyPart::FirstOf(*sky.set) + static_cast<uint32_t>(part));
    }
    void Use(std::vector<SkyWindow> windows);
    /// G of the parts of sky k.
    void Evaluate(const LightQuery &query, size_t k, Float *g) const;
    bool Learn(PrepareContext &context, std::span<const PrepassVertex> vertices);

    const LightTable &lights_;
    Float floor_;
    std::vector<SkyWindow> windows_;
    std::vector<OfSky> skies_;
    VisibilityTree tree_;
};

}  // namespace ext
