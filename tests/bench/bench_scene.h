#pragma once
#include <chrono>
#include <cstdio>

#include "ext/prepass/prepass.h"
#include "pbrt/build/built_scene.h"
#include "pbrt/scenefile/parser.h"
#include "plugins.h"

namespace pbrt {

/// Seconds.
inline double Now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// What main returns that does this.
template <class Run>
int ReportingErrors(const Run &run) {
    try {
        return run();
    } catch (const std::exception &e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}

/// A scene read from a file for measuring light samplers in it; nothing is rendered.
class BenchScene {
  public:
    explicit BenchScene(const char *file)
        : description_(ParseSceneFiles({file}, sink_)),
          built(BuildScene(description_, Options(), Registry(), sink_, progress_)) {}

    /// The context that a render would pass to LightSampler::Prepare.
    PrepareContext Context() { return Context(built.seed, built.samplesPerPixel); }
    /// The vertices of about this many camera paths, at most one path a pixel. The seed is not that of Context(), so
    /// these are not the paths of the prepass.
    std::vector<ext::PrepassVertex> Vertices(double paths) {
        PrepareContext context = Context(12345, 1);
        const auto pixels = double(built.film->PixelBounds().Area());
        return ext::TracePrepassPaths(context, std::min(1.0, paths / pixels), 3);
    }

  private:
    PrepareContext Context(int seed, int samplesPerPixel) {
        PrepareContext context = built.Preparation(progress_);
        context.seed = seed;
        context.samplesPerPixel = samplesPerPixel;
        return context;
    }
    const BuildOptions &Options() {
        sink_.ThrowIfErrors();
        options_.film.filename = "bench.exr";  // never written
        options_.lightSampler = "uniform";
        return options_;
    }
    const PluginRegistry &Registry() {
        RegisterPlugins(registry_);
        return registry_;
    }
    DiagnosticSink sink_;
    SceneDescription description_;
    BuildOptions options_;
    PluginRegistry registry_;
    Progress progress_;

  public:
    BuiltScene built;
};

}  // namespace pbrt
