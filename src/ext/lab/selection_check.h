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

constexpr int kSelectionSide = 4;  ///< regions per side of the image

/// Next-event estimation at one path vertex; all values are multiplied by the path's weight.
struct VertexFinding {
    float light = 0;     ///< all direct light that is measured
    float excess = 0;    ///< of the estimate over its expected value; mean 0 without bias
    float unjudged = 0;  ///< part of `light` excluded from `excess`: selected too rarely for a verdict
    bool endsPath = false;
};

struct SelectionReport {
    BiasVerdict verdict = BiasVerdict::Unknown;
    int64_t vertices = 0;                      ///< that receive light
    int draws = 0;                             ///< per vertex
    double difference = 0, standardError = 0;  ///< of the whole image, relative
    double visibleImage = 0;                   ///< smallest bias detected with probability 0.9
    double visibleSixteenth = 0;               ///< the same, in half of the regions that receive light
    double unjudged = 0;                       ///< fraction of the light
    int worstRegion = -1;                      ///< region of largest bias; -1: the whole image, or no bias
    double worstDifference = 0;
    std::string text;  ///< a sentence for the user
};

/// Evaluates the vertices of whole paths, in order, per region. Paths without light may be omitted.
SelectionReport JudgeSelection(std::span<const std::vector<VertexFinding>> regions, const BiasSettings &settings);

/// Number of paths of equal light with the same noise: (sum of light)^2 / sum of light^2.
double EffectivePaths(std::span<const VertexFinding> region);

Json ToJson(const SelectionReport &report);
SelectionReport SelectionFromJson(const Json &json);

/// Merges the vertex check into the verdict and text of `report`: biased if either check is; clean if the images show
/// no bias and either check could detect a bias of interest.
void AddSelection(const SelectionReport &selection, BiasReport *report);

/// Vertices that receive light, on surfaces and in media, of paths through sixteen image regions, with every light's
/// contribution. Independent of the number of threads.
class SelectionVertices {
  public:
    struct MeasuredLight {
        uint32_t light = 0;
        Float c = 0;               ///< contribution of one point on the light, times the path's weight; positive
        Float pdf = 0, pBsdf = 0;  ///< densities of that point and of scattering towards it (solid angle)
        bool isDelta = false, isInfinite = false;
        Vector3 wi{};  ///< unit, towards the point
    };
    struct Vertex {
        LightQuery query;        ///< without the pointers to scattering and wavelengths, stored below
        Bsdf bsdf;               ///< on a surface
        HenyeyGreenstein phase;  ///< in a medium
        SampledWavelengths lambda;
        std::vector<MeasuredLight> lights;
        bool endsPath = false;

        bool IsInMedium() const { return query.ns == Normal3(0); }
        /// The render's query at this vertex, which it refers to.
        LightQuery FullQuery() const {
            LightQuery full = query;
            full.lambda = &lambda;
            if (IsInMedium()) full.phase = &phase;
            else full.bsdf = &bsdf;
            return full;
        }
    };
    /// Traces the paths and shadow rays. Incomplete if cancelled.
    static SelectionVertices Measure(const BuiltScene &built, int seed, Progress &progress);
    const std::vector<Vertex> &OfRegion(size_t region) const { return regions_[region]; }
    size_t RegionCount() const { return regions_.size(); }
    int PathsPerRegion() const { return paths_; }
    const LightTable &Lights() const { return lights_; }

  private:
    explicit SelectionVertices(const LightTable &lights) : lights_(lights) {}

    std::vector<std::vector<Vertex>> regions_;
    int paths_ = 0;
    const LightTable &lights_;
};

/// Settings of the check for light lost or added by a light sampler at the vertices of this scene's paths. More
/// sensitive than images, which also contain the noise of the paths. Method: selection_check.cpp.
struct SelectionSettings {
    BiasSettings bias;     ///< the check ends when a bias of size `interest` would be detected in half of the regions
    double maxWork = 1e8;  ///< maximum draws per round (0.05 to 1 us each)
    int seed = 0;
};

/// Checks a prepared light sampler, independent of the number of threads. Returns nothing if cancelled.
std::optional<SelectionReport> CheckSelection(const SelectionVertices &vertices, const LightSampler &lights,
                                              const SelectionSettings &settings, Progress &progress);

}  // namespace ext::lab
