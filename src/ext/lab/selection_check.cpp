#include "ext/lab/selection_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pbrt/core/parallel.h"
#include "pbrt/math/statistics.h"

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
// detected. Only the last round counts. Stopping depends on the noise, not on the differences: there is a single test.

// Statistic of a region: sum of the excess over the sum of the light of its paths, with noise estimated from the
// variation between paths. Vertices are scaled down to kMaxVertex times the mean light of the region's lit paths. The
// light is independent of the draws, so the mean of the excess stays 0, no single path dominates, and sums over
// hundreds of paths are nearly normal.

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
        const LightQuery query = vertex.FullQuery();
        const LightDistribution lights = lights_.At(query, memory_);
        FindChoices(vertex, lights);
        Draw(vertex, lights, rng);
        double light = 0, excess = 0, unjudged = 0;
        for (const auto &m : vertex.lights) light += double(m.c);
        for (size_t i = 0; i < vertex.lights.size(); ++i) {
            const auto &m = vertex.lights[i];
            const Float pmf = choices_[i].light.pmf;
            // Share that BSDF sampling leaves to light sampling: all of it for delta lights.
            const double due = m.isDelta ? 1 : pmf > 0 ? double(Weight(m, choices_[i], pmf)) : 0;
            const double got = got_[i] / draws_;
            const double c = double(m.c);
            double counts = 1;
            if (pmf > 0 && due > 0) counts = std::min(1.0, kMaxStep * light * double(pmf) * draws_ / (c * due));
            excess += counts * c * (got - due);
            unjudged += (1 - counts) * c * due;
        }
        return {float(light), float(excess), float(unjudged), vertex.endsPath};
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
        for (size_t i = 0; i < choices_.size(); ++i) places_[choices_[i].light.light.value] = uint32_t(i) + 1;
        for (int k = 0; k < draws_; ++k) {
            const Float u = std::min((Float(k) + rng.Uniform()) / Float(draws_), OneMinusEpsilon);
            Point2 uPoint = rng.Uniform2();
            std::optional<SampledLight> light = lights.Sample(u, &uPoint);
            if (!light || !(light->pmf > 0)) continue;
            const uint32_t place = places_[light->light.value];
            if (place > 0 && light->region == choices_[place - 1].light.region)
                got_[place - 1] +=
                    double(Weight(vertex.lights[place - 1], choices_[place - 1], light->pmf) / light->pmf);
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

constexpr double kMaxVertex = 8;
constexpr double kMinEffective = 20;  ///< minimum effective paths for a statement
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Sums {
    double light = 0, excess = 0, squares = 0, lightSquares = 0, unjudged = 0;
    double Difference() const { return light > 0 ? excess / light : 0; }
    /// The excess has mean 0 without bias, so the sum of its squares estimates the variance of its sum.
    double StandardError() const { return light > 0 ? std::sqrt(squares) / light : kInfinity; }
    /// Number of paths of equal light with the same noise.
    double Paths() const { return lightSquares > 0 ? light * light / lightSquares : 0; }
    double Unjudged() const { return light > 0 ? unjudged / light : 0; }
};

Sums SumUp(std::span<const VertexFinding> region) {
    double light = 0;
    size_t paths = 0;
    for (const VertexFinding &v : region) {
        light += double(v.light);
        paths += v.endsPath;
    }
    const double maxLight = kMaxVertex * light / double(std::max<size_t>(paths, 1));
    Sums sums;
    double pathLight = 0, pathExcess = 0;
    for (const VertexFinding &v : region) {
        const double weight = double(v.light) > maxLight ? maxLight / double(v.light) : 1;
        pathLight += weight * double(v.light);
        pathExcess += weight * double(v.excess);
        sums.unjudged += weight * double(v.unjudged);
        if (!v.endsPath) continue;
        sums.light += pathLight;
        sums.excess += pathExcess;
        sums.squares += pathExcess * pathExcess;
        sums.lightSquares += pathLight * pathLight;
        pathLight = pathExcess = 0;
    }
    return sums;
}

/// Calls f(name in JSON, value); infinity is null there.
void ForEachNumber(auto &r, auto &&f) {
    f("vertices", r.vertices);
    f("draws", r.draws);
    f("difference", r.difference);
    f("standardError", r.standardError);
    f("visibleImage", r.visibleImage);
    f("visibleSixteenth", r.visibleSixteenth);
    f("unjudged", r.unjudged);
    f("worstRegion", r.worstRegion);
    f("worstDifference", r.worstDifference);
}

std::string TextOf(const SelectionReport &report) {
    std::string text = fmt::format("at {} path vertices light selection deviates by {:+.2g} +- {:.1g} %",
                                   report.vertices, 100 * report.difference, 100 * report.standardError);
    if (report.worstRegion >= 0)
        text += fmt::format(", by {:+.2g} % in row {}, column {} of {} x {} regions", 100 * report.worstDifference,
                            report.worstRegion / kSelectionSide + 1, report.worstRegion % kSelectionSide + 1,
                            kSelectionSide, kSelectionSide);
    if (std::isfinite(report.visibleSixteenth))
        text += fmt::format("; detectable: {} in the whole image, {} in a sixteenth", PercentText(report.visibleImage),
                            PercentText(report.visibleSixteenth));
    else text += "; too few of them receive light for a detection limit";
    return text;
}

}  // namespace

std::optional<SelectionReport> CheckSelection(const SelectionVertices &vertices, const LightSampler &lights,
                                              const SelectionSettings &settings, Progress &progress) {
    SelectionReport report;
    double count = 0;
    for (size_t r = 0; r < vertices.RegionCount(); ++r) count += double(vertices.OfRegion(r).size());
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
        if (report.visibleSixteenth <= settings.bias.interest || 4 * draws * count > settings.maxWork) break;
    }
    return report;
}

double EffectivePaths(std::span<const VertexFinding> region) { return SumUp(region).Paths(); }

SelectionReport JudgeSelection(std::span<const std::vector<VertexFinding>> regions, const BiasSettings &settings) {
    SelectionReport report;
    Sums whole;
    std::vector<Sums> sums;
    size_t withLight = 0;
    for (const auto &region : regions) {
        report.vertices += std::ranges::count_if(region, [](const VertexFinding &v) { return v.light > 0; });
        const Sums &s = sums.emplace_back(SumUp(region));
        whole.light += s.light;
        whole.excess += s.excess;
        whole.squares += s.squares;
        whole.lightSquares += s.lightSquares;
        whole.unjudged += s.unjudged;
        withLight += s.light > 0;
    }
    report.difference = whole.Difference();
    report.standardError = whole.StandardError();
    report.unjudged = whole.Unjudged();
    if (withLight == 0) {
        report.text = "no vertex receives light";
        return report;
    }
    const double level = SidakLevel(settings.level, withLight + 1);
    // Critical value of Student's t times the standard error, for a two-sided level p.
    auto deviates = [&](const Sums &s, double p) {
        return s.Paths() >= kMinEffective ? StudentCritical(p, s.Paths() - 1) * s.StandardError() : kInfinity;
    };
    auto visible = [&](const Sums &s, double allowance) {
        return std::max(allowance, deviates(s, level) + deviates(s, 0.2)) + s.Unjudged();
    };
    auto isBiased = [&](const Sums &s, double allowance) {
        return std::abs(s.Difference()) > std::max(allowance, deviates(s, level));
    };
    report.visibleImage = visible(whole, settings.allowanceImage);
    std::vector<double> ofRegions;
    bool biased = isBiased(whole, settings.allowanceImage);
    if (biased) report.worstDifference = report.difference;
    for (size_t r = 0; r < sums.size(); ++r) {
        if (!(sums[r].light > 0)) continue;
        ofRegions.push_back(visible(sums[r], settings.allowanceRegion));
        if (!isBiased(sums[r], settings.allowanceRegion)) continue;
        biased = true;
        if (std::abs(sums[r].Difference()) > std::abs(report.worstDifference)) {
            report.worstRegion = int(r);
            report.worstDifference = sums[r].Difference();
        }
    }
    const auto middle = ofRegions.begin() + ((ofRegions.size() - 1) / 2);
    std::nth_element(ofRegions.begin(), middle, ofRegions.end());
    report.visibleSixteenth = *middle;
    report.verdict = biased                                         ? BiasVerdict::Biased
                     : report.visibleSixteenth <= settings.interest ? BiasVerdict::Clean
                                                                    : BiasVerdict::Unknown;
    report.text = TextOf(report);
    return report;
}

Json ToJson(const SelectionReport &r) {
    Json json;
    json["verdict"] = BiasVerdictName(r.verdict);
    ForEachNumber(r, [&](const char *name, auto v) { json[name] = std::isfinite(double(v)) ? Json(v) : Json(); });
    json["text"] = r.text;
    return json;
}

SelectionReport SelectionFromJson(const Json &json) {
    SelectionReport r;
    for (BiasVerdict v : {BiasVerdict::Clean, BiasVerdict::Biased, BiasVerdict::Unknown})
        if (json.at("verdict") == BiasVerdictName(v)) r.verdict = v;
    ForEachNumber(r, [&]<class T>(const char *name, T &v) {
        v = json.at(name).is_null() ? std::numeric_limits<T>::infinity() : json.at(name).get<T>();
    });
    r.text = json.at("text");
    return r;
}

void AddSelection(const SelectionReport &selection, BiasReport *report) {
    if (selection.verdict == BiasVerdict::Clean && report->verdict == BiasVerdict::Unknown && !report->worst.biased) {
        // This text replaces "Too few data": the vertices are sufficient.
        report->verdict = BiasVerdict::Clean;
        report->text = fmt::format(
            "No bias detected, and the check at path vertices would have detected one; smallest detectable by the "
            "images alone: {} in the whole image, {} in regions of 1/{} of it.",
            PercentText(report->visibleImage), PercentText(report->visibleSixteenth), report->sixteenthRegions);
    }
    if (selection.verdict == BiasVerdict::Biased && report->verdict != BiasVerdict::Biased) {
        report->verdict = BiasVerdict::Biased;
        report->text = "The images alone do not show this bias.";
    }
    report->text += " Vertex by vertex: " + selection.text + ".";
}

}  // namespace ext::lab
