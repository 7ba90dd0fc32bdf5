#pragma once
#include "pbrt/core/state_io.h"
#include "pbrt/integrators/wave_renderer.h"
#include "support/build_text.h"
#include "support/render_scene.h"

namespace pbrt::test {

/// Prepares a scene for `samples` per pixel, maybe from what was learned before.
inline void PrepareFor(int samples, const BuiltScene &built, Progress &progress, StateReader *learned = nullptr) {
    PrepareContext context = built.Preparation(progress);
    context.samplesPerPixel = samples;
    context.learned = learned;
    built.integrator->Prepare(context);
}

/// A scene that is prepared and rendered in parts.
struct PartRender {
    BuiltScene built;
    Progress progress;
    RenderSettings settings;
    std::optional<WaveRenderer> renderer;

    PartRender(BuiltScene scene, int samples, StateReader *learned = nullptr) : built(std::move(scene)) {
        PrepareFor(samples, built, progress, learned);
        settings.samplesPerPixel = samples;
        renderer.emplace(built.Rendering(progress), settings);
    }
    void RenderUntil(int samples) {
        while (renderer->Done() < samples) renderer->Render(samples - renderer->Done());
    }
    std::string SavedFilm() const {
        StateWriter writer;
        built.film->Save(writer);
        return writer.Joined();
    }
    void LoadFilm(const std::string &state) {
        StateReader reader(state, "film");
        built.film->Load(reader);
    }
};

/// Prepares a scene and renders it in calls of these sizes, the last one again and again.
inline Image RenderWaves(const BuiltScene &built, int samples, const std::vector<int> &sizes) {
    Progress progress;
    PrepareFor(samples, built, progress);
    RenderSettings settings;
    settings.samplesPerPixel = samples;
    WaveRenderer renderer(built.Rendering(progress), settings);
    for (size_t i = 0; renderer.Done() < samples; ++i) renderer.Render(sizes[std::min(i, sizes.size() - 1)]);
    return built.film->ToImage();
}

}  // namespace pbrt::test
