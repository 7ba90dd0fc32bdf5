#include "pbrt/lab/selection_check.h"

#include <algorithm>

#include "pbrt/core/parallel.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"

// The method. Samplers differ in one thing only, which light is chosen with which probability; all else of a picture is
// common to them. So the question "is the picture right?" is asked where they differ: at the vertices of paths, as the
// render makes them.
//
// At a vertex every light (of very many, every n-th, from a random one on) is measured once, by a point on it and a
// shadow ray: c_l. The sampler is then asked many times, with random numbers spread over [0, 1). For every measured
// light stands what next-event estimation would have made of c_l, weighted against BSDF sampling, by the probabilities
// that came with the draws; against it what BSDF sampling leaves to it, by the PMF that the integrator asks for when a
// ray hits the light. `excess` is the difference. Its mean is 0 at every vertex if and only if draws, their
// probabilities and the PMF agree and no light is left out: points and visibility of the lights, the path and its
// weight are the same on both sides, and their noise with them. Draws need no rays, so there can be thousands a vertex.
//
// Heavy tails: a light of share s chosen with probability p moves a vertex by s / (p draws). Where that is more than
// kMaxStep, the light counts with less weight, on both sides; what is left out is reported and added to the
// smallest visible bias. Weights depend on what was measured, not on what was drawn, so the mean stays 0. A light that
// is never chosen keeps its whole weight.
//
// Rounds: four times the draws at the same vertices, until a bias of interest would be seen. Only the last round
// counts. When to stop depends on the noise, not on the differences, so there is one test, not one a round.

namespace pbrt::lab {

namespace {

constexpr uint64_t kStream = 0x73656c656374ull;
constexpr int kMinDraws = 64, kMaxDraws = 1 << 16;
constexpr double kMaxStep = 0.5;

/// Asks a sampler at vertices.
class Asker {
  public:
    Asker(const LightSampler &lights, const ShadowRayGate *gate, int draws, size_t lightCount)
        : lights_(lights), gate_(gate), draws_(draws), place_(lightCount, kNowhere) {}

    VertexFinding Ask(const SelectionVertices::Vertex &vertex, Rng rng) {
        VertexFinding finding;
        finding.endsPath = vertex.endsPath;
        LightQuery query = vertex.query;
        query.bsdf = &vertex.bsdf;
        query.lambda = &vertex.lambda;
        const LightDistribution lights = lights_.At(query, memory_);
        Draw(vertex, lights, rng);
        double light = 0, excess = 0, unjudged = 0;
        for (const auto &m : vertex.lights) light += static_cast<double>(m.c);
        for (size_t i = 0; i < vertex.lights.size(); ++i) {
            const auto &m = vertex.lights[i];
            const Float pmf = lights.PMF(LightId(m.light));
            // What BSDF sampling leaves to the light sampler. It never finds lights without extent.
            const double due = m.isDelta ? 1 : pmf > 0 ? static_cast<double>(Weight(m, pmf)) : 0;
            double got = got_[i] / draws_;
            // A shadow ray that is skipped with any probability below 1 is made up for.
            if (gate_ && got > 0 && !(gate_->TraceProbability(query, LightId(m.light), m.pLight) > 0)) got = 0;
            const double c = static_cast<double>(m.c);
            double counts = 1;
            if (pmf > 0 && due > 0)
                counts = std::min(1.0, kMaxStep * light * static_cast<double>(pmf) * draws_ / (c * due));
            excess += counts * c * (got - due);
            unjudged += (1 - counts) * c * due;
        }
        finding.light = static_cast<float>(light);
        finding.excess = static_cast<float>(excess);
        finding.unjudged = static_cast<float>(unjudged);
        return finding;
    }

  private:
    static constexpr uint32_t kNowhere = ~0u;
    static Float Weight(const SelectionVertices::MeasuredLight &m, Float pmf) {
        return m.isDelta ? Float(1) : PowerHeuristic(pmf * m.pdf, m.pBsdf);
    }

    /// got_: per measured light, sum over draws.
    void Draw(const SelectionVertices::Vertex &vertex, const LightDistribution &lights, Rng &rng) {
        got_.assign(vertex.lights.size(), 0);
        for (size_t i = 0; i < vertex.lights.size(); ++i) place_[vertex.lights[i].light] = static_cast<uint32_t>(i);
        for (int k = 0; k < draws_; ++k) {
            const Float u =
                std::min((static_cast<Float>(k) + rng.Uniform()) / static_cast<Float>(draws_), OneMinusEpsilon);
            std::optional<SampledLight> light = lights.Sample(u);
            if (!light || !(light->pmf > 0)) continue;
            const uint32_t place = place_[light->light.value];
            if (place != kNowhere)
                got_[place] += static_cast<double>(Weight(vertex.lights[place], light->pmf) / light->pmf);
        }
        for (const auto &m : vertex.lights) place_[m.light] = kNowhere;
    }

    const LightSampler &lights_;
    const ShadowRayGate *gate_;
    int draws_;
    LightMemory memory_;
    std::vector<double> got_;
    std::vector<uint32_t> place_;  ///< among the vertex's lights, of every light of the scene
};

}  // namespace

std::optional<SelectionReport> CheckSelection(const SelectionVertices &vertices, const LightSampler &lights,
                                              const ShadowRayGate *gate, const SelectionSettings &settings,
                                              Progress &progress) {
    SelectionReport report;
    const double count = static_cast<double>(vertices.VertexCount());
    for (int draws = kMinDraws; draws <= kMaxDraws; draws *= 4) {
        std::vector<std::vector<VertexFinding>> regions(vertices.RegionCount());
        progress.BeginPhase("checking light selection", static_cast<int64_t>(regions.size()));
        ParallelForEach(static_cast<int64_t>(regions.size()), [&](int64_t r) {
            Asker asker(lights, gate, draws, vertices.LightCount());
            const auto &region = vertices.OfRegion(static_cast<size_t>(r));
            for (size_t v = 0; v < region.size() && !progress.Cancelled(); ++v)
                regions[static_cast<size_t>(r)].push_back(
                    asker.Ask(region[v], Rng(Hash(kStream, settings.seed, draws, r, v))));
            progress.Advance();
        });
        progress.EndPhase();
        if (progress.Cancelled()) return {};
        report = JudgeSelection(regions, settings.bias);
        report.draws = draws;
        if (report.visibleSixteenth <= settings.bias.interest || 4 * draws * count > settings.mostWork) break;
    }
    return report;
}

}  // namespace pbrt::lab
