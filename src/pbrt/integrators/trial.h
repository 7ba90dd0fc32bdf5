#pragma once
#include <functional>

#include "pbrt/integrators/pixel_integrator.h"

namespace pbrt {

using FollowPath = std::function<SampledSpectrum(const CameraPathStart &, SampledWavelengths &, Sampler &)>;

/// PrepareContext::trial of an integrator whose camera paths `follow` traces: four independent samples of pixels in a
/// regular pattern, about 1.5 % of the render's samples. Their numbers are no pixel sample's, the film does not get
/// them, and the statistics do not count them. Empty if cancelled, or if the render has so few samples that a trial
/// would take more than 3 % of them. The result depends on neither threads nor processes.
std::vector<TrialPixel> TraceTrial(const PrepareContext &context, const FollowPath &follow);

}  // namespace pbrt
