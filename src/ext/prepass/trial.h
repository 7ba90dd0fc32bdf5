#pragma once
#include <nlohmann/json_fwd.hpp>
#include <span>

#include "pbrt/lightsamplers/light_sampler.h"

namespace ext {
using namespace pbrt;

/// Result of two trials, of an option relative to its alternative.
struct TrialRatio {
    double error = 0;  ///< relative variance of a sample; 0: there was no trial
    double cost = 0;   ///< of a sample, counted

    bool WasTried() const { return error > 0 && cost > 0; }
    /// Error that the same cost reaches without the option, over that with it.
    double Gain() const { return WasTried() ? 1 / (error * cost) : 0; }
    void Report(nlohmann::ordered_json &report) const;
};

/// Compares trials of the same pixels. Relative variance: that of a pixel's samples over the squared mean of its block
/// in both trials plus 1 % of the squared mean of all; the blocks with the largest 1 % are left out, separately for
/// each trial. Cost is counted in path vertices, not timed, so that the choice is reproducible; `extraPerVertex`: what
/// the option adds at each.
TrialRatio CompareTrials(std::span<const TrialPixel> option, std::span<const TrialPixel> alternative,
                         double extraPerVertex);

}  // namespace ext
