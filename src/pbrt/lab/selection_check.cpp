#include "pbrt/lab/selection_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "pbrt/core/parallel.h"
#include "pbrt/integrators/path_common.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/statistics.h"
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
// Statistic: over the paths of a region sum of excess over sum of light, its noise from path to path.
// Heavy tails: a light of share s chosen with probability p moves a vertex by s / (p draws). Where that is more than
// kLargestStep, the light counts with less weight, on both sides; what is left out is reported and added to the
// smallest visible bias. A vertex with more than kLargestVertex times the region's mean light per path (of those that
// have light) counts as that much. Weights depend on what was measured, not on what was drawn, so the means stay 0. So
// no path decides, and sums of hundreds are normal. A light that is never chosen keeps its whole weight.
//
// Rounds: four times the draws at the same vertices, until a bias of interest would be seen. Only the last round
// counts. When to stop depends on the noise, not on the differences, so there is one test, not one a round.

namespace pbrt::lab {

namespace {

constexpr uint64_t kStream = 0x73656c656374ull;
constexpr int kSide = 4;  ///< regions along a side of the picture
constexpr int kRegions = kSide * kSide;
constexpr int kFewestPaths = 256, kMostPaths = 4096;  ///< of a region
constexpr int kBlock = 16;                            ///< paths of one task
constexpr double kEnoughEffective = 60;               ///< paths that carry light in half of the regions end the tracing
constexpr size_t kMostMeasured = 2048;                ///< lights at a vertex
constexpr int kFewestDraws = 64, kMostDraws = 1 << 16;
constexpr double kLargestStep = 0.5;
constexpr double kLargestVertex = 8;
constexpr double kFewestEffective = 20;  ///< paths that carry light
constexpr int kMostPassed = 64;          ///< surfaces that do not scatter
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Follows paths as the render makes them and measures the lights at their vertices.
class Measurer {
  public:
    Measurer(const BuiltScene &built)
        : built_(built), scene_(*built.scene), stride_((scene_.Lights().Size() + kMostMeasured - 1) / kMostMeasured) {}

    void Follow(Point2i low, Point2i high, uint64_t stream, std::vector<SelectionVertices::Vertex> &out) {
        Rng rng(stream);
        const size_t before = out.size();
        CameraSample cs;
        cs.pFilm = Point2(low) + Point2(high - low) * rng.Uniform2();
        cs.time = rng.Uniform();
        cs.pLens = rng.Uniform2();
        SampledWavelengths lambda = SampledWavelengths::SampleVisible(rng.Uniform());
        if (std::optional<CameraRay> start = built_.camera->GenerateRay(cs, lambda)) Walk(*start, lambda, rng, out);
        if (out.size() > before) out.back().endsPath = true;
    }

  private:
    void Walk(const CameraRay &start, SampledWavelengths &lambda, Rng &rng,
              std::vector<SelectionVertices::Vertex> &out) {
        PathRay path{start.ray, start.differential};
        SampledSpectrum beta = start.weight;
        Float etaScale = 1;
        for (int depth = 0, passed = 0; depth < built_.maxDepth && passed < kMostPassed;) {
            std::optional<SurfacePoint> point = scene_.Intersect(path.ray);
            if (!point) return;
            ComputeFootprint(*point, path.differential, *built_.camera, built_.samplesPerPixel);
            const Bsdf bsdf = ComputeBsdf(scene_, *point, lambda);
            if (!bsdf) {
                path.PassThrough(*point);
                ++passed;
                continue;
            }
            ++depth;
            if (IsNonSpecular(bsdf.Flags())) {
                Measure(*point, bsdf, beta, lambda, rng);
                if (!lights_.empty()) {
                    out.push_back({LightQueryAt(*point, bsdf, lambda, depth), bsdf, lambda, lights_, false});
                    out.back().query.bsdf = nullptr;
                    out.back().query.lambda = nullptr;
                }
            }
            const Float uc = rng.Uniform();
            std::optional<BsdfSample> sample = bsdf.Sample(point->wo, uc, rng.Uniform2());
            if (!sample) return;
            beta *= sample->f * (AbsDot(sample->wi, point->shading.n) / sample->pdf);
            if (!beta) return;
            if (IsTransmissive(sample->flags)) etaScale *= Sqr(sample->eta);
            path.Scatter(*point, *sample);
            const Float survive = (beta * etaScale).MaxComponent();
            if (survive < 1 && depth > 1) {
                if (rng.Uniform() >= survive) return;
                beta /= survive;
            }
        }
    }

    void Measure(const SurfacePoint &point, const Bsdf &bsdf, const SampledSpectrum &beta,
                 const SampledWavelengths &lambda, Rng &rng) {
        lights_.clear();
        const LightSampleContext from = ScatteringContextAt(scene_, point, bsdf);
        const LightTable &table = scene_.Lights();
        for (auto l = static_cast<size_t>(rng.Uniform() * static_cast<Float>(stride_)); l < table.Size();
             l += stride_) {
            const Light &light = table[LightId(l)];
            const Point2 u = rng.Uniform2();
            std::optional<LightLiSample> sample = light.SampleLi(from, u, lambda, true);
            if (!sample || !sample->L || !(sample->pdf > 0)) continue;
            const SampledSpectrum f = bsdf.F(point.wo, sample->wi) * AbsDot(sample->wi, point.shading.n);
            if (!f) continue;
            const Float c = SafeDivide(beta * f * sample->L, lambda.Pdf()).Average() / sample->pdf;
            if (!(c > 0) || !std::isfinite(c) || scene_.Occluded(LightContextAt(point), *sample)) continue;
            lights_.push_back({static_cast<uint32_t>(l), c, sample->pdf, bsdf.Pdf(point.wo, sample->wi),
                               IsDelta(light.Kind()), sample->pLight});
        }
    }

    const BuiltScene &built_;
    const Scene &scene_;
    size_t stride_;
    std::vector<SelectionVertices::MeasuredLight> lights_;
};

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
        Draw(vertex, query, rng);
        double light = 0, excess = 0, unjudged = 0;
        for (const auto &m : vertex.lights) light += static_cast<double>(m.c);
        for (size_t i = 0; i < vertex.lights.size(); ++i) {
            const auto &m = vertex.lights[i];
            const Float pmf = lights_.PMF(query, LightId(m.light));
            // What BSDF sampling leaves to the light sampler. It never finds lights without extent.
            const double due = m.isDelta ? 1 : pmf > 0 ? static_cast<double>(Weight(m, pmf)) : 0;
            double got = got_[i] / draws_;
            // A shadow ray that is skipped with any probability below 1 is made up for.
            if (gate_ && got > 0 && !(gate_->TraceProbability(query, LightId(m.light), m.pLight) > 0)) got = 0;
            const double c = static_cast<double>(m.c);
            double counts = 1;
            if (pmf > 0 && due > 0)
                counts = std::min(1.0, kLargestStep * light * static_cast<double>(pmf) * draws_ / (c * due));
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
    void Draw(const SelectionVertices::Vertex &vertex, const LightQuery &query, Rng &rng) {
        got_.assign(vertex.lights.size(), 0);
        for (size_t i = 0; i < vertex.lights.size(); ++i) place_[vertex.lights[i].light] = static_cast<uint32_t>(i);
        for (int k = 0; k < draws_; ++k) {
            const Float u =
                std::min((static_cast<Float>(k) + rng.Uniform()) / static_cast<Float>(draws_), OneMinusEpsilon);
            std::optional<SampledLight> light = lights_.Sample(query, u);
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
    std::vector<double> got_;
    std::vector<uint32_t> place_;  ///< among the vertex's lights, of every light of the scene
};

/// Sums over paths.
struct Sums {
    double light = 0, excess = 0, squares = 0, lightSquares = 0, unjudged = 0;
    double Difference() const { return light > 0 ? excess / light : 0; }
    /// Excess has mean 0 if there is no bias, so its squares are its variance.
    double StandardError() const { return light > 0 ? std::sqrt(squares) / light : kInfinity; }
    /// As many paths of equal light would be as good.
    double Paths() const { return lightSquares > 0 ? light * light / lightSquares : 0; }
    double Unjudged() const { return light > 0 ? unjudged / light : 0; }
    Sums &operator+=(const Sums &o) {
        light += o.light;
        excess += o.excess;
        squares += o.squares;
        lightSquares += o.lightSquares;
        unjudged += o.unjudged;
        return *this;
    }
};

Sums SumUp(const std::vector<VertexFinding> &region) {
    double light = 0;
    size_t paths = 0;
    for (const VertexFinding &v : region) {
        light += static_cast<double>(v.light);
        paths += v.endsPath;
    }
    const double most = kLargestVertex * light / static_cast<double>(std::max<size_t>(paths, 1));
    Sums sums;
    double pathLight = 0, pathExcess = 0;
    for (const VertexFinding &v : region) {
        const double weight = static_cast<double>(v.light) > most ? most / static_cast<double>(v.light) : 1;
        pathLight += weight * static_cast<double>(v.light);
        pathExcess += weight * static_cast<double>(v.excess);
        sums.unjudged += weight * static_cast<double>(v.unjudged);
        if (!v.endsPath) continue;
        sums.light += pathLight;
        sums.excess += pathExcess;
        sums.squares += pathExcess * pathExcess;
        sums.lightSquares += pathLight * pathLight;
        pathLight = pathExcess = 0;
    }
    return sums;
}

/// Do half of the regions that have light have paths enough?
bool HaveEnough(std::span<const std::vector<SelectionVertices::Vertex>> regions) {
    int lit = 0, enough = 0;
    for (const auto &region : regions) {
        std::vector<VertexFinding> light;
        for (const auto &v : region) {
            light.push_back({.endsPath = v.endsPath});
            for (const auto &m : v.lights) light.back().light += m.c;
        }
        lit += !light.empty();
        enough += SumUp(light).Paths() >= kEnoughEffective;
    }
    return 2 * enough >= lit && lit > 0;
}

std::string Percent(double share) { return fmt::format("{:.2g} %", 100 * share); }

}  // namespace

SelectionReport JudgeSelection(std::span<const std::vector<VertexFinding>> regions, const SelectionSettings &settings) {
    SelectionReport report;
    Sums whole;
    std::vector<Sums> sums;
    size_t withLight = 0;
    for (const auto &region : regions) {
        report.vertices +=
            std::count_if(region.begin(), region.end(), [](const VertexFinding &v) { return v.light > 0; });
        sums.push_back(SumUp(region));
        whole += sums.back();
        withLight += sums.back().light > 0;
    }
    report.difference = whole.Difference();
    report.standardError = whole.StandardError();
    report.unjudged = whole.Unjudged();
    if (withLight == 0) {
        report.text = "no light was met at any vertex";
        return report;
    }
    const double level = SidakLevel(settings.bias.level, withLight + 1);
    // Student's: of what varies from path to path.
    auto deviates = [&](const Sums &s, double p) {
        return s.Paths() >= kFewestEffective ? StudentCritical(p, s.Paths() - 1) * s.StandardError() : kInfinity;
    };
    auto visible = [&](const Sums &s, double allowance) {
        return std::max(allowance, deviates(s, level) + deviates(s, 0.2)) + s.Unjudged();
    };
    auto isBiased = [&](const Sums &s, double allowance) {
        return std::abs(s.Difference()) > std::max(allowance, deviates(s, level));
    };
    report.visibleImage = visible(whole, settings.bias.allowanceImage);
    std::vector<double> ofRegions;
    bool biased = isBiased(whole, settings.bias.allowanceImage);
    if (biased) report.worstDifference = report.difference;
    for (size_t r = 0; r < sums.size(); ++r) {
        if (!(sums[r].light > 0)) continue;
        ofRegions.push_back(visible(sums[r], settings.bias.allowanceRegion));
        if (!isBiased(sums[r], settings.bias.allowanceRegion)) continue;
        biased = true;
        if (std::abs(sums[r].Difference()) > std::abs(report.worstDifference)) {
            report.worstRegion = static_cast<int>(r);
            report.worstDifference = sums[r].Difference();
        }
    }
    const auto middle = ofRegions.begin() + static_cast<std::ptrdiff_t>((ofRegions.size() - 1) / 2);
    std::nth_element(ofRegions.begin(), middle, ofRegions.end());
    report.visibleSixteenth = *middle;
    report.verdict = biased                                              ? BiasVerdict::Biased
                     : report.visibleSixteenth <= settings.bias.interest ? BiasVerdict::Clean
                                                                         : BiasVerdict::Unknown;
    report.text = fmt::format("at {} vertices of paths light selection is off by {:+.2g} +- {:.1g} %", report.vertices,
                              100 * report.difference, 100 * report.standardError);
    if (biased && report.worstRegion >= 0)
        report.text += fmt::format(", by {:+.2g} % in row {}, column {} of 4 x 4 regions", 100 * report.worstDifference,
                                   report.worstRegion / kSide + 1, report.worstRegion % kSide + 1);
    if (std::isfinite(report.visibleSixteenth))
        report.text += fmt::format("; {} of the whole, {} in a sixteenth would have been seen",
                                   Percent(report.visibleImage), Percent(report.visibleSixteenth));
    else
        report.text += "; too few of them have light for more";
    return report;
}

SelectionVertices::SelectionVertices(const BuiltScene &built, int seed, Progress &progress)
    : lightCount_(built.scene->Lights().Size()) {
    const Bounds2i pixels = built.film->PixelBounds();
    const Vector2i size = pixels.high - pixels.low;
    auto corner = [&](int x, int y) { return pixels.low + Point2i(x * size.x / kSide, y * size.y / kSide); };
    regions_.resize(kRegions);
    progress.BeginPhase("measuring lights", 0);
    for (int done = 0, target = kFewestPaths; target <= kMostPaths && !progress.Cancelled();
         done = target, target *= 2) {
        const int blocks = (target - done) / kBlock;
        std::vector<std::vector<Vertex>> found(static_cast<size_t>(kRegions * blocks));
        ParallelForEach(static_cast<int64_t>(found.size()), [&](int64_t task) {
            if (progress.Cancelled()) return;
            Measurer measurer(built);
            const int region = static_cast<int>(task) / blocks, first = done + static_cast<int>(task) % blocks * kBlock;
            const int x = region % kSide, y = region / kSide;
            for (int i = first; i < first + kBlock; ++i)
                measurer.Follow(corner(x, y), corner(x + 1, y + 1), Hash(kStream, seed, region, i),
                                found[static_cast<size_t>(task)]);
        });
        for (size_t t = 0; t < found.size(); ++t)
            std::move(found[t].begin(), found[t].end(), std::back_inserter(regions_[t / static_cast<size_t>(blocks)]));
        if (HaveEnough(regions_)) break;
    }
    progress.EndPhase();
}

size_t SelectionVertices::VertexCount() const {
    size_t count = 0;
    for (const auto &region : regions_) count += region.size();
    return count;
}

std::optional<SelectionReport> CheckSelection(const SelectionVertices &vertices, const LightSampler &lights,
                                              const ShadowRayGate *gate, const SelectionSettings &settings,
                                              Progress &progress) {
    SelectionReport report;
    const double count = static_cast<double>(vertices.VertexCount());
    for (int draws = kFewestDraws; draws <= kMostDraws; draws *= 4) {
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
        report = JudgeSelection(regions, settings);
        report.draws = draws;
        if (report.visibleSixteenth <= settings.bias.interest || 4 * draws * count > settings.mostWork) break;
    }
    return report;
}

nlohmann::ordered_json ToJson(const SelectionReport &r) {
    auto finite = [](double v) { return std::isfinite(v) ? nlohmann::ordered_json(v) : nlohmann::ordered_json(); };
    return {{"verdict", BiasVerdictName(r.verdict)},
            {"vertices", r.vertices},
            {"draws", r.draws},
            {"difference", r.difference},
            {"standardError", finite(r.standardError)},
            {"visibleImage", finite(r.visibleImage)},
            {"visibleSixteenth", finite(r.visibleSixteenth)},
            {"unjudged", r.unjudged},
            {"text", r.text}};
}

SelectionReport SelectionFromJson(const nlohmann::ordered_json &json) {
    auto number = [&](const char *name) { return json.at(name).is_null() ? kInfinity : json.at(name).get<double>(); };
    SelectionReport r;
    for (BiasVerdict v : {BiasVerdict::Clean, BiasVerdict::Biased, BiasVerdict::Unknown})
        if (json.at("verdict") == BiasVerdictName(v)) r.verdict = v;
    r.vertices = json.at("vertices");
    r.draws = json.at("draws");
    r.difference = json.at("difference");
    r.standardError = number("standardError");
    r.visibleImage = number("visibleImage");
    r.visibleSixteenth = number("visibleSixteenth");
    r.unjudged = json.at("unjudged");
    r.text = json.at("text");
    return r;
}

void AddSelection(const SelectionReport &selection, BiasReport *report) {
    report->text += " Vertex by vertex: " + selection.text + ".";
    if (selection.verdict == BiasVerdict::Biased) report->verdict = BiasVerdict::Biased;
    if (selection.verdict == BiasVerdict::Clean && report->verdict == BiasVerdict::Unknown)
        report->verdict = BiasVerdict::Clean;
}

}  // namespace pbrt::lab
