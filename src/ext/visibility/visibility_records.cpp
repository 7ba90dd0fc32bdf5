#include "ext/visibility/visibility_records.h"

namespace ext {
namespace {

constexpr size_t kMaxScanned = 64;
constexpr int64_t kChunk = 256;
/// Part of the drawn shadow rays that ignores G, as nearly all G may be that of a sun behind a wall.
constexpr Float kUniformDraws = 0.125f;

/// Contribution of a group from one light sample, as in the render: incident light over the light's share of the group.
double SampleGroup(const Scene &scene, const PrepassVertex &vertex, const LightQuery &query,
                   const MeshInterior &interior, uint32_t group, Rng &rng) {
    Float uLight = rng.Uniform();
    Point2 u = rng.Uniform2();
    std::optional<SampledLight> light = interior.Sample(group, query, uLight);
    if (!light) return 0;
    return VisibleContribution(scene, vertex, scene.Lights()[light->light], u) / double(light->pmf);
}

Float RatioOf(double contribution, Float g) {
    const auto ratio = Float(contribution / double(g));
    return std::isfinite(ratio) ? ratio : 0;
}

bool IsMine(const Team &team, int64_t chunk) { return chunk % team.Size() == team.Rank(); }

/// Traces the shadow rays of vertices; see TraceVisibility.
struct ShadowRayTracer {
    const Scene &scene;
    const size_t groups;
    const GroupImportance &importance;
    const MeshInterior &interior;
    const LightTree *tree;
    const size_t perRecord;

    /// Appends a record, unless no group could contribute. `g`: memory that calls reuse.
    void Trace(const PrepassVertex &vertex, Rng &rng, std::vector<Float> &g, VisibilityRecords &out) const {
        const LightQuery query = QueryAt(vertex);
        const size_t first = out.rays.size();
        if (perRecord >= groups) TraceToAll(vertex, query, rng, g, out.rays);
        else TraceToDrawn(vertex, query, rng, out.rays);
        if (out.rays.size() > first)
            out.records.push_back({vertex.at.p, uint32_t(first), uint32_t(out.rays.size() - first)});
    }
    void TraceToAll(const PrepassVertex &vertex, const LightQuery &query, Rng &rng, std::vector<Float> &g,
                    std::vector<ShadowRay> &rays) const {
        g.resize(importance.Padded());
        const Float sum = importance.Evaluate(query, g);
        if (!(sum > 0)) return;
        for (uint32_t i = 0; i < groups; ++i) {
            if (!(g[i] > 0)) continue;
            Float share = g[i] / sum;
            const double contribution = SampleGroup(scene, vertex, query, interior, i, rng);
            rays.push_back({i, share, share, RatioOf(contribution, g[i])});
        }
    }
    void TraceToDrawn(const PrepassVertex &vertex, const LightQuery &query, Rng &rng,
                      std::vector<ShadowRay> &rays) const {
        const size_t first = rays.size();
        static_assert(LightTree::kBaseNodes + LightTree::kFarNodes <= kMaxScanned);
        alignas(32) Float weights[kMaxScanned];
        const std::span<const uint32_t> nodes = tree ? tree->BaseCut() : std::span<const uint32_t>();
        const size_t count = tree ? nodes.size() : importance.Size();
        const Float sum = tree ? tree->Evaluate(query, nodes, weights) : importance.Evaluate(query, weights);
        const std::span<Float> probabilities(weights, count);
        const auto positive = Float(std::ranges::count_if(probabilities, [](Float w) { return w > 0; }));
        for (Float &p : probabilities)
            if (p > 0) p = (1 - kUniformDraws) * p / sum + kUniformDraws / positive;
        const auto draw = [&](Float u) -> std::optional<SampledLight> {
            const auto chosen = ChooseByWeight<Float>(count, u, [&](uint32_t i) { return weights[i]; });
            if (!chosen) return {};
            const Float p = chosen.weight;
            if (!tree) return SampledLight{LightId(chosen.index), p};
            std::optional<SampledLight> light = tree->SampleWithin(
                nodes[chosen.index], query, std::clamp((u - chosen.before) / p, Float(0), OneMinusEpsilon));
            if (light) light->pmf *= p;
            return light;
        };
        double total = 0;
        for (size_t k = 0; k < perRecord; ++k) {
            // Stratified in `perRecord` equal strata.
            const Float u = (Float(k) + rng.Uniform()) / Float(perRecord);
            std::optional<SampledLight> drawn = draw(std::min(u, OneMinusEpsilon));
            if (!drawn) continue;
            const Float g = importance.Of(query, drawn->light.value);
            if (!(g > 0)) continue;
            const double contribution = SampleGroup(scene, vertex, query, interior, drawn->light.value, rng);
            total += double(g / drawn->pmf);
            rays.push_back({drawn->light.value, g, g / drawn->pmf, RatioOf(contribution, g)});
        }
        const double unoccluded = total / double(perRecord);
        for (size_t t = first; t < rays.size(); ++t) {
            rays[t].share = Float(double(rays[t].share) / unoccluded);
            rays[t].weight = Float(double(rays[t].weight) / total);
        }
    }
};

void Exchange(Team &team, std::vector<VisibilityRecords> &chunks) {
    std::vector<bool> isHere(chunks.size());
    for (size_t i = 0; i < chunks.size(); ++i) isHere[i] = IsMine(team, i);
    team.AllReduce(
        [&](StateWriter &out) {
            out(uint64_t(std::count(isHere.begin(), isHere.end(), true)));
            for (uint64_t i = 0; i < chunks.size(); ++i)
                if (isHere[i]) out(i, chunks[i]);
        },
        [&](StateReader &in) {
            for (auto count = in.Value<uint64_t>(); count > 0; --count) {
                const auto i = in.Value<uint64_t>();
                in.Require(i < chunks.size(), "a chunk of the records has a wrong number");
                in(chunks[i]);
                isHere[i] = true;
            }
        });
}

/// The records of all chunks in order; empties the chunks.
VisibilityRecords Concatenate(std::vector<VisibilityRecords> &chunks) {
    VisibilityRecords result;
    for (VisibilityRecords &chunk : chunks) {
        const auto offset = uint32_t(result.rays.size());
        for (VisibilityRecord &r : chunk.records) {
            r.firstRay += offset;
            result.records.push_back(r);
        }
        result.rays.insert(result.rays.end(), chunk.rays.begin(), chunk.rays.end());
        chunk = {};
    }
    return result;
}

}  // namespace

std::optional<std::string> VisibilityRecords::ValidateFor(size_t groups, const LightTree *lights) const {
    size_t next = 0;
    for (const VisibilityRecord &r : records) {
        if (r.firstRay != next || r.rayCount == 0 || r.rayCount > rays.size() - next)
            return "the shadow rays of records do not follow each other";
        if (!IsFinite(r.p)) return "the position of a record is not finite";
        next += r.rayCount;
    }
    if (next != rays.size()) return "shadow rays without a record";
    for (const ShadowRay &t : rays) {
        if (t.light >= groups || (lights && lights->PositionOf(t.light) == LightTree::kNowhere))
            return "a shadow ray goes to a light that does not exist";
        if (!IsPositive(t.share) || !IsPositive(t.weight) || !IsPositive(t.ratio))
            return "the contribution of a shadow ray is not finite";
    }
    return {};
}

size_t RaysPerRecord(size_t groups, int wanted) {
    if (wanted > 0) return std::min(groups, size_t(wanted));
    return groups <= kMaxScanned ? groups : 8;
}

VisibilityRecords TraceVisibility(PrepareContext &context, std::span<const PrepassVertex> vertices,
                                  const LightGroups &groups, const GroupImportance &importance,
                                  const MeshInterior &interior, const LightTree *tree, size_t perRecord) {
    const auto count = int64_t(vertices.size());
    if (vertices.size() > std::numeric_limits<uint32_t>::max() / std::max<size_t>(perRecord, 1))
        throw UserError(
            "octree: the prepass has {} vertices, each with {} shadow rays; more than {} shadow "
            "rays cannot be stored. Lower \"prepassspp\" or \"tries\".",
            vertices.size(), perRecord, std::numeric_limits<uint32_t>::max());
    std::vector<VisibilityRecords> chunks((count + kChunk - 1) / kChunk);
    context.progress.BeginPhase("shadow rays", chunks.size());
    const ShadowRayTracer tracer{context.scene, groups.Size(), importance, interior, tree, perRecord};
    ParallelForEach(chunks.size(), [&](int64_t chunk) {
        if (context.progress.Cancelled() || !IsMine(context.team, chunk)) return;
        std::vector<Float> g;
        for (int64_t i = chunk * kChunk; i < std::min((chunk + 1) * kChunk, count); ++i) {
            Rng rng(Hash(uint64_t(0x7669736962), context.seed, i));
            tracer.Trace(vertices[i], rng, g, chunks[chunk]);
        }
        context.progress.Advance();
    });
    Exchange(context.team, chunks);
    VisibilityRecords result = Concatenate(chunks);
    context.progress.EndPhase();
    return result;
}

}  // namespace ext
