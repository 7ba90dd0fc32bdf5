#include "ext/octree/window_choice.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "ext/octree/visibility_records.h"
#include "ext/octree/visibility_tree_builder.h"
#include "ext/octree/window_search.h"
#include "pbrt/core/parallel.h"
#include "pbrt/lightsamplers/weighted_choice.h"
#include "pbrt/math/rng.h"

namespace ext {

namespace {

constexpr uint64_t kStream = 0x77696e646f77, kRayStream = 0x736b79;
/// Where there are few vertices, up to kMaxPerVertex rays are traced from each of them to each sky, to have so many.
constexpr size_t kFewRays = 16384, kMaxPerVertex = 4 * kSkyRaysPerVertex;
/// Directions drawn for a ray at most. They are accepted with their cosine as the probability.
constexpr size_t kMaxDraws = 16;

/// The unit of G over that of the mean radiance.
Float PerMeanRadiance(const SkyLight &sky, double unit) {
    constexpr int kSide = 8;
    double sum = 0;
    int count = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
        const Point2 u((static_cast<Float>(i % kSide) + Float(0.5)) / kSide,
                       (static_cast<Float>(i / kSide) + Float(0.5)) / kSide);
        const std::optional<LightLiSample> s = sky.SampleLi({}, u, SampledWavelengths::WholeRange(), false, 0);
        const Float mean = s ? sky.MeanRadiance(s->wi) : 0;
        if (!(mean > 0)) continue;
        sum += RootMeanSquare(s->L) / static_cast<double>(mean);
        ++count;
    }
    return count > 0 ? static_cast<Float>(sum / count / unit) : 0;
}

/// The mean clamped cosine over a sphere around the window, as for lamps (EmitterPacket): 0 only where all of it is
/// below the horizon.
Float MeanCosine(const SkyWindow &window, const LightQuery &query) {
    if (query.ns == Normal3(0)) return Float(0.25);
    const Normal3 n = query.ns * (Dot(query.wo, query.ns) < 0 ? Float(-1) : Float(1));
    const Vector3 to = window.Middle() - query.p;
    const Float perDistance = 1 / std::max(Length(to), Float(1e-20f));
    Float c = Dot(n, to) * perDistance;
    if (query.transmits) c = std::abs(c);
    const Float s = std::min(Length(window.high - window.low) / 2 * perDistance, Float(1));
    return c >= s ? c : Sqr(std::max(c + s, Float(0))) / (4 * s);
}

/// Widens windows for rays that leave just past their borders, as some do that come from where little else is seen.
void Widen(std::span<SkyWindow> windows, std::span<const SkyRay> rays) {
    constexpr Float kNear = 0.15f, kMargin = 0.01f;  // of the window's size
    for (const SkyRay &ray : rays) {
        if (!ray.left) continue;
        SkyWindow *nearest = nullptr;
        Float least = kNear;
        Point2 where{};
        for (SkyWindow &window : windows) {
            const Vector3 p = window.frame.ToLocal(ray.p), d = window.frame.ToLocal(ray.d);
            if (!(window.low.z > p.z) || !(d.z > 0)) continue;
            const Point2 at = Point2(p) + Vector2(d) * ((window.low.z - p.z) / d.z);
            const Point2 past =
                glm::max(Point2(window.low) - at, at - Point2(window.high)) / Vector2(window.high - window.low);
            const Float most = std::max({past.x, past.y, Float(0)});
            if (!(most < least)) continue;
            least = most, nearest = &window, where = at;
        }
        if (!nearest || least == 0) continue;
        const Vector2 margin = Vector2(nearest->high - nearest->low) * kMargin;
        nearest->low = {glm::min(Point2(nearest->low), where - margin), nearest->low.z};
        nearest->high = {glm::max(Point2(nearest->high), where + margin), nearest->high.z};
    }
}

/// Windows without those that next to no ray passes; none if too many rays leave past all of them: what is sampled with
/// the rest of the sky, to which few samples go, makes fireflies. Rays from beyond all windows, as from an outer sill,
/// do not count: there all samples go to the rest.
std::vector<SkyWindow> WorthKeeping(std::span<const SkyWindow> windows, std::span<const SkyRay> rays) {
    constexpr double kMinShare = 0.01, kMaxPast = 0.02;
    // A few rays past them may be chance.
    constexpr double kAFew = 2;
    std::vector<double> passed(windows.size() + 1, 0);
    double left = 0;
    for (const SkyRay &ray : rays) {
        if (!ray.left) continue;
        size_t k = 0;
        while (k < windows.size() && !windows[k].IsPassed(ray.p, ray.d)) ++k;
        if (k == windows.size() &&
            std::ranges::none_of(windows, [&](const SkyWindow &window) { return window.IsBefore(ray.p); }))
            continue;
        ++passed[k], ++left;
    }
    std::vector<SkyWindow> kept;
    for (size_t k = 0; k < windows.size(); ++k) {
        if (passed[k] >= kMinShare * left)
            kept.push_back(windows[k]);
        else
            passed.back() += passed[k];
    }
    if (passed.back() > kMaxPast * left + kAFew) kept.clear();
    return kept;
}

}  // namespace

std::vector<SkyRay> TraceSkyRays(PrepareContext &context, std::span<const LightId> skies,
                                 std::span<const PrepassVertex> vertices, size_t count) {
    count = std::min(count, vertices.size());
    const size_t perVertex = std::clamp(kFewRays / std::max<size_t>(count, 1), kSkyRaysPerVertex, kMaxPerVertex);
    std::vector<std::vector<SkyRay>> raysFrom(count);
    context.progress.BeginPhase("rays to the sky", static_cast<int64_t>(count));
    ParallelForEach(static_cast<int64_t>(count), [&](int64_t i) {
        if (context.progress.Cancelled()) return;
        const PrepassVertex &vertex = vertices[static_cast<size_t>(i) * vertices.size() / count];
        const LightSampleContext &at = vertex.at;
        Rng rng(Hash(kRayStream, context.seed, i));
        for (const LightId sky : skies) {
            // An additive recurrence: any number of points is well spread.
            glm::dvec2 point = rng.Uniform2();
            size_t traced = 0;
            for (size_t k = 0; k < kMaxDraws * perVertex && traced < perVertex; ++k) {
                point = glm::fract(point + glm::dvec2(0.7548776662466927, 0.5698402909980532));
                const Point2 u = glm::min(Point2(point), Point2(OneMinusEpsilon));
                const Float chance = rng.Uniform();
                const std::optional<LightLiSample> s =
                    context.scene.Lights()[sky].SampleLi(at, u, SampledWavelengths::WholeRange(), false);
                if (!s) continue;
                Float cosine = Dot(s->wi, at.ns) * (Dot(vertex.wo, at.ns) < 0 ? Float(-1) : Float(1));
                if (vertex.transmits) cosine = std::abs(cosine);
                if (at.ns == Normal3(0)) cosine = Float(0.25);
                if (!(chance < cosine)) continue;
                raysFrom[static_cast<size_t>(i)].push_back({at.p, s->wi, !context.scene.Occluded(at, *s)});
                ++traced;
            }
        }
        context.progress.Advance();
    });
    context.progress.EndPhase();
    std::vector<SkyRay> rays;
    for (const std::vector<SkyRay> &some : raysFrom) rays.insert(rays.end(), some.begin(), some.end());
    return rays;
}

std::vector<LightId> WindowChoice::SkiesOf(const LightTable &lights) {
    std::vector<LightId> skies;
    for (const LightId sky : lights.Skies())
        if (skies.size() < kMaxSkies && lights.Candidate(sky).power > 0) skies.push_back(sky);
    return skies;
}

WindowChoice::WindowChoice(const LightTable &lights, std::span<const LightId> skies, Float floor)
    : lights_(lights), floor_(floor) {
    for (LightId id : skies) {
        const auto known = lights.Skies();
        OfSky sky;
        sky.index = static_cast<size_t>(std::find(known.begin(), known.end(), id) - known.begin());
        sky.whole = MakeEmitter(lights, id, lights.Candidate(id));
        sky.perMean = PerMeanRadiance(LightOf(sky), lights.Unit());
        skies_.push_back(sky);
    }
}

void WindowChoice::Use(std::vector<SkyWindow> windows) {
    windows_ = std::move(windows);
    for (OfSky &sky : skies_) {
        sky.windows = std::make_shared<const SkyWindows>(LightOf(sky), windows_);
        sky.set = LightOf(sky).AddWindows(sky.windows);
        if (!sky.set) return windows_.clear();
    }
}

bool WindowChoice::Find(PrepareContext &context, std::span<const SkyRay> rays,
                        std::span<const PrepassVertex> vertices) {
    std::vector<Normal3> normals;
    for (const PrepassVertex &vertex : vertices) normals.push_back(vertex.at.n);
    const std::vector<SkyWindow> found = FindWindows(rays, normals);
    std::vector<SkyWindow> refined = RefineWindows(context.scene, found, vertices, context.seed);
    Widen(refined, rays);
    std::vector<SkyWindow> windows = WorthKeeping(refined, rays);
    if (windows.empty() || context.progress.Cancelled()) return false;
    Use(std::move(windows));
    return !windows_.empty() && Learn(context, vertices);
}

void WindowChoice::Evaluate(const LightQuery &query, size_t k, Float *g) const {
    const OfSky &sky = skies_[k];
    for (size_t i = 0; i < windows_.size(); ++i) {
        g[i] = MeanCosine(windows_[i], query);
        if (g[i] > 0) g[i] *= sky.perMean * sky.windows->Integral(i, query.p);
        if (!std::isfinite(g[i])) g[i] = 0;
    }
    g[windows_.size()] = sky.whole.m0 > 0 ? EvaluateFar(sky.whole, query) : 0;
}

bool WindowChoice::Learn(PrepareContext &context, std::span<const PrepassVertex> vertices) {
    VisibilityRecords known;
    const size_t count = PartCount() * Count();
    std::vector<std::vector<VisibilityTry>> tries(vertices.size());
    ParallelFor(static_cast<int64_t>(vertices.size()), 64, [&](int64_t begin, int64_t end) {
        for (auto v = static_cast<size_t>(begin); v < static_cast<size_t>(end); ++v) {
            const LightQuery query = QueryAt(vertices[v]);
            Rng rng(Hash(kStream, context.seed, v));
            Float sum = 0, g[kMaxParts];
            for (size_t k = 0; k < Count(); ++k) {
                Evaluate(query, k, g);
                for (size_t i = 0; i < PartCount(); ++i) {
                    const Point2 u = rng.Uniform2();
                    if (!(g[i] > 0)) continue;
                    sum += g[i];
                    const auto ratio = static_cast<Float>(
                        VisibleContribution(context.scene, vertices[v], PartId(skies_[k], i), u) / double(g[i]));
                    tries[v].push_back(
                        {static_cast<uint32_t>(k * PartCount() + i), g[i], g[i], std::isfinite(ratio) ? ratio : 0});
                }
            }
            for (VisibilityTry &t : tries[v]) t.share = t.weight = t.share / sum;
        }
    });
    for (size_t v = 0; v < vertices.size(); ++v) {
        if (tries[v].empty()) continue;
        known.records.push_back(
            {vertices[v].at.p, static_cast<uint32_t>(known.tries.size()), static_cast<uint32_t>(tries[v].size())});
        known.tries.insert(known.tries.end(), tries[v].begin(), tries[v].end());
    }
    if (known.records.empty() || context.progress.Cancelled()) return false;
    VisibilityBuildSettings settings;
    settings.lightCount = static_cast<int>(count);
    settings.floor = floor_;
    VisibilityTreeBuilder builder(context.scene.Bounds(), known.records, known.tries, settings);
    std::optional<VisibilityTree> tree = builder.Build([&] { return context.progress.Cancelled(); });
    if (!tree) return false;
    tree_ = std::move(*tree);
    return true;
}

const WindowChoice::Weights *WindowChoice::Weigh(const LightQuery &query, LightMemory &memory) const {
    auto *at = memory.Make<Weights>();
    const VisibilityTree::Row row = tree_.RowAt(query.p);
    for (size_t k = 0; k < Count(); ++k) {
        Float g[kMaxParts], w[kMaxParts], sumG = 0, sumW = 0;
        Evaluate(query, k, g);
        for (size_t i = 0; i < PartCount(); ++i) {
            w[i] = g[i] * VisibilityTree::Decode(row.codes[k * PartCount() + i]);
            sumG += g[i], sumW += w[i];
        }
        at->g[k] = sumG;
        at->w[k] = sumW;
        // More arrives unoccluded from the rest than through all windows, so it would take nearly all of the floor.
        const size_t rest = PartCount() - 1;
        const Float ofWindows = sumG - g[rest], e = sumW > 0 ? floor_ : Float(1);
        const Float share = g[rest] > 0 && ofWindows > 0 ? e / 2 : e;
        const Float perW = sumW > 0 ? (1 - floor_) / sumW : 0, perG = ofWindows > 0 ? share / ofWindows : 0;
        for (size_t i = 0; i < rest; ++i) at->part[k][i] = w[i] * perW + g[i] * perG;
        at->part[k][rest] = w[rest] * perW + (g[rest] > 0 ? share : 0);
    }
    return at;
}

std::optional<SampledLight> WindowChoice::Sample(const Weights &weights, size_t k, Point2 *u) const {
    const Float *part = weights.part[k];
    const auto chosen = ChooseByWeight<Float>(PartCount(), u->x, [&](uint32_t i) { return part[i]; });
    if (!chosen) return {};
    u->x = std::clamp((u->x - chosen.before) / chosen.weight, Float(0), OneMinusEpsilon);
    return SampledLight{PartId(skies_[k], chosen.index), chosen.weight};
}

Float WindowChoice::PMF(const Weights &weights, size_t k, LightId light) const {
    if (!lights_.IsSkyPart(light)) return 0;
    const uint32_t number = lights_.NumberOf(light);
    if (SkyPart::SetOf(number) != *skies_[k].set) return 0;
    const size_t place = SkyPart::PlaceOf(number);
    return place < PartCount() ? weights.part[k][place] : 0;
}

std::vector<LightId> WindowChoice::PartsOf(size_t k) const {
    std::vector<LightId> ids;
    for (size_t i = 0; i < PartCount(); ++i) ids.push_back(PartId(skies_[k], i));
    return ids;
}

void WindowChoice::Save(StateWriter &writer) const {
    writer.CopyOfVector(windows_);
    tree_.Save(writer);
}

void WindowChoice::Load(StateReader &reader) {
    std::vector<SkyWindow> windows;
    reader.Vector(&windows);
    reader.Require(!windows.empty() && windows.size() <= SkyWindows::kMax, "it has a wrong number of windows");
    for (const SkyWindow &window : windows) reader.RequireValid(window.Validate());
    Use(std::move(windows));
    if (windows_.empty()) throw UserError(fmt::format("{}: too many sets of windows are in use.", reader.What()));
    tree_.Load(reader);
    reader.Require(tree_.RowCount() > 0, "nothing is known of its windows");
    for (uint32_t row = 0; row < tree_.RowCount(); ++row)
        reader.Require(tree_.GetRow(row).codes.size() == PartCount() * Count() && tree_.GetRow(row).nodes.empty(),
                       "a row of an octree is not of all windows");
}

void WindowChoice::Report(nlohmann::ordered_json &report) const {
    report["skyWindows"] = windows_.size();
    report["skyBytes"] = Bytes();
}

void WindowChoice::Inspect(const Point3 &p, std::vector<InspectedValue> &values) const {
    const uint32_t cell = tree_.Cells().CellAt(p).row;
    const VisibilityTree::Row row = tree_.GetRow(cell);
    values.push_back({"sky cell", static_cast<double>(cell), true});
    for (size_t i = 0; i < PartCount(); ++i)
        values.push_back({i < windows_.size() ? fmt::format("window {} seen", i) : std::string("rest of the sky seen"),
                          static_cast<double>(VisibilityTree::Decode(row.codes[i])), false});
}

std::string WindowChoice::Describe() const {
    std::string text =
        fmt::format("windows: {}, {} leaves know which of them are seen\n", windows_.size(), tree_.LeafCount());
    for (const SkyWindow &w : windows_) {
        const Vector3 sides = w.high - w.low;
        const Point3 middle = w.Middle();
        text += fmt::format("  {:.3g} by {:.3g}, its middle at ({:.4g}, {:.4g}, {:.4g})\n", sides.x, sides.y, middle.x,
                            middle.y, middle.z);
    }
    return text;
}

size_t WindowChoice::Bytes() const {
    size_t bytes = tree_.Bytes();
    for (const OfSky &sky : skies_)
        if (sky.windows) bytes += sky.windows->Bytes();
    return bytes;
}

}  // namespace ext
