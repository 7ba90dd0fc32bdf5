// What the octree light samplers have learned, written and read bit by bit (LightSampler::SaveLearned). What the lights
// alone decide, such as the light tree, is not written: it is made anew.
#include <algorithm>

#include "ext/octree/paper_octree_light_sampler.h"
#include "ext/octree/visibility_octree_light_sampler.h"
#include "pbrt/math/rng.h"

namespace ext {

namespace {

/// Changes with everything that this file writes.
constexpr uint32_t kVersion = 4;

/// Calls act(number) for values that are written and read in the same order.
struct Writing {
    StateWriter &writer;
    template <class... T>
    void operator()(const T &...values) {
        (writer.Value(values), ...);
    }
};
struct Reading {
    StateReader &reader;
    template <class... T>
    void operator()(T &...values) {
        (reader.Value(&values), ...);
    }
};

}  // namespace

constexpr std::string_view kOtherVersion = "another version of this light sampler wrote it";

void CellOctree::Save(StateWriter &writer) const {
    Writing{writer}(low_, scale_);
    writer.Structure(nodes_);
}

void CellOctree::Load(StateReader &reader) {
    Reading{reader}(low_, scale_);
    reader.Structure(&nodes_);
}

void VisibilityTree::Save(StateWriter &writer) const {
    cells_.Save(writer);
    writer.Structure(offset_);
    writer.Structure(nodes_);
    writer.Vector(codes_);
    Writing{writer}(leaves_, depth_);
}

void VisibilityTree::Load(StateReader &reader) {
    cells_.Load(reader);
    reader.Structure(&offset_);
    reader.Structure(&nodes_);
    reader.Vector(&codes_);
    Reading{reader}(leaves_, depth_);
    reader.RequireValid(Validate());
}

void LightOctree::Save(StateWriter &writer) const {
    cells_.Save(writer);
    writer.Vector(cdf_);
    Writing{writer}(groups_, leaves_, depth_);
}

void LightOctree::Load(StateReader &reader) {
    cells_.Load(reader);
    reader.Vector(&cdf_);
    Reading{reader}(groups_, leaves_, depth_);
    reader.RequireValid(Validate());
}

void RenderRecords::Save(StateWriter &writer) const {
    Writing{writer}(pixels_, first_, end_, stride_, vertices_, placesPerRow_, uint64_t{places_.size()});
    // Most places may be empty.
    uint64_t filled = 0;
    for (const Place &place : places_) filled += place.found.weight > 0;
    writer.Value(filled);
    for (size_t i = 0; i < places_.size(); ++i) {
        const Place &place = places_[i];
        if (place.found.weight > 0) Writing{writer}(uint64_t{i}, place.p, place.inMedium, place.found);
    }
}

void RenderRecords::Load(StateReader &reader) {
    RenderRecords saved;
    uint64_t count = 0;
    Reading{reader}(saved.pixels_, saved.first_, saved.end_, saved.stride_, saved.vertices_, saved.placesPerRow_,
                    count);
    reader.Require(saved.pixels_.low == pixels_.low && saved.pixels_.high == pixels_.high && saved.first_ == first_ &&
                       saved.end_ == end_ && saved.stride_ == stride_ && saved.vertices_ == vertices_ &&
                       saved.placesPerRow_ == placesPerRow_ && count == places_.size(),
                   "it has other records than the render makes");
    uint64_t next = 0;
    for (auto filled = reader.Value<uint64_t>(); filled > 0; --filled) {
        const auto i = reader.Value<uint64_t>();
        reader.Require(i >= next && i < count, "a record has no place");
        Reading{reader}(places_[i].p, places_[i].inMedium, places_[i].found);
        reader.Require(places_[i].found.weight > 0, "a record has no weight");
        next = i + 1;
    }
}

void RenderRecords::Take(StateWriter &writer) {
    uint64_t filled = 0;
    for (const Place &place : places_) filled += place.found.weight > 0;
    Writing{writer}(uint64_t{places_.size()}, filled);
    for (size_t i = 0; i < places_.size(); ++i) {
        Place &place = places_[i];
        if (!(place.found.weight > 0)) continue;
        Writing{writer}(static_cast<uint32_t>(i), place.p, place.inMedium, place.found);
        place = {};
    }
}

void RenderRecords::Add(StateReader &reader) {
    reader.Require(reader.Value<uint64_t>() == places_.size(), "it has other records than the render makes");
    for (auto filled = reader.Value<uint64_t>(); filled > 0; --filled) {
        const auto i = reader.Value<uint32_t>();
        reader.Require(i < places_.size(), "a record has no place");
        Reading{reader}(places_[i].p, places_[i].inMedium, places_[i].found);
    }
}

void VisibilityOctreeLightSampler::Knowledge::Save(StateWriter &writer, bool goesOn) const {
    tree.Save(writer);
    Writing{writer}(learned, leavesBefore);
    writer.Vector(leaves);
    writer.Vector(recordsPerNode);
    static const VisibilityRecords none;
    writer.Vector(goesOn ? known.records : none.records);
    writer.Vector(goesOn ? known.tries : none.tries);
}

void VisibilityOctreeLightSampler::Knowledge::Load(StateReader &reader) {
    tree.Load(reader);
    Reading{reader}(learned, leavesBefore);
    reader.Vector(&leaves);
    reader.Vector(&recordsPerNode);
    reader.Vector(&known.records);
    reader.Vector(&known.tries);
}

uint64_t VisibilityOctreeLightSampler::NamesHash() const {
    uint64_t hash = Hash(uint64_t{groups_.Size()}, uint64_t{lightTree_ ? lightTree_->NodeCount() : 0});
    if (!lightTree_) return hash;
    for (uint32_t n = 0; n < lightTree_->NodeCount(); ++n)
        hash = Hash(hash, lightTree_->At(n).begin, lightTree_->At(n).end);
    for (uint32_t p = 0; p < lightTree_->LightCount(); ++p) hash = Hash(hash, lightTree_->LightAt(p));
    return hash;
}

void VisibilityOctreeLightSampler::SaveLearned(StateWriter &writer, bool goesOn) const {
    Writing write{writer};
    write(kVersion, NamesHash(), windows_ != nullptr, goesOn);
    write(prepassRecords_, prepassTries_, learnedTries_, prepassSeconds_, buildSeconds_, learningSeconds_, skySeconds_,
          skySeenShare_, sceneBounds_, pixels_, goesOn ? nextLearning_ : 0, samplesPerPixel_, depth_);
    onSurfaces_.Save(writer, goesOn);
    inMedia_.Save(writer, goesOn);
    if (windows_) windows_->Save(writer);
    (goesOn ? found_ : RenderRecords()).Save(writer);
}

void VisibilityOctreeLightSampler::LoadLearned(const PrepareContext &context, StateReader &reader) {
    Reading read{reader};
    reader.Require(reader.Value<uint32_t>() == kVersion, kOtherVersion);
    const auto names = reader.Value<uint64_t>();
    const auto hasWindows = reader.Value<bool>();
    const auto goesOn = reader.Value<bool>();
    reader.Require(!hasWindows || !skies_.empty(), "it divides skies that are not divided here");
    reader.Require(goesOn == context.learnsOn, "it is of another use");
    if (hasWindows) UseWindows(MakeWindows());
    reader.Require(names == NamesHash(), "it belongs to other lights");
    read(prepassRecords_, prepassTries_, learnedTries_, prepassSeconds_, buildSeconds_, learningSeconds_, skySeconds_,
         skySeenShare_, sceneBounds_, pixels_, nextLearning_, samplesPerPixel_, depth_);
    for (Knowledge *knowledge : {&onSurfaces_, &inMedia_}) {
        knowledge->Load(reader);
        reader.RequireValid(knowledge->Validate(groups_.Size(), lightTree_.get()));
    }
    if (windows_) windows_->Load(reader);
    reader.RequireValid(TakeUpLearning(context));
    found_.Load(reader);
    VisibilityRecords all;
    for (const bool inMedium : {false, true}) found_.AppendTo(&all, inMedium);
    reader.RequireValid(all.Validate(groups_.Size(), lightTree_.get()));
    if (nextLearning_ == 0) EndLearning();
}

void PaperOctreeLightSampler::SaveLearned(StateWriter &writer, bool) const {
    Writing{writer}(kVersion, learned_, uint64_t{vertices_}, prepassSeconds_, buildSeconds_);
    tree_.Save(writer);
    writer.Vector(recordsPerNode_);
}

void PaperOctreeLightSampler::LoadLearned(StateReader &reader) {
    reader.Require(reader.Value<uint32_t>() == kVersion, kOtherVersion);
    Reading{reader}(learned_, vertices_, prepassSeconds_, buildSeconds_);
    tree_.Load(reader);
    reader.Vector(&recordsPerNode_);
    reader.Require(!learned_ || tree_.GroupCount() == groups_.Size(), "it has another number of lights");
    reader.Require(!learned_ || (tree_.RowCount() > 0 && recordsPerNode_.size() == tree_.Cells().NodeCount()),
                   "counts of records do not fit the octree");
}

}  // namespace ext
