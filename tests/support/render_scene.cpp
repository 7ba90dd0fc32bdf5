#include "support/render_scene.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "pbrt/integrators/render_loop.h"
#include "pbrt/scenefile/parser.h"
#include "support/build_text.h"
#include "support/param.h"
#include "support/parse_text.h"

namespace pbrt::test {

namespace {

Rendered Render(SceneDescription description, const BuildOptions &options, bool floatFilm, DiagnosticSink &sink) {
    sink.ThrowIfErrors();
    if (floatFilm) description.film.params.Add(BoolParam("savefp16", false));
    Progress progress;
    BuiltScene built = BuildScene(description, options, AllSamplers(), sink, progress);
    built.Prepare(progress);
    RenderResult result = RenderWaves(built.Rendering(progress), built.Settings());
    Rendered out;
    out.image = built.film->ToImage();
    out.seconds = result.seconds;
    for (const SideImage &side : built.integrator->SideImages())
        out.sideImages.emplace_back(side.name, side.film->ToImage());
    out.diagnostics = sink.All();
    if (built.integrator->Lights()) built.integrator->Lights()->Report(out.lightReport);
    return out;
}

}  // namespace

Rendered RenderScene(const RenderRequest &request) {
    DiagnosticSink sink;
    SceneDescription description = ParseSceneFiles({request.file}, sink);
    return Render(std::move(description), request.build, request.floatFilm, sink);
}

Rendered RenderText(const std::string &text, const BuildOptions &options) {
    DiagnosticSink sink;
    SceneDescription description = ParseSceneText(text, sink);
    return Render(std::move(description), options, true, sink);
}

std::vector<double> TileMeans(const Image &image, int size) {
    Point2i r = image.Resolution();
    std::vector<double> means;
    for (int ty = 0; ty < r.y; ty += size)
        for (int tx = 0; tx < r.x; tx += size)
            for (int c = 0; c < 3; ++c) {
                double sum = 0;
                int n = 0;
                for (int y = ty; y < std::min(ty + size, r.y); ++y)
                    for (int x = tx; x < std::min(tx + size, r.x); ++x, ++n) sum += double(image.Get({x, y}, c));
                means.push_back(sum / n);
            }
    return means;
}

RunningStatistics ChannelStatistics(const Image &image, int channel) {
    RunningStatistics s;
    ForEachPixel(image, [&](Point2i p) { s.Add(double(image.Get(p, channel))); });
    return s;
}

RunningStatistics MeansOverSeeds(const std::string &text) {
    RunningStatistics s;
    for (int seed = 1; seed <= 8; ++seed) {
        BuildOptions options;
        options.seed = seed;
        s.Add(ChannelStatistics(RenderText(text, options).image).mean);
    }
    return s;
}

bool SameBits(const Image &a, const Image &b) {
    return a.Bytes() == b.Bytes() && std::memcmp(a.Data(), b.Data(), a.Bytes()) == 0;
}

std::string RealScenes() {
    const char *variable = std::getenv("PBRT_REAL_SCENES");
    std::string folder = variable ? variable : std::string(PBRT_SOURCE_DIR) + "/../shared/scenes";
    if (std::filesystem::exists(folder + "/lamp/lamp.pbrt")) return folder + "/";
    std::printf("\n*** SKIPPED: real scenes not found in %s (set PBRT_REAL_SCENES) ***\n\n", folder.c_str());
    return "";
}

}  // namespace pbrt::test
