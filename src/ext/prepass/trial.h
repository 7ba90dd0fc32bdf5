#pragma once
#include <span>
#include <vector>

#include "pbrt/lightsamplers/light_sampler.h"

namespace ext {
using namespace pbrt;

/// Samples of a pixel in a trial. Blocks of kPerBlock consecutive results are near each other.
struct TrialPixel {
    static constexpr int kPerBlock = 4;
    double mean = 0, variance = 0;  ///< of a sample's radiance, mean over wavelengths
    double paths = 0, vertices = 0, shadowRays = 0;
};

/// False if the integrator has no camera paths (PrepareContext::tracePath), or a trial would take too large a share of
/// the render's samples.
bool CanTrace(const PrepareContext &context);

/// Trial of the light sampler in its present state; CanTrace must hold. Traces two groups of samples of pixels in a
/// regular pattern, about 1.5 % of the render's samples. Observers and the film do not get them, and the statistics do
/// not count them. The result depends on neither threads nor processes, and is empty if cancelled. Same random numbers
/// at every call. One Progress phase, "trial".
std::vector<TrialPixel> TraceTrial(const PrepareContext &context);

/// Result of two trials, of an option relative to its alternative.
struct TrialRatio {
    double error = 0;  ///< relative variance of a sample; 0: there was no trial
    double cost = 0;   ///< of a sample, counted

    bool WasTried() const { return error > 0 && cost > 0; }
    /// Error that the same cost reaches without the option, over that with it.
    double Gain() const { return WasTried() ? 1 / (error * cost) : 0; }
    void Report(auto &report) const {
        report["relativeError"] = error;
        report["relativeCost"] = cost;
        report["gain"] = Gain();
    }
};

/// Compares trials of the same pixels. Relative variance: that of a pixel's samples over the squared mean of its block
/// in both trials plus 1 % of the squared mean of all; the blocks with the largest 1 % are left out, separately for
/// each trial. Cost is counted in path vertices, not timed, so that the choice is reproducible; `extraPerVertex`: what
/// the option adds at each.
TrialRatio CompareTrials(std::span<const TrialPixel> option, std::span<const TrialPixel> alternative,
                         double extraPerVertex);

}  // namespace ext
