// Nanoseconds per Sample() and per PMF() of each stock light sampler, by number of lights. Queries jump through the
// scene, so that big structures pay for their cache misses.
#include <benchmark/benchmark.h>

#include "pbrt/integrators/registry.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"
#include "support/given_lights.h"

namespace pbrt {
namespace {

std::vector<LightCandidate> Candidates(int count) {
    Rng rng(1);
    std::vector<LightCandidate> candidates;
    for (int i = 0; i < count; ++i) {
        LightBounds b;
        Point3 p(rng.Uniform(), rng.Uniform(), rng.Uniform());
        b.bounds = Bounds3(p, p + Vector3(rng.Uniform(), rng.Uniform(), rng.Uniform()) * Float(0.01));
        b.w = SampleUniformSphere(rng.Uniform2());
        b.phi = double(rng.Uniform()) + 0.1;
        LightCandidate c;
        c.bounds = b;
        c.power = Float(b.phi);
        candidates.push_back(c);
    }
    return candidates;
}

std::vector<LightQuery> Queries() {
    Rng rng(2);
    std::vector<LightQuery> queries(4096);
    for (LightQuery &q : queries) {
        q.p = {rng.Uniform(), rng.Uniform(), rng.Uniform()};
        q.n = q.ns = SampleUniformSphere(rng.Uniform2());
    }
    return queries;
}

PluginRegistry Stock() {
    PluginRegistry registry;
    RegisterStockLightSamplers(registry);
    return registry;
}

/// The costs are those of a sampler over state.range(0) lights.
void SampleCost(benchmark::State &state, const std::string &name) {
    const PluginRegistry registry = Stock();
    const auto table = test::TableOf(Candidates(int(state.range(0))));
    auto sampler = registry.samplers.Find(name).make(ParamSet(), table->ByComponent());
    std::vector<LightQuery> queries = Queries();
    Rng rng(3);
    size_t i = 0;
    for (auto _ : state) benchmark::DoNotOptimize(sampler->Sample(queries[i++ % queries.size()], rng.Uniform()));
}

void PmfCost(benchmark::State &state, const std::string &name) {
    const PluginRegistry registry = Stock();
    const auto table = test::TableOf(Candidates(int(state.range(0))));
    auto sampler = registry.samplers.Find(name).make(ParamSet(), table->ByComponent());
    std::vector<LightQuery> queries = Queries();
    Rng rng(3);
    size_t i = 0;
    auto count = uint32_t(table->Size());
    for (auto _ : state)
        benchmark::DoNotOptimize(sampler->PMF(queries[i++ % queries.size()], LightId(rng.UniformInt(count))));
}

void BuildCost(benchmark::State &state, const std::string &name) {
    const PluginRegistry registry = Stock();
    const auto table = test::TableOf(Candidates(int(state.range(0))));
    for (auto _ : state) benchmark::DoNotOptimize(registry.samplers.Find(name).make(ParamSet(), table->ByComponent()));
}

const bool kRegistered = [] {
    const PluginRegistry registry = Stock();
    for (const std::string &name : registry.samplers.Names())
        for (int64_t lights : {1, 10, 100, 10000}) {
            benchmark::RegisterBenchmark(("Sample/" + name).c_str(), SampleCost, name)->Arg(lights);
            benchmark::RegisterBenchmark(("PMF/" + name).c_str(), PmfCost, name)->Arg(lights);
        }
    benchmark::RegisterBenchmark("Build/bvh", BuildCost, "bvh")->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond);
    return true;
}();

}  // namespace
}  // namespace pbrt

BENCHMARK_MAIN();
