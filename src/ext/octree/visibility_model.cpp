#include "ext/octree/visibility_model.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

namespace ext {
namespace {

/// Sample counts per pixel after which the trees are rebuilt, if at least three times as many samples follow.
constexpr int kUpdateAfter[] = {1, 4, 16, 64};
constexpr size_t kMaxRecorded = 400000;  ///< maximum shadow rays of the render recorded between two updates

}  // namespace

VisibilityModel::Render VisibilityModel::RenderOf(const PrepareContext &context) const {
    return {context.pixelBounds, context.samplesPerPixel, params_.PrepassDepth(context.maxDepth)};
}

void VisibilityModel::Learn(PrepareContext &context, std::span<PrepassVertex> vertices,
                            const GroupImportance &importance, const MeshInterior &interior) {
    bounds_ = context.scene.Bounds();
    render_ = RenderOf(context);
    const auto media =
        std::stable_partition(vertices.begin(), vertices.end(), [](const PrepassVertex &v) { return !v.phase; });
    const auto trace = [&](auto begin, auto end) {
        return TraceVisibility(context, {begin, end}, groups_, importance, interior, lights_, RaysPerVertex());
    };
    onSurfaces_.records = trace(vertices.begin(), media);
    if (media != vertices.end()) inMedia_.records = trace(media, vertices.end());
    counts_.prepassRecords = onSurfaces_.records.records.size() + inMedia_.records.records.size();
    counts_.prepassRays = RayCount();
    if (context.progress.Cancelled()) return;

    const auto start = std::chrono::steady_clock::now();
    context.progress.BeginPhase("octree", 0);
    if (Build(params_.records, context.progress)) BeginRecording(0);
    counts_.buildSeconds = SecondsSince(start);
    context.progress.EndPhase();
}

std::optional<VisibilityModel::Estimate> VisibilityModel::Built(const VisibilityRecords &from, int records,
                                                                const Progress &progress) const {
    if (from.records.empty()) return Estimate();
    const VisibilityBuildSettings settings{.lightCount = int(groups_.Size()),
                                           .lights = lights_,
                                           .cut = params_.cut,
                                           .records = records,
                                           .raysPerRecord = int(RaysPerVertex()),
                                           .shrinkage = params_.shrinkage,
                                           .pruneGain = params_.prunegain,
                                           .secondMoment = params_.secondmoment,
                                           .floor = floor_};
    VisibilityTreeBuilder builder(bounds_, from.records, from.rays, settings);
    std::optional<VisibilityTree> tree = builder.Build([&] { return progress.Cancelled(); });
    if (!tree) return {};
    return Estimate{{}, std::move(*tree), builder.Leaves(), builder.RecordsPerNode(), builder.LeavesBeforePruning()};
}

bool VisibilityModel::Build(int records, const Progress &progress) {
    std::optional<Estimate> surfaces = Built(onSurfaces_.records, records, progress);
    std::optional<Estimate> media = surfaces ? Built(inMedia_.records, records, progress) : std::nullopt;
    if (!surfaces || !media) return false;
    surfaces->records = std::move(onSurfaces_.records);
    media->records = std::move(inMedia_.records);
    onSurfaces_ = std::move(*surfaces);
    inMedia_ = std::move(*media);
    return true;
}

void VisibilityModel::BeginRecording(int first) {
    const auto next = std::ranges::upper_bound(kUpdateAfter, first);
    nextUpdate_ = IsUpdated() && next != std::end(kUpdateAfter) && 4 * *next <= render_.samplesPerPixel ? *next : 0;
    if (nextUpdate_ == 0) {
        rendered_.End();
        onSurfaces_.records = inMedia_.records = {};
        return;
    }
    const auto vertices = size_t(render_.depth);
    paths_ = RecordedPaths(render_.pixels, first, nextUpdate_, kMaxRecorded / vertices);
    rendered_.Begin(paths_.Count(), vertices);
}

void VisibilityModel::RecordLightSample(PathPlaces &path, const LightQuery &query, const SampledLight &light,
                                        const SampledSpectrum &irradiance) {
    if (path.next >= path.end || !(light.unoccluded > 0)) return;
    const auto ratio = Float(RootMeanSquare(irradiance) / groups_.Lights().Unit() / double(light.unoccluded));
    const Float weight = light.weight / Float(RaysPerVertex());
    if (!std::isfinite(ratio) || !std::isfinite(weight)) return;
    rendered_.Add(path, {query.p, query.ns == Normal3(0), {groups_.GroupOf(light.light), weight, weight, ratio}});
}

void VisibilityModel::AppendRendered(VisibilityRecords *records, bool inMedium) const {
    for (const RenderShadowRay &r : rendered_.Places()) {
        if (r.IsEmpty() || (r.inMedium == 1) != inMedium) continue;
        records->records.push_back({r.p, uint32_t(records->rays.size()), 1});
        records->rays.push_back(r.ray);
    }
}

void VisibilityModel::Update(const Progress &progress) {
    if (progress.Cancelled()) return;
    const auto start = std::chrono::steady_clock::now();
    VisibilityRecords *const kinds[] = {&onSurfaces_.records, &inMedia_.records};
    size_t recordsBefore[2], raysBefore[2];
    for (size_t k = 0; k < 2; ++k) {
        recordsBefore[k] = kinds[k]->records.size();
        raysBefore[k] = kinds[k]->rays.size();
        AppendRendered(kinds[k], k == 1);
    }
    // Four times the records per cell of the first build: same quality, half the build time.
    if (!Build(4 * params_.records, progress)) {
        for (size_t k = 0; k < 2; ++k) {
            kinds[k]->records.resize(recordsBefore[k]);
            kinds[k]->rays.resize(raysBefore[k]);
        }
        return;
    }
    counts_.renderRays = RayCount() - counts_.prepassRays;
    counts_.updateSeconds += SecondsSince(start);
    BeginRecording(nextUpdate_);
}

std::optional<std::string> VisibilityModel::Estimate::ValidateFor(size_t groups, const LightTree *lights) const {
    if (std::optional<std::string> fault = records.ValidateFor(groups, lights)) return fault;
    if (tree.RowCount() == 0) return {};
    if (recordsPerNode.size() != tree.Cells().NodeCount() || leaves.size() != tree.LeafCount())
        return "counts of records do not fit the octree";
    for (const LeafSize &leaf : leaves)
        if (leaf.depth < 0 || leaf.depth > tree.Depth()) return "a leaf is deeper than its octree";
    for (uint32_t r = 0; r < tree.RowCount(); ++r) {
        const VisibilityTree::Row row = tree.GetRow(r);
        if (lights ? row.nodes.size() > kMaxCandidates || !lights->IsCut(row.nodes)
                   : !row.nodes.empty() || row.codes.size() != groups)
            return "a row of an octree is not of all lights";
    }
    return {};
}

void VisibilityModel::Save(StateWriter &out, bool withLearning) const {
    out(counts_, bounds_, render_, withLearning ? nextUpdate_ : 0);
    for (const Estimate *estimate : {&onSurfaces_, &inMedia_}) {
        static const VisibilityRecords none;
        out(*estimate, withLearning ? estimate->records : none);
    }
    if (withLearning && nextUpdate_ > 0) rendered_.Save(out);
}

void VisibilityModel::Load(const PrepareContext &context, StateReader &in) {
    in(counts_, bounds_, render_, nextUpdate_);
    for (Estimate *estimate : {&onSurfaces_, &inMedia_}) {
        in(*estimate, estimate->records);
        in.RequireValid(estimate->ValidateFor(groups_.Size(), lights_));
    }
    if (nextUpdate_ == 0) return BeginRecording(render_.samplesPerPixel);
    constexpr const char *kWrongSchedule = "an update is due after a wrong number of samples";
    const auto next = std::ranges::find(kUpdateAfter, nextUpdate_);
    in.Require(IsUpdated() && next != std::end(kUpdateAfter), kWrongSchedule);
    in.Require(render_ == RenderOf(context) && render_.samplesPerPixel >= nextUpdate_,
               "it was learned for other pixels or paths");
    BeginRecording(next == std::begin(kUpdateAfter) ? 0 : next[-1]);
    in.Require(nextUpdate_ == *next, kWrongSchedule);
    rendered_.Merge(in);
    VisibilityRecords all;
    for (const bool inMedium : {false, true}) AppendRendered(&all, inMedium);
    in.RequireValid(all.ValidateFor(groups_.Size(), lights_));
}

void VisibilityModel::Report(nlohmann::ordered_json &report) const {
    report["prepassVertices"] = counts_.prepassRecords;
    report["prepassShadowRays"] = counts_.prepassRays;
    report["octreeBuildSeconds"] = counts_.buildSeconds;
    if (counts_.renderRays > 0) {
        report["learnedFromShadowRays"] = counts_.renderRays;
        report["learningSeconds"] = counts_.updateSeconds;
    }
    const VisibilityTree &surfaces = onSurfaces_.tree, &media = inMedia_.tree;
    report["leavesBeforePruning"] = onSurfaces_.leavesBefore + inMedia_.leavesBefore;
    report["leaves"] = surfaces.LeafCount() + media.LeafCount();
    if (media.RowCount() > 0) report["leavesInMedia"] = media.LeafCount();
    report["rows"] = surfaces.RowCount() + media.RowCount();
    report["depth"] = std::max(surfaces.Depth(), media.Depth());
}

void VisibilityModel::Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const {
    const Estimate &estimate = EstimateAt(query);
    const VisibilityTree *tree = TreeAt(query);
    CellOctree::Cell cell;
    if (tree) cell = tree->Cells().CellAt(query.p);
    const double records = tree ? estimate.recordsPerNode[cell.node] : 0;
    values.push_back({"leaf", double(cell.row), true});
    values.push_back({"leaf records", records, false});
    values.push_back({"leaf depth", double(cell.depth), false});
    if (lights_) return;
    for (size_t i = 0; i < std::min<size_t>(groups_.Size(), 16); ++i)
        values.push_back({fmt::format("factor {}", i),
                          tree ? double(VisibilityTree::Decode(tree->GetRow(cell.row).codes[i])) : 1.0, false});
}

std::string VisibilityModel::Describe() const {
    const auto describe = [&](const char *where, const Estimate &e) {
        if (e.tree.RowCount() == 0) return std::string();
        return fmt::format("octree{}: {} ({} before pruning), {} over {}, bytes: {}\n", where,
                           CountText(e.tree.LeafCount(), "leaf", "leaves"), e.leavesBefore,
                           CountText(e.tree.RowCount(), "different row"), CountText(groups_.Size(), "light"),
                           e.tree.Bytes()) +
               DescribeLeaves(e.leaves);
    };
    const std::string text = describe("", onSurfaces_) + describe(" inside media", inMedia_);
    if (text.empty()) return text;
    return text + fmt::format("prepass: {} records, {} shadow rays\n", counts_.prepassRecords, counts_.prepassRays);
}

}  // namespace ext
