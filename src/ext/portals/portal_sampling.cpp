#include "ext/portals/portal_sampling.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "ext/visibility/visibility_tree_builder.h"
#include "pbrt/core/parallel.h"
#include "pbrt/core/progress.h"
#include "pbrt/lightsamplers/weighted_choice.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"

namespace ext {
namespace {

constexpr uint64_t kStream = 0x77696e646f77, kRayStream = 0x736b79;
/// Above this fraction of environment rays that leave the scene, no portals are searched: outdoors, there are none.
constexpr double kMaxSeen = 0.3;
constexpr size_t kSearchVertices = 4096;  ///< maximum number of prepass vertices for detection

/// With few vertices, up to kMaxPerVertex rays per vertex and light are traced to reach kSearchRays.
constexpr size_t kSearchRays = 16384, kMaxPerVertex = 4 * PortalSampling::kRaysPerLight;
constexpr size_t kFewVertices = kSearchVertices / 16, kFewRays = kSearchRays / 4;  ///< for a test of outdoors
constexpr size_t kMaxDraws = 16;  ///< maximum draws per ray; accepted with probability equal to the cosine

/// Unit of G over that of the mean radiance.
Float PerMeanRadiance(const EnvironmentLight &light, double unit) {
    constexpr int kSide = 8;
    double sum = 0;
    int count = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
        const Point2 u((Float(i % kSide) + Float(0.5)) / kSide, (Float(i / kSide) + Float(0.5)) / kSide);
        const std::optional<LightLiSample> s = light.SampleLi({}, u, SampledWavelengths::WholeRange(), false, 0);
        const Float mean = s ? light.MeanRadiance(s->wi) : 0;
        if (!(mean > 0)) continue;
        sum += RootMeanSquare(s->L) / double(mean);
        ++count;
    }
    return count > 0 ? Float(sum / count / unit) : 0;
}

/// Mean clamped cosine over the portal's bounding sphere, as for local lights (EmitterPacket): 0 only where the sphere
/// is entirely below the horizon.
Float MeanCosine(const Portal &portal, const LightQuery &query) {
    if (query.ns == Normal3(0)) return Float(0.25);
    const Normal3 n = query.ns * (Dot(query.wo, query.ns) < 0 ? Float(-1) : Float(1));
    const Vector3 to = portal.Middle() - query.p;
    const Float perDistance = 1 / std::max(Length(to), Float(1e-20f));
    Float c = Dot(n, to) * perDistance;
    if (query.transmits) c = std::abs(c);
    const Float s = std::min(Length(portal.high - portal.low) / 2 * perDistance, Float(1));
    return c >= s ? c : Sqr(std::max(c + s, Float(0))) / (4 * s);
}

/// Evenly over the directions of positive radiance, without L and pdf; empty in the others.
std::optional<LightLiSample> SampleEvenly(const EnvironmentLight &light, const Point3 &p, const Point2 &u) {
    const Vector3 wi = SampleUniformSphere(u);
    if (!(light.MeanRadiance(wi) > 0)) return {};
    return LightLiSample{.L = {}, .wi = wi, .pLight = light.PointOutside(p, wi)};
}

/// Traces about `minRays` rays, or more, towards each environment light from `count` of the vertices (at most all),
/// spread over the image. Directions are proportional to cosine times radiance or, if `evenly`, to the cosine where
/// there is radiance. Depends on the seed only.
std::vector<EnvironmentRay> TraceEnvironmentRays(PrepareContext &context, std::span<const LightId> lights,
                                                 std::span<const PrepassVertex> vertices, size_t count, size_t minRays,
                                                 bool evenly = false) {
    count = std::min(count, vertices.size());
    const size_t perVertex =
        std::clamp(minRays / std::max<size_t>(count, 1), PortalSampling::kRaysPerLight, kMaxPerVertex);
    std::vector<std::vector<EnvironmentRay>> raysFrom(count);
    context.progress.BeginPhase("rays to environment lights", int64_t(count));
    ParallelForEach(int64_t(count), [&](int64_t i) {
        if (context.progress.Cancelled()) return;
        const PrepassVertex &vertex = vertices[size_t(i) * vertices.size() / count];
        const LightSampleContext &at = vertex.at;
        Rng rng(Hash(kRayStream, context.seed, i));
        for (const LightId light : lights) {
            // Additive recurrence: well distributed for any number of points.
            glm::dvec2 point = rng.Uniform2();
            size_t traced = 0;
            for (size_t k = 0; k < kMaxDraws * perVertex && traced < perVertex; ++k) {
                point = glm::fract(point + glm::dvec2(0.7548776662466927, 0.5698402909980532));
                const Point2 u = glm::min(Point2(point), Point2(OneMinusEpsilon));
                const Float chance = rng.Uniform();
                const LightComponent from = context.scene.Lights()[light];
                const std::optional<LightLiSample> s =
                    evenly ? SampleEvenly(*from.Parent().AsEnvironment(), at.p, u)
                           : from.SampleLi(at, u, SampledWavelengths::WholeRange(), false);
                if (!s) continue;
                Float cosine = Dot(s->wi, at.ns) * (Dot(vertex.wo, at.ns) < 0 ? Float(-1) : Float(1));
                if (vertex.transmits) cosine = std::abs(cosine);
                if (at.ns == Normal3(0)) cosine = Float(0.25);
                if (!(chance < cosine)) continue;
                raysFrom[size_t(i)].push_back({at.p, s->wi, !context.scene.Occluded(at, *s)});
                ++traced;
            }
        }
        context.progress.Advance();
    });
    context.progress.EndPhase();
    std::vector<EnvironmentRay> rays;
    for (const std::vector<EnvironmentRay> &some : raysFrom) rays.insert(rays.end(), some.begin(), some.end());
    return rays;
}

/// Leaves out the rays of points from which at least half leave the scene: outdoors, no portal is needed.
std::vector<EnvironmentRay> FromIndoors(std::span<const EnvironmentRay> rays) {
    std::vector<EnvironmentRay> indoors;
    for (size_t begin = 0, end = 0; begin < rays.size(); begin = end) {
        size_t left = 0;
        for (; end < rays.size() && rays[end].p == rays[begin].p; ++end) left += rays[end].left;
        if (2 * left < end - begin) indoors.insert(indoors.end(), rays.begin() + begin, rays.begin() + end);
    }
    return indoors;
}

/// Extends portals to rays that leave just outside their borders.
void Widen(std::span<Portal> portals, std::span<const EnvironmentRay> rays) {
    constexpr Float kNear = 0.15f, kMargin = 0.01f;  // relative to the portal's size
    for (const EnvironmentRay &ray : rays) {
        if (!ray.left) continue;
        Portal *nearest = nullptr;
        Float least = kNear;
        Point2 where{};
        for (Portal &portal : portals) {
            const Vector3 p = portal.frame.ToLocal(ray.p), d = portal.frame.ToLocal(ray.d);
            if (!(portal.low.z > p.z) || !(d.z > 0)) continue;
            const Point2 at = Point2(p) + Vector2(d) * ((portal.low.z - p.z) / d.z);
            const Point2 past =
                glm::max(Point2(portal.low) - at, at - Point2(portal.high)) / Vector2(portal.high - portal.low);
            const Float most = std::max({past.x, past.y, Float(0)});
            if (!(most < least)) continue;
            least = most, nearest = &portal, where = at;
        }
        if (!nearest || least == 0) continue;
        const Vector2 margin = Vector2(nearest->high - nearest->low) * kMargin;
        nearest->low = {glm::min(Point2(nearest->low), where - margin), nearest->low.z};
        nearest->high = {glm::max(Point2(nearest->high), where + margin), nearest->high.z};
    }
}

/// Removes portals that hardly any ray passes. Rays from beyond all portals, as from an outer sill, do not count.
std::vector<Portal> Kept(std::span<const Portal> portals, std::span<const EnvironmentRay> rays) {
    constexpr double kMinShare = 0.01;
    std::vector<double> passed(portals.size(), 0);
    double left = 0;
    for (const EnvironmentRay &ray : rays) {
        if (!ray.left) continue;
        const auto first = std::ranges::find_if(portals, [&](const Portal &p) { return p.IsPassed(ray.p, ray.d); });
        if (first != portals.end()) ++passed[size_t(first - portals.begin())];
        else if (std::ranges::none_of(portals, [&](const Portal &p) { return p.IsBefore(ray.p); })) continue;
        ++left;
    }
    std::vector<Portal> result;
    for (size_t k = 0; k < portals.size(); ++k)
        if (passed[k] >= kMinShare * left) result.push_back(portals[k]);
    return result;
}

std::vector<Portal> PortalsOf(std::vector<EnvironmentRay> rays, const PrepareContext &context,
                              std::span<const PrepassVertex> vertices) {
    rays = FromIndoors(rays);
    std::vector<Normal3> normals;
    for (const PrepassVertex &vertex : vertices) normals.push_back(vertex.at.n);
    std::vector<Portal> portals = RefinePortals(context.scene, FindPortals(rays, normals), vertices, context.seed);
    Widen(portals, rays);
    return Kept(portals, rays);
}

}  // namespace

PortalSampling::PortalSampling(const LightGroups &groups, const std::string &mode, Float floor)
    : lights_(groups.Lights()), isOnTrial_(mode == "auto"), floor_(floor) {
    if (mode == "never") return;
    for (const LightId id : lights_.Environments()) {
        if (environments_.size() == kMaxLights || !(lights_.Candidate(id).power > 0)) continue;
        const EnvironmentLight *light = lights_[id].Parent().AsEnvironment();
        ids_.push_back(id);
        environments_.push_back({.id = id,
                                 .group = groups.GroupOf(id),
                                 .light = light,
                                 .whole = MakeEmitter(lights_, id, lights_.Candidate(id)),
                                 .perMean = PerMeanRadiance(*light, lights_.Unit())});
    }
}

void PortalSampling::Clear() {
    count_ = 0;
    isActive_ = false;
    for (Environment &e : environments_) e.portals.reset();
}

void PortalSampling::Use(std::span<const Portal> portals) {
    count_ = portals.size();
    isActive_ = count_ > 0;
    for (Environment &e : environments_) e.portals.emplace(*e.light, portals);
}

void PortalSampling::Find(PrepareContext &context, std::span<const PrepassVertex> vertices) {
    const auto start = std::chrono::steady_clock::now();
    std::vector<EnvironmentRay> rays;
    const auto isSeenMoreThan = [&](double share, size_t count, size_t minRays) {
        rays = TraceEnvironmentRays(context, ids_, vertices, count, minRays);
        const auto left = std::ranges::count_if(rays, [](const EnvironmentRay &ray) { return ray.left; });
        seenShare_ = double(left) / double(std::max<size_t>(rays.size(), 1));
        return context.progress.Cancelled() || seenShare_ > share;
    };
    if (!isSeenMoreThan(2 * kMaxSeen, kFewVertices, kFewRays) &&
        !isSeenMoreThan(kMaxSeen, kSearchVertices, kSearchRays)) {
        std::vector<Portal> portals = PortalsOf(std::move(rays), context, vertices);
        // Most of the radiance may be a sun that does not enter.
        if (portals.empty() && !context.progress.Cancelled())
            portals = PortalsOf(TraceEnvironmentRays(context, ids_, vertices, kSearchVertices, kSearchRays, true),
                                context, vertices);
        if (!portals.empty() && !context.progress.Cancelled()) Use(portals);
        if (IsActive() && !Learn(context, vertices)) Clear();
    }
    seconds_ = SecondsSince(start);
}

void PortalSampling::Evaluate(const LightQuery &query, const Environment &e, Float *g) const {
    for (size_t i = 0; i < count_; ++i) {
        g[i] = MeanCosine((*e.portals)[i], query);
        if (g[i] > 0) g[i] *= e.perMean * e.portals->IntegralAround(i, query.p);
        if (!std::isfinite(g[i])) g[i] = 0;
    }
    g[count_] = e.whole.m0 > 0 ? EvaluateFar(e.whole, query) : 0;
}

double PortalSampling::CostPerVertex(const Scene &scene) const {
    // Fitted to CPU times (as of docs/measured/choices) of blinds, sunny-room, corridor, dining-room and classroom,
    // with 1 to 5 portals: the cost of a vertex grows with the number of primitives; that of portals does not, and
    // hardly with their number.
    double primitives = 0;
    for (uint32_t i = 0; i < scene.ShapeCount(); ++i) primitives += scene.ShapeOf(ShapeId(i)).PrimitiveCount();
    const double vertex = 1 + 0.08 * std::max(std::log2(primitives / 500), 0.0);
    return (0.7 + 0.03 * double(count_)) * double(environments_.size()) / vertex;
}

bool PortalSampling::EndTrial(const TrialRatio &result) {
    trial_ = result;
    const bool pays = result.Gain() > 1;
    if (!pays) Clear();
    return pays;
}

bool PortalSampling::Learn(PrepareContext &context, std::span<const PrepassVertex> vertices) {
    std::vector<std::vector<ShadowRay>> traced(vertices.size());
    ParallelForEach(int64_t(vertices.size()), 64, [&](int64_t v) {
        const PrepassVertex &vertex = vertices[v];
        const LightQuery query = QueryAt(vertex);
        Rng rng(Hash(kStream, context.seed, v));
        Float sum = 0, g[kMaxRegions];
        // One shadow ray to each region of each light.
        for (size_t k = 0; k < Count(); ++k) {
            const Environment &e = environments_[k];
            Evaluate(query, e, g);
            for (size_t i = 0; i < RegionCount(); ++i) {
                const Point2 u = rng.Uniform2();
                if (!(g[i] > 0)) continue;
                sum += g[i];
                const LightComponent region = lights_.Region(e.id, RegionOf(e, i));
                const auto ratio = Float(VisibleContribution(context.scene, vertex, region, u) / double(g[i]));
                traced[v].push_back({uint32_t(k * RegionCount() + i), g[i], g[i], std::isfinite(ratio) ? ratio : 0});
            }
        }
        for (ShadowRay &ray : traced[v]) ray.share = ray.weight = ray.share / sum;
    });
    VisibilityRecords records;
    for (size_t v = 0; v < vertices.size(); ++v) {
        if (traced[v].empty()) continue;
        records.records.push_back({vertices[v].at.p, uint32_t(records.rays.size()), uint32_t(traced[v].size())});
        records.rays.insert(records.rays.end(), traced[v].begin(), traced[v].end());
    }
    if (records.records.empty() || context.progress.Cancelled()) return false;
    VisibilityBuildSettings settings;
    settings.lightCount = int(RegionCount() * Count());
    settings.floor = floor_;
    VisibilityTreeBuilder builder(context.scene.Bounds(), records.records, records.rays, settings);
    std::optional<VisibilityTree> tree = builder.Build([&] { return context.progress.Cancelled(); });
    if (!tree) return false;
    tree_ = std::move(*tree);
    return true;
}

const PortalSampling::Weights *PortalSampling::Weigh(const LightQuery &query, LightMemory &memory) const {
    auto *at = memory.Make<Weights>();
    const VisibilityTree::Row row = tree_.RowAt(query.p);
    for (size_t k = 0; k < Count(); ++k) {
        Float g[kMaxRegions], w[kMaxRegions], sumG = 0, sumW = 0;
        Evaluate(query, environments_[k], g);
        for (size_t i = 0; i < RegionCount(); ++i) {
            w[i] = g[i] * VisibilityTree::Decode(row.codes[k * RegionCount() + i]);
            sumG += g[i], sumW += w[i];
        }
        at->g[k] = sumG;
        at->w[k] = sumW;
        // Unoccluded, the remainder exceeds all portals, so it would take nearly all of the floor.
        const size_t rest = count_;
        const Float ofPortals = sumG - g[rest], e = sumW > 0 ? floor_ : Float(1);
        const Float share = g[rest] > 0 && ofPortals > 0 ? e / 2 : e;
        const Float perW = sumW > 0 ? (1 - floor_) / sumW : 0, perG = ofPortals > 0 ? share / ofPortals : 0;
        for (size_t i = 0; i < rest; ++i) at->region[k][i] = w[i] * perW + g[i] * perG;
        at->region[k][rest] = w[rest] * perW + (g[rest] > 0 ? share : 0);
    }
    return at;
}

std::optional<SampledLight> PortalSampling::Sample(const Weights &weights, size_t k, Point2 *u) const {
    const Float *region = weights.region[k];
    const auto chosen = ChooseByWeight<Float>(RegionCount(), u->x, [&](uint32_t i) { return region[i]; });
    if (!chosen) return {};
    u->x = std::clamp((u->x - chosen.before) / chosen.weight, Float(0), OneMinusEpsilon);
    const Environment &e = environments_[k];
    return SampledLight{.light = e.id, .pmf = chosen.weight, .region = RegionOf(e, chosen.index)};
}

SampledLight PortalSampling::Towards(const Weights &weights, size_t k, const Point3 &p, const Vector3 &d) const {
    const Environment &e = environments_[k];
    const size_t region = e.portals->RegionTowards(p, d);
    return {.light = e.id, .pmf = weights.region[k][region], .region = RegionOf(e, region)};
}

void PortalSampling::Save(StateWriter &out) const {
    out(uint64_t{count_});
    for (size_t i = 0; i < count_; ++i) out((*environments_[0].portals)[i]);
    out(seconds_, seenShare_, trial_, tree_);
}

void PortalSampling::Load(StateReader &in) {
    std::vector<Portal> portals;
    in(portals);
    in.Require(portals.size() <= EnvironmentPortals::kMax, "it has too many portals");
    in.Require(portals.empty() || !environments_.empty(), "it has portals of an environment light that has none here");
    for (const Portal &portal : portals) in.RequireValid(portal.Validate());
    Clear();
    in(seconds_, seenShare_, trial_, tree_);
    if (portals.empty()) return;
    Use(portals);
    in.Require(tree_.RowCount() > 0, "its portals have no visibility");
    for (uint32_t row = 0; row < tree_.RowCount(); ++row)
        in.Require(tree_.GetRow(row).codes.size() == RegionCount() * Count() && tree_.GetRow(row).nodes.empty(),
                   "a row of an octree is not of all portals");
}

void PortalSampling::Report(nlohmann::ordered_json &report) const {
    if (!(seconds_ > 0)) return;
    report["environmentSeenShare"] = seenShare_;
    report["environmentSeconds"] = seconds_;
    if (trial_.WasTried()) trial_.Report(report["portalTrial"]);
    if (!IsActive()) return;
    report["portals"] = count_;
    report["portalBytes"] = Bytes();
}

void PortalSampling::Inspect(const Point3 &p, std::vector<InspectedValue> &values) const {
    if (!IsActive()) return;
    const uint32_t cell = tree_.Cells().CellAt(p).row;
    const VisibilityTree::Row row = tree_.GetRow(cell);
    values.push_back({"portal cell", double(cell), true});
    for (size_t i = 0; i < RegionCount(); ++i)
        values.push_back({i < count_ ? fmt::format("portal {} seen", i) : std::string("rest of the environment seen"),
                          double(VisibilityTree::Decode(row.codes[i])), false});
}

std::string PortalSampling::Describe() const {
    std::string text;
    if (trial_.WasTried())
        text = fmt::format("portals on trial: error {:.3g}, cost {:.3g}, gain {:.3g}\n", trial_.error, trial_.cost,
                           trial_.Gain());
    if (!IsActive()) return text;
    text += fmt::format("portals: {}, with visibility in {}\n", count_, CountText(tree_.LeafCount(), "leaf", "leaves"));
    for (size_t i = 0; i < count_; ++i) {
        const Portal &portal = (*environments_[0].portals)[i];
        const Vector3 sides = portal.high - portal.low;
        const Point3 middle = portal.Middle();
        text += fmt::format("  {:.3g} by {:.3g}, centre ({:.4g}, {:.4g}, {:.4g})\n", sides.x, sides.y, middle.x,
                            middle.y, middle.z);
    }
    return text;
}

size_t PortalSampling::Bytes() const {
    size_t bytes = tree_.Bytes();
    for (const Environment &e : environments_)
        if (e.portals) bytes += e.portals->Bytes();
    return bytes;
}

}  // namespace ext
