#pragma once
#include <optional>
#include <span>

#include "pbrt/build/built_scene.h"
#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/lab/bias_check.h"

namespace pbrt::lab {

/// Does a light sampler lose or add light at the vertices of this scene's paths? Pictures are a hard place to see that:
/// their noise is that of the paths as well. selection_check.cpp explains the method.
struct SelectionSettings {
    BiasSettings bias;      ///< it ends when a bias of its `interest` would be seen in half of the regions
    double mostWork = 1e8;  ///< lights drawn in the last round, about (0.05 to 1 us each); it ends there too
    int seed = 0;
};

/// Vertices that have light, of paths through sixteen regions of the picture, and what every light gives there. The
/// same for any number of threads.
class SelectionVertices {
  public:
    struct MeasuredLight {
        uint32_t light = 0;
        Float c = 0;  ///< its contribution by one point on it, times the path's weight; 0 ones are left out
        Float pdf = 0, pBsdf = 0;  ///< of that point, and of BSDF sampling; solid angle
        bool isDelta = false;
        Point3 pLight{};
    };
    struct Vertex {
        LightQuery query;  ///< without BSDF and wavelengths, which are below
        Bsdf bsdf;
        SampledWavelengths lambda;
        std::vector<MeasuredLight> lights;
        bool endsPath = false;
    };
    /// Incomplete if cancelled.
    SelectionVertices(const BuiltScene &built, int seed, Progress &progress);
    const std::vector<Vertex> &OfRegion(size_t region) const { return regions_[region]; }
    size_t RegionCount() const { return regions_.size(); }
    size_t LightCount() const { return lightCount_; }  ///< of the scene
    size_t VertexCount() const;

  private:
    std::vector<std::vector<Vertex>> regions_;
    size_t lightCount_ = 0;
};

/// What next-event estimation would find at one vertex of a path, all times the path's weight.
struct VertexFinding {
    float light = 0;     ///< direct light, all that is measured of it
    float excess = 0;    ///< of the estimate over that; its mean is 0 without bias
    float unjudged = 0;  ///< part of `light` that is left out of `excess`: so rarely chosen that draws say nothing
    bool endsPath = false;
};

struct SelectionReport {
    BiasVerdict verdict = BiasVerdict::Unknown;
    int64_t vertices = 0;                      ///< with light
    int draws = 0;                             ///< at each
    double difference = 0, standardError = 0;  ///< of the whole picture, relative
    double visibleImage = 0;                   ///< smallest bias that would have been seen in 9 of 10 checks
    double visibleSixteenth = 0;               ///< the same in half of the regions that have light
    double unjudged = 0;                       ///< share of the light
    int worstRegion = -1;                      ///< of those with a bias; -1: the whole picture, or none
    double worstDifference = 0;
    std::string text;  ///< a sentence for people
};

/// `regions`: vertices of whole paths, in order. Paths without light need not be there.
SelectionReport JudgeSelection(std::span<const std::vector<VertexFinding>> regions, const SelectionSettings &settings);

/// `lights`, and `gate` if there is one, are prepared. The same for any number of threads. Nothing: cancelled.
std::optional<SelectionReport> CheckSelection(const SelectionVertices &vertices, const LightSampler &lights,
                                              const ShadowRayGate *gate, const SelectionSettings &settings,
                                              Progress &progress);

nlohmann::ordered_json ToJson(const SelectionReport &report);
SelectionReport SelectionFromJson(const nlohmann::ordered_json &json);

/// What both checks together say: biased if either does; clean if the pictures show nothing and either could have seen
/// a bias of interest. Adds to the text.
void AddSelection(const SelectionReport &selection, BiasReport *report);

}  // namespace pbrt::lab
