#pragma once
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "pbrt/lab/bias_check.h"

namespace pbrt::lab {

constexpr int kSelectionSide = 4;  ///< regions along a side of the picture

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
SelectionReport JudgeSelection(std::span<const std::vector<VertexFinding>> regions, const BiasSettings &settings);

/// As many paths of equal light would be as good.
double EffectivePaths(std::span<const VertexFinding> region);

nlohmann::ordered_json ToJson(const SelectionReport &report);
SelectionReport SelectionFromJson(const nlohmann::ordered_json &json);

/// What both checks together say: biased if either does; clean if the pictures show nothing and either could have seen
/// a bias of interest; the text says the same.
void AddSelection(const SelectionReport &selection, BiasReport *report);

}  // namespace pbrt::lab
