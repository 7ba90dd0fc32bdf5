#pragma once
#include "pbrt/integrators/render_loop.h"

namespace pbrt {

/// Samples per pixel to prepare for (PrepareContext::samplesPerPixel) where a time budget ends the render: as many as
/// take `seconds`, rounded to the nearest 2^(k/4), so that small differences of speed have no effect; at least 1.
int FittingSamples(double seconds, double secondsPerSample);

/// Seconds that a sample of every pixel takes with a prepared integrator that learns nothing. Renders waves of 1, 1, 2,
/// 4 ... samples to the film, without the progress of `context`, for a fiftieth of `seconds`, and takes the fastest;
/// stops at a twentieth, and extrapolates from the pixels that are done if no wave is.
double MeasureSecondsPerSample(const RenderContext &context, RenderSettings settings, double seconds);

}  // namespace pbrt
