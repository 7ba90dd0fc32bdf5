#pragma once
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ext/groups/emitter.h"
#include "ext/octree/visibility_tree.h"
#include "ext/octree/window_search.h"
#include "ext/prepass/prepass.h"
#include "pbrt/core/state_io.h"
#include "pbrt/lights/sky_light.h"

namespace ext {

/// The rays of TraceSkyRays from a vertex to each sky, if there are many vertices.
inline constexpr size_t kSkyRaysPerVertex = 16;
/// Rays towards the skies from `count` of the vertices (at most all), spread over the picture. Their directions follow
/// the light that would arrive unoccluded: radiance times cosine. Depends on the seed only.
std::vector<SkyRay> TraceSkyRays(PrepareContext &context, std::span<const LightId> skies,
                                 std::span<const PrepassVertex> vertices, size_t count);

/// Chooses the window through which a sky gets the shadow ray, or the rest of the sky (SkyWindows):
///
///   P(part | x, sky) = (1 - e) G a / sum + e b
///
/// G of a window is the integral of the radiance over what x sees of it, times a mean cosine; of the rest, that of the
/// whole sky. a is how much of G the prepass found in the leaf, from a tree of cells as lamps have it
/// (VisibilityTreeBuilder). b, the floor, gives one half to the rest, and the other half to the windows by G.
class WindowChoice {
  public:
    /// At most so many skies are divided.
    static constexpr size_t kMaxSkies = 4;
    static constexpr size_t kMaxParts = SkyWindows::kMax + 1;

    /// The first kMaxSkies skies that are not black.
    static std::vector<LightId> SkiesOf(const LightTable &lights);
    /// `skies`: some of SkiesOf(lights).
    WindowChoice(const LightTable &lights, std::span<const LightId> skies, Float floor);

    /// Finds windows (FindWindows) and learns where each of them is seen. False: there are none that pay.
    bool Find(PrepareContext &context, std::span<const SkyRay> rays, std::span<const PrepassVertex> vertices);

    size_t Count() const { return skies_.size(); }
    /// All parts of sky k.
    std::vector<LightId> PartsOf(size_t k) const;
    /// What is known of the skies at a vertex.
    struct Weights {
        /// Of each sky the sums over its parts, for the choice among skies and lamps: of G, the light that would arrive
        /// unoccluded, and of G a.
        Float g[kMaxSkies], w[kMaxSkies];
        Float part[kMaxSkies][kMaxParts];  ///< probabilities given the sky
    };
    const Weights *Weigh(const LightQuery &query, LightMemory &memory) const;
    /// A part of sky k and its probability given the sky. `u`: uniform on the unit square; what is left of it for the
    /// point in the part is uniform again.
    std::optional<SampledLight> Sample(const Weights &weights, size_t k, Point2 *u) const;
    /// `light`: a part of sky k, or the whole, which is never chosen.
    Float PMF(const Weights &weights, size_t k, LightId light) const;
    /// See LightDistribution::PartTowards.
    LightId PartTowards(size_t k, const Point3 &p, const Vector3 &d) const {
        return PartId(skies_[k], skies_[k].windows->PartTowards(p, d));
    }
    void Save(StateWriter &writer) const;
    void Load(StateReader &reader);
    void Report(nlohmann::ordered_json &report) const;
    /// What is known at the point.
    void Inspect(const Point3 &p, std::vector<InspectedValue> &values) const;
    /// The windows, as lines of text.
    std::string Describe() const;
    size_t Bytes() const;

  private:
    struct OfSky {
        size_t index = 0;   ///< of lights_.Skies()
        Emitter whole;      ///< dark if the whole is never sampled
        Float perMean = 0;  ///< G's units over those of SkyWindows::Integral
        std::shared_ptr<const SkyWindows> windows;
        std::shared_ptr<const uint32_t> set;  ///< see SkyLight::AddWindows
    };
    size_t PartCount() const { return windows_.size() + 1; }
    LightId PartId(const OfSky &sky, size_t part) const {
        return lights_.SkyPartId(sky.index, SkyPart::FirstOf(*sky.set) + static_cast<uint32_t>(part));
    }
    const SkyLight &LightOf(const OfSky &sky) const { return *lights_[lights_.Skies()[sky.index]].Whole().AsSky(); }
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
