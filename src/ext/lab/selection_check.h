#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ext/lab/bias_check.h"
#include "ext/lab/text_output.h"
#include "pbrt/build/built_scene.h"
#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/bxdfs/henyey_greenstein.h"

namespace ext::lab {

constexpr int kSelectionSide = 4;  ///< regions along a side of the picture

/// What next-event estimation finds at one vertex of a path; all values are multiplied by the path's weight.
struct VertexFinding {
    float light = 0;     ///< all direct light that is measured
    float excess = 0;    ///< of the estimate over what it should be; its mean is 0 without bias
    float unjudged = 0;  ///< part of `light` left out of `excess`: chosen too rarely for a verdict
    bool endsPath = false;
};

struct SelectionReport {
    BiasVerdict verdict = BiasVerdict::Unknown;
    int64_t vertices = 0;                      ///< that receive light
    int draws = 0;                             ///< per vertex
    double difference = 0, standardError = 0;  ///< of the whole picture, relative
    double visibleImage = 0;                   ///< smallest bias detected in 9 of 10 checks
    double visibleSixteenth = 0;               ///< the same, in half of the regions that receive light
    double unjudged = 0;                       ///< share of the light
    int worstRegion = -1;                      ///< the region with the largest bias; -1: the whole picture, or no bias
    double worstDifference = 0;
    std::string text;  ///< a sentence for the user
};

/// Judges the vertices of whole paths, in order, for every region. Paths without light may be left out.
SelectionReport JudgeSelection(std::span<const std::vector<VertexFinding>> regions, const BiasSettings &settings);

/// Returns the number of paths of equal light with the same noise: (sum of light)^2 / sum of light^2.
double EffectivePaths(std::span<const VertexFinding> region);

Json ToJson(const SelectionReport &report);
SelectionReport SelectionFromJson(const Json &json);

/// Adds the check at vertices to the verdict and the text of `report`: biased if either check says so; clean if the
/// pictures show no bias and either check could have seen a bias of interest.
void AddSelection(const SelectionReport &selection, BiasReport *report);

/// The vertices that receive light, on surfaces and in media, of paths through sixteen regions of the picture, with the
/// contribution of every light. They do not depend on the number of threads.
class SelectionVertices {
  public:
    struct MeasuredLight {
        uint32_t light = 0;
        Float c = 0;               ///< contribution by one point on the light, times the path's weight; above 0
        Float pdf = 0, pBsdf = 0;  ///< densities of that point and of scattering towards it, per solid angle
        bool isDelta = false, isInfinite = false;
        Vector3 wi{};  ///< unit, towards the point
    };
    struct Vertex {
        LightQuery query;        ///< without the pointers to what scatters and to the wavelengths, which are below
        Bsdf bsdf;               ///< on a surface
        HenyeyGreenstein phase;  ///< in a medium
        SampledWavelengths lambda;
        std::vector<MeasuredLight> lights;
        bool endsPath = false;

        bool IsInMedium() const { return query.ns == Normal3(0); }
        /// Returns the complete query of the render; it refers to this vertex.
        LightQuery FullQuery() const {
            LightQuery full = query;
            full.lambda = &lambda;
            if (IsInMedium()) full.phase = &phase;
            else full.bsdf = &bsdf;
            return full;
        }
    };
    /// Incomplete if cancelled.
    SelectionVertices(const BuiltScene &built, int seed, Progress &progress);
    const std::vector<Vertex> &OfRegion(size_t region) const { return regions_[region]; }
    size_t RegionCount() const { return regions_.size(); }
    int PathsPerRegion() const { return paths_; }
    const LightTable &Lights() const { return lights_; }
    size_t VertexCount() const;

  private:
    std::vector<std::vector<Vertex>> regions_;
    int paths_ = 0;
    const LightTable &lights_;
};

/// Settings of the check whether a light sampler loses or adds light at the vertices of this scene's paths. A bias is
/// harder to see in pictures, because these have the noise of the paths as well. selection_check.cpp explains the
/// method.
struct SelectionSettings {
    BiasSettings bias;      ///< the check ends when a bias of size `interest` would be seen in half of the regions
    double mostWork = 1e8;  ///< no further round draws more lights than this (0.05 to 1 us each)
    int seed = 0;
};

/// Checks a prepared light sampler; the result does not depend on the number of threads. Returns nothing if cancelled.
std::optional<SelectionReport> CheckSelection(const SelectionVertices &vertices, const LightSampler &lights,
                                              const SelectionSettings &settings, Progress &progress);

}  // namespace ext::lab
