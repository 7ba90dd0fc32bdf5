// Error and cost of light samplers on one scene, as Markdown tables. Not a test: it measures.
//   light_sampler_table error scene.pbrt [--samplers uniform,power,bvh,octree] [--spp 16] [--seeds 4] [--maxdepth n]
//                       [--divisor 4] [--reference-spp 2048]
//   light_sampler_table cost  scene.pbrt [--samplers ...] [--spp 4] [--rounds 6] [--divisor 1]
// A sampler is written as for --lightsampler; "bvh+mesh" groups meshes. The reference comes from stock's bvh over single
// triangles with a seed of its own. Costs are CPU seconds of the whole process, measured round by round (A B C A B C ...)
// so that a slow minute of the machine hits all alike; ratios are medians of rounds.
#include <fmt/format.h>

#include <ctime>
#include <sstream>

#include "pbrt/core/parallel.h"
#include "pbrt/images/metrics.h"
#include "pbrt/integrators/render_loop.h"
#include "support/build_text.h"
#include "support/render_scene.h"
#include "support/statistics.h"

namespace {

using namespace pbrt;
using namespace pbrt::test;

struct Arguments {
    std::string mode, scene;
    std::vector<std::string> samplers = {"uniform", "power", "bvh", "uniform+mesh", "power+mesh", "bvh+mesh", "octree"};
    int spp = 0, seeds = 4, maxDepth = -1, divisor = 4, referenceSpp = 2048, rounds = 6;
};

std::vector<std::string> Split(const std::string &text) {
    std::vector<std::string> parts;
    std::istringstream in(text);
    // ';' separates samplers that have several keys; ',' does for plain names.
    char separator = text.find(';') != std::string::npos ? ';' : ',';
    for (std::string part; std::getline(in, part, separator);) parts.push_back(part);
    return parts;
}

BuildOptions OptionsFor(const Arguments &a, const std::string &sampler) {
    BuildOptions o;
    const std::string suffix = "+mesh";
    bool mesh = sampler.size() > suffix.size() && sampler.ends_with(suffix);
    o.lightSampler = mesh ? sampler.substr(0, sampler.size() - suffix.size()) : sampler;
    o.meshLights = mesh;
    o.film.resolutionDivisor = a.divisor;
    o.samplesPerPixel = a.spp;
    if (a.maxDepth >= 0) o.maxDepth = a.maxDepth;
    return o;
}

int ErrorTable(const Arguments &a) {
    RenderRequest request{a.scene, OptionsFor(a, "bvh"), true};
    request.build.samplesPerPixel = a.referenceSpp;
    request.build.seed = 1000001;
    Image reference = RenderScene(request).image;
    fmt::print("| sampler | relL2 | standard error | relative to uniform |\n|---|---|---|---|\n");
    double uniform = 0;
    for (const std::string &sampler : a.samplers) {
        RunningStatistics error;
        for (int seed = 0; seed < a.seeds; ++seed) {
            RenderRequest r{a.scene, OptionsFor(a, sampler), true};
            r.build.seed = seed + 1;
            error.Add(ImageError(RenderScene(r).image, reference, Metric::RelL2));
        }
        if (uniform == 0) uniform = error.mean;
        fmt::print("| {} | {:.5f} | {:.5f} | {:.3f} |\n", sampler, error.mean, error.StandardError(), error.mean / uniform);
        std::fflush(stdout);
    }
    fmt::print("\n{} samples per pixel, {} seeds; reference: bvh, {} samples per pixel, its own noise is part of every figure.\n", a.spp, a.seeds,
               a.referenceSpp);
    return 0;
}

double CpuSeconds() {
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double Median(std::vector<double> v) {
    std::sort(v.begin(), v.end());
    size_t n = v.size();
    return n % 2 ? v[n / 2] : (v[n / 2 - 1] + v[n / 2]) / 2;
}

int CostTable(const Arguments &a) {
    struct Run {
        BuiltScene built;
        double prepare = 0;
        std::vector<double> seconds;
    };
    std::vector<Run> runs(a.samplers.size());
    Progress progress;
    for (size_t i = 0; i < runs.size(); ++i) {
        runs[i].built = BuildFile(a.scene, OptionsFor(a, a.samplers[i]));
        BuiltScene &b = runs[i].built;
        PrepareContext prepare{*b.scene, *b.camera, *b.filter, b.film->PixelBounds(), b.seed, b.samplesPerPixel, b.maxDepth, progress};
        double start = CpuSeconds();
        b.integrator->Prepare(prepare);
        runs[i].prepare = CpuSeconds() - start;
    }
    for (int round = 0; round <= a.rounds; ++round)
        for (Run &r : runs) {
            RenderSettings settings;
            settings.samplesPerPixel = r.built.samplesPerPixel;
            double start = CpuSeconds();
            RenderWaves(*r.built.integrator, *r.built.camera, *r.built.filter, *r.built.film, r.built.makeSampler, settings, progress);
            if (round > 0) r.seconds.push_back(CpuSeconds() - start);  // round 0 warms up
        }
    fmt::print("| sampler | CPU time per sample, relative to {} | prepass and build as share of a 256-sample render | bytes |\n|---|---|---|---|\n", a.samplers[0]);
    for (size_t i = 0; i < runs.size(); ++i) {
        std::vector<double> ratios;
        for (size_t k = 0; k < runs[i].seconds.size(); ++k) ratios.push_back(runs[i].seconds[k] / runs[0].seconds[k]);
        nlohmann::ordered_json report = nlohmann::ordered_json::object();
        runs[i].built.integrator->Lights()->Report(report);
        double perSample = Median(runs[i].seconds) / runs[i].built.samplesPerPixel;
        fmt::print("| {} | {:.3f} | {:.2f} % | {} |\n", a.samplers[i], Median(ratios), 100 * runs[i].prepare / (256 * perSample),
                   report.contains("bytes") ? report["bytes"].dump() : "-");
    }
    fmt::print("\nMedians of {} rounds of {} samples per pixel, all samplers in turn.\n", a.rounds, runs[0].built.samplesPerPixel);
    return 0;
}

}  // namespace

int main(int argc, char **argv) {
    Arguments a;
    if (argc < 3) {
        fmt::print(stderr, "usage: light_sampler_table error|cost scene.pbrt [options]; see the head of its source\n");
        return 2;
    }
    a.mode = argv[1];
    a.scene = argv[2];
    if (a.mode == "cost") a.divisor = 1;
    for (int i = 3; i + 1 < argc; i += 2) {
        std::string name = argv[i], value = argv[i + 1];
        if (name == "--samplers") a.samplers = Split(value);
        else if (name == "--spp") a.spp = std::stoi(value);
        else if (name == "--seeds") a.seeds = std::stoi(value);
        else if (name == "--maxdepth") a.maxDepth = std::stoi(value);
        else if (name == "--divisor") a.divisor = std::stoi(value);
        else if (name == "--reference-spp") a.referenceSpp = std::stoi(value);
        else if (name == "--rounds") a.rounds = std::stoi(value);
        else {
            fmt::print(stderr, "unknown option {}\n", name);
            return 2;
        }
    }
    if (a.spp == 0) a.spp = a.mode == "cost" ? 4 : 16;
    ThreadLimit threads(0);
    try {
        return a.mode == "cost" ? CostTable(a) : ErrorTable(a);
    } catch (const UserError &e) {
        fmt::print(stderr, "{}\n", e.what());
        return 1;
    }
}
