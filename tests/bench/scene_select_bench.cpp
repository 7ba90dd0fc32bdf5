// Cost of choosing a light in a real scene: seconds and bytes to build each sampler, nanoseconds per Sample() and per
// PMF() of the light it chose, each alone and both from one distribution; on one thread, at the vertices of camera
// paths in the order of a render.
//
//   bench_scene_select scene.pbrt sampler [sampler ...]      sampler: name[:key=value,...]
//
// Prints JSON. Used by docs/measured/scaling.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "bench_scene.h"
#include "pbrt/core/error.h"
#include "pbrt/math/rng.h"

namespace pbrt {
namespace {

/// The fastest of passes over all queries that together take about a third of a second, at least three.
template <class Body>
double NanosecondsPerQuery(size_t queries, Body &&body) {
    double best = Infinity, spent = 0;
    for (int pass = 0; pass < 3 || spent < 0.3; ++pass) {
        const double start = Now();
        for (size_t i = 0; i < queries; ++i) body(i);
        const double seconds = Now() - start;
        spent += seconds;
        best = std::min(best, seconds);
    }
    return best / double(queries) * 1e9;
}

nlohmann::ordered_json Measure(BenchScene &scene, const std::string &name, std::span<const LightQuery> queries) {
    nlohmann::ordered_json out;
    LightChoice choice;
    choice.lightSampler = name;
    const double start = Now();
    BuiltIntegrator made = MakeIntegrator(scene.built, choice);
    const double madeAt = Now();
    PrepareContext context = scene.Context();
    made.integrator->Prepare(context);
    out["makeSeconds"] = madeAt - start;
    out["prepareSeconds"] = Now() - madeAt;

    const LightSampler *lights = made.integrator->Lights();
    PBRT_CHECK(lights);
    std::vector<SampledLight> chosen(queries.size());
    std::vector<Float> numbers(queries.size());
    Rng rng(7);
    for (Float &u : numbers) u = rng.Uniform();
    out["sampleNanoseconds"] = NanosecondsPerQuery(
        queries.size(), [&](size_t i) { chosen[i] = lights->Sample(queries[i], numbers[i]).value_or(SampledLight{}); });
    // Queries for which no light was chosen are left out, as they have no PMF.
    std::vector<size_t> some;
    for (size_t i = 0; i < chosen.size(); ++i)
        if (chosen[i].pmf > 0) some.push_back(i);
    double wrong = 0;
    if (!some.empty())
        out["pmfNanoseconds"] = NanosecondsPerQuery(some.size(), [&](size_t i) {
            const size_t k = some[i];
            wrong += lights->PMF(queries[k], chosen[k].light) == chosen[k].pmf ? 0 : 1;
        });
    out["pmfDiffers"] = wrong;
    LightMemory memory;
    Float sum = 0;
    out["sampleAndPmfNanoseconds"] = NanosecondsPerQuery(queries.size(), [&](size_t i) {
        const LightDistribution at = lights->At(queries[i], memory);
        if (std::optional<SampledLight> light = at.Sample(numbers[i])) sum += at.PMF(light->light) - light->pmf;
    });
    out["pmfDiffers"] = wrong + double(sum != 0);
    out["chosenShare"] = double(some.size()) / double(std::max<size_t>(1, queries.size()));
    nlohmann::ordered_json report;
    lights->Report(report);
    out["report"] = report;
    return out;
}

int Run(int argc, char **argv) {
    if (argc < 3) {
        std::fprintf(stderr, "bench_scene_select scene.pbrt sampler [sampler ...]\n");
        return 1;
    }
    const double start = Now();
    BenchScene scene(argv[1]);
    nlohmann::ordered_json out;
    out["sceneSeconds"] = Now() - start;
    out["lights"] = scene.built.scene->Lights().Size();

    std::vector<LightQuery> queries;
    for (const ext::PrepassVertex &v : scene.Vertices(10000)) queries.push_back(ext::QueryAt(v));
    out["queries"] = queries.size();
    for (int i = 2; i < argc; ++i) out["samplers"][argv[i]] = Measure(scene, argv[i], queries);
    std::printf("%s\n", out.dump(2).c_str());
    return 0;
}

}  // namespace
}  // namespace pbrt

int main(int argc, char **argv) {
    return pbrt::ReportingErrors([&] { return pbrt::Run(argc, argv); });
}
