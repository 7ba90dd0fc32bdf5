#pragma once
#include "pbrt/integrators/wave_renderer.h"
#include "support/build_text.h"
#include "support/render_scene.h"

namespace pbrt::test {

/// Renders a prepared scene in calls of these sizes, the last one again and again.
inline Image RenderWaves(BuiltScene &built, int samples, const std::vector<int> &sizes, Progress &progress) {
    RenderSettings settings;
    settings.samplesPerPixel = samples;
    WaveRenderer renderer(built.Rendering(progress), settings);
    for (size_t i = 0; renderer.Done() < samples; ++i) renderer.Render(sizes[std::min(i, sizes.size() - 1)]);
    return built.film->ToImage();
}

}  // namespace pbrt::test
