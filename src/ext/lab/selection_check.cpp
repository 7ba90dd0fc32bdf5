#include "ext/lab/selection_check.h"

#include <algorithm>

#include "pbrt/core/parallel.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"

// Method. Samplers differ only in their light selection probabilities, so bias is tested at the vertices of paths,
// generated as in the render.
//
// At a surface or medium vertex, the contribution c_l of every light is measured once, by a point on the light and a
// shadow ray. With very many lights, only every n-th is measured, from a random start. (Statements on BSDFs hold for
// phase functions.) Then many lights are drawn from the sampler, with stratified random numbers. Two numbers are
// compared per measured light. First, the mean over the draws of next-event estimation of c_l, with the draws'
// probabilities and the MIS weight against BSDF sampling. Second, the share of c_l that BSDF sampling leaves to
// next-event estimation, by the PMF that the integrator evaluates when a ray hits the light. (A point of an environment
// light represents its region.)
//
// `excess` is the difference, summed over the lights. Its mean is 0 at every vertex if and only if draws, probabilities
// and PMF agree and no light is omitted. Light points, visibility, path and weight are common to both sides, and so is
// their noise. Draws need no rays, so there can be thousands per vertex.
//
// Heavy tails: a light of share s selected with probability p moves a vertex by s / (p draws). Above kMaxStep the light
// counts with less weight on both sides; the omitted part is reported and added to the smallest visible bias. Weights
// depend on measurements, not on draws, so the mean stays 0. A light that is never selected keeps its whole weight.
//
// Rounds: each has four times the draws of the previous one, at the same vertices, until a bias of interest would be
// detected. Only the last round counts. The stopping rule depends on the noise, not on the differences, so there is a
// single test.

namespace ext::lab {

namespace {

constexpr uint64_t kStream = 0x73656c656374ull;
constexpr int kMinDraws = 64, kMaxDraws = 1 << 16;
constexpr double kMaxStep = 0.5;

/// Compares draws from a sampler with the lights measured at vertices.
class VertexChecker {
  public:
    VertexChecker(const LightSampler &lights, int draws, const LightTable &table)
        : lights_(lights), draws_(draws), table_(table), places_(table.Size()) {}

    VertexFinding Check(const SelectionVertices::Vertex &vertex, Rng rng) {
        VertexFinding finding;
        finding.endsPath = vertex.endsPath;
        const LightQuery query = vertex.FullQuery();
        const LightDistribution lights = lights_.At(query, memory_);
        FindChoices(vertex, lights);
        Draw(vertex, lights, rng);
        double light = 0, excess = 0, unjudged = 0;
        for (const auto &m : vertex.lights) light += static_cast<double>(m.c);
        for (size_t i = 0; i < vertex.lights.size(); ++i) {
            const auto &m = vertex.lights[i];
            const Float pmf = choices_[i].light.pmf;
            // Share that BSDF sampling leaves to light sampling: all of it for delta lights.
            const double due = m.isDelta ? 1 : pmf > 0 ? static_cast<double>(Weight(m, choices_[i], pmf)) : 0;
            const double got = got_[i] / draws_;
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
    /// The sampler's selection for the measured point, and the resulting density of the point.
    struct Choice {
        SampledLight light;
        Float pdf = 0;  ///< solid angle
    };
    static Float Weight(const SelectionVertices::MeasuredLight &m, const Choice &choice, Float pmf) {
        return m.isDelta ? Float(1) : PowerHeuristic(pmf * choice.pdf, m.pBsdf);
    }

    void FindChoices(const SelectionVertices::Vertex &vertex, const LightDistribution &lights) {
        choices_.clear();
        for (const auto &m : vertex.lights) {
            const LightId id(m.light);
            if (!m.isInfinite) {
                choices_.push_back({{id, lights.PMF(id)}, m.pdf});
                continue;
            }
            const LightSampleContext from{vertex.query.p, {}, {}, {}, 0};
            const SampledLight light = lights.Towards(id, from.p, m.wi);
            choices_.push_back({light, table_.Region(id, light.region).PdfLi(from, m.wi, {}, {}, true)});
        }
    }

    /// Sets got_: per measured light, the sum of its weights over the draws.
    void Draw(const SelectionVertices::Vertex &vertex, const LightDistribution &lights, Rng &rng) {
        got_.assign(vertex.lights.size(), 0);
        for (size_t i = 0; i < choices_.size(); ++i)
            places_[choices_[i].light.light.value] = static_cast<uint32_t>(i) + 1;
        for (int k = 0; k < draws_; ++k) {
            const Float u =
                std::min((static_cast<Float>(k) + rng.Uniform()) / static_cast<Float>(draws_), OneMinusEpsilon);
            Point2 uPoint = rng.Uniform2();
            std::optional<SampledLight> light = lights.Sample(u, &uPoint);
            if (!light || !(light->pmf > 0)) continue;
            const uint32_t place = places_[light->light.value];
            if (place > 0 && light->region == choices_[place - 1].light.region)
                got_[place - 1] +=
                    static_cast<double>(Weight(vertex.lights[place - 1], choices_[place - 1], light->pmf) / light->pmf);
        }
        for (const Choice &choice : choices_) places_[choice.light.light.value] = 0;
    }

    const LightSampler &lights_;
    int draws_;
    LightMemory memory_;
    const LightTable &table_;
    std::vector<Choice> choices_;  ///< of the vertex's lights
    std::vector<double> got_;
    std::vector<uint32_t> places_;  ///< per light: 1 + its index among the vertex's lights, or 0
};

}  // namespace

std::optional<SelectionReport> CheckSelection(const SelectionVertices &vertices, const LightSampler &lights,
                                              const SelectionSettings &settings, Progress &progress) {
    SelectionReport report;
    const double count = static_cast<double>(vertices.VertexCount());
    for (int draws = kMinDraws; draws <= kMaxDraws; draws *= 4) {
        std::vector<std::vector<VertexFinding>> regions(vertices.RegionCount());
        progress.BeginPhase("checking light selection", regions.size());
        ParallelForEach(regions.size(), [&](int64_t r) {
            VertexChecker checker(lights, draws, vertices.Lights());
            const auto &region = vertices.OfRegion(r);
            for (size_t v = 0; v < region.size() && !progress.Cancelled(); ++v)
                regions[r].push_back(checker.Check(region[v], Rng(Hash(kStream, settings.seed, draws, r, v))));
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

}  // namespace ext::lab
