#pragma once
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "ext/lab/bias_check.h"

namespace pbrt::lab {

constexpr int kSelectionSide = 4;  ///< regions along a side of the picture

/// What next-event estimation finds at one vertex of a path; all values are multiplied by the path's weight.
struct VertexFinding {
    float light = 0;     ///< all direct light that is measured
    float excess = 0;    ///< of the estimate over what it should be; its mean is 0 without bias
    float unjudged = 0;  ///< part of `light` left out of `excess`: chosen too rarely for the draws to tell
    bool endsPath = false;
};

struct SelectionReport {
    BiasVerdict verdict = BiasVerdict::Unknown;
    int64_t vertices = 0;                      ///< that receive light
    int draws = 0;                             ///< per vertex
    double difference = 0, standardError = 0;  ///< of the whole picture, relative
    double visibleImage = 0;                   ///< smallest bias that would have been seen in 9 of 10 checks
    double visibleSixteenth = 0;               ///< the same, in half of the regions that receive light
    double unjudged = 0;                       ///< share of the light
    int worstRegion = -1;                      ///< the region with the largest bias; -1: the whole picture, or no bias
    double worstDifference = 0;
    std::string text;  ///< a sentence for people
};

/// `regions`: for every region, the vertices of whole paths, in order. Paths without light may be left out.
SelectionReport JudgeSelection(std::span<const std::vector<VertexFinding>> regions, const BiasSettings &settings);

/// The number of paths of equal light that would give the same noise: (sum of light)^2 / sum of light^2.
double EffectivePaths(std::span<const VertexFinding> region);

nlohmann::ordered_json ToJson(const SelectionReport &report);
SelectionReport SelectionFromJson(const nlohmann::ordered_json &json);

/// Adds the check at vertices to the verdict and the text of `report`: biased if either check says so; clean if the
/// pictures show no bias and either check could have seen a bias of interest.
void AddSelection(const SelectionReport &selection, BiasReport *report);

}  // namespace pbrt::lab
