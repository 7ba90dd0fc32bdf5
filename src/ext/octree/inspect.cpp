#include <nlohmann/json.hpp>

#include "ext/octree/paper_octree_light_sampler.h"
#include "ext/octree/visibility_octree_light_sampler.h"
#include "ext/visibility/visibility_tree_builder.h"
#include "pbrt/core/effective_params_text.h"
#include "pbrt/math/rng.h"

namespace ext {
namespace {

/// Incremented whenever the output of SaveLearned changes.
constexpr uint32_t kVersion = 6;
constexpr std::string_view kOtherVersion = "another version of this light sampler wrote it";

}  // namespace

void VisibilityOctreeLightSampler::SaveLearned(StateWriter &writer, bool withLearning) const {
    writer(kVersion, withLearning, prepassSeconds_);
    portals_.Save(writer);
    writer(LightTreeHash());
    model_.Save(writer, withLearning);
}

void VisibilityOctreeLightSampler::LoadLearned(const PrepareContext &context, StateReader &reader) {
    reader.Require(reader.Value<uint32_t>() == kVersion, kOtherVersion);
    reader.Require(reader.Value<bool>() == context.learnsOn, "it is of another use");
    reader(prepassSeconds_);
    portals_.Load(reader);
    PortalsChanged();
    reader.Require(reader.Value<uint64_t>() == LightTreeHash(), "it belongs to other lights");
    model_.Load(context, reader);
}

uint64_t VisibilityOctreeLightSampler::LightTreeHash() const {
    uint64_t hash = Hash(uint64_t{groups_.Size()}, uint64_t{lightTree_ ? lightTree_->NodeCount() : 0});
    if (!lightTree_) return hash;
    for (uint32_t n = 0; n < lightTree_->NodeCount(); ++n)
        hash = Hash(hash, lightTree_->At(n).begin, lightTree_->At(n).end);
    for (uint32_t p = 0; p < lightTree_->LightCount(); ++p) hash = Hash(hash, lightTree_->LightAt(p));
    return hash;
}

void VisibilityOctreeLightSampler::Report(nlohmann::ordered_json &report) const {
    report["parameters"] = EffectiveParamsText(params_);
    GroupLightSampler::Report(report);
    report["prepassSeconds"] = prepassSeconds_;
    model_.Report(report);
    portals_.Report(report);
    report["bytes"] = model_.Bytes() + importance_.Bytes() + interior_.Bytes() +
                      (lightTree_ ? lightTree_->Bytes() : 0) + (portals_.IsActive() ? portals_.Bytes() : 0);
}

void VisibilityOctreeLightSampler::Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const {
    model_.Inspect(query, values);
    portals_.Inspect(query.p, values);
}

std::string VisibilityOctreeLightSampler::DescribeStructure() const {
    const std::string text = model_.Describe() + portals_.Describe();
    return text.empty() ? fmt::format("octree: none, there is nothing to choose ({} lights)\n", groups_.Size()) : text;
}

void PaperOctreeLightSampler::SaveLearned(StateWriter &writer, bool) const {
    writer(kVersion, learned_, vertices_, prepassSeconds_, buildSeconds_, tree_, recordsPerNode_);
}

void PaperOctreeLightSampler::LoadLearned(StateReader &reader) {
    reader.Require(reader.Value<uint32_t>() == kVersion, kOtherVersion);
    reader(learned_, vertices_, prepassSeconds_, buildSeconds_, tree_, recordsPerNode_);
    reader.Require(!learned_ || tree_.GroupCount() == groups_.Size(), "it has another number of lights");
    reader.Require(!learned_ || (tree_.RowCount() > 0 && recordsPerNode_.size() == tree_.Cells().NodeCount()),
                   "counts of records do not fit the octree");
}

void PaperOctreeLightSampler::Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const {
    CellOctree::Cell cell;
    double records = 0;
    if (learned_) {
        cell = tree_.Cells().CellAt(query.p);
        records = recordsPerNode_[cell.node];
    }
    values.push_back({"leaf", double(cell.node), true});
    values.push_back({"leaf records", records, false});
    values.push_back({"leaf depth", double(cell.depth), false});
}

std::string PaperOctreeLightSampler::DescribeStructure() const {
    if (!learned_) return fmt::format("octree: none, there is nothing to choose ({} lights)\n", groups_.Size());

    std::vector<LeafSize> leaves;
    tree_.Cells().ForEachLeaf([&](uint32_t node, uint32_t, int depth) {
        leaves.push_back({depth, recordsPerNode_[node]});
    });
    return fmt::format(
               "octree: {} leaves, {} distributions over {} lights, {} records\nbytes: {} (and {} for this view)\n",
               leaves.size(), tree_.RowCount(), groups_.Size(), vertices_, tree_.Bytes(),
               recordsPerNode_.capacity() * sizeof(uint32_t)) +
           DescribeLeaves(leaves);
}

}  // namespace ext
