// What the octree light samplers have learned, written and read bit by bit (LightSampler::SaveLearned). What the lights
// alone decide, such as the light tree, is not written: it is made anew.
#include <algorithm>

#include "ext/octree/paper_octree_light_sampler.h"
#include "ext/octree/visibility_octree_light_sampler.h"
#include "pbrt/math/rng.h"

namespace ext {

namespace {

/// Changes with everything that this file writes.
constexpr uint32_t kVersion = 3;

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

std::vector<uint32_t> SkyTiles::Known() const {
    std::vector<uint32_t> numbers;
    for (const auto &[number, tile] : tiles_) numbers.push_back(number);
    std::sort(numbers.begin(), numbers.end());
    return numbers;
}

void SkyCells::Save(StateWriter &writer) const {
    octree_.Save(writer);
    writer.Value(uint64_t{cells_.size()});
    for (const Cell &cell : cells_) {
        Writing{writer}(cell.rays, cell.fresh, cell.box, uint64_t{cell.cuts.size()});
        for (const SkyCut &cut : cell.cuts) writer.CopyOfVector(cut.Tiles());
    }
    writer.Value(uint64_t{rows_.size()});
    for (const Row &row : rows_) Writing{writer}(row.first, row.tiles, row.isOpen);
    writer.Vector(packets_);
    writer.Vector(visible_);
    writer.Structure(numbers_);
    Writing{writer}(traced_, left_);
    std::vector<uint64_t> counts(CountCount());
    for (size_t i = 0; i < counts.size(); ++i) counts[i] = counts_[i].load(std::memory_order_relaxed);
    writer.CopyOfVector(counts);
}

void SkyCells::TakeFound(StateWriter &writer) {
    const size_t lanes = CountCount();
    std::vector<std::pair<uint32_t, uint64_t>> counted;
    for (size_t i = 0; i < lanes; ++i)
        if (const uint64_t count = counts_[i].exchange(0, std::memory_order_relaxed); count > 0)
            counted.push_back({static_cast<uint32_t>(i), count});
    Writing{writer}(uint64_t{lanes}, uint64_t{counted.size()});
    for (const auto &[lane, count] : counted) Writing{writer}(lane, count);
}

void SkyCells::AddFound(StateReader &reader) {
    const size_t count = CountCount();
    reader.Require(reader.Value<uint64_t>() == count, "it counts rays towards other tiles");
    for (auto counted = reader.Value<uint64_t>(); counted > 0; --counted) {
        const auto lane = reader.Value<uint32_t>();
        reader.Require(lane < count, "it counts rays towards other tiles");
        counts_[lane].fetch_add(reader.Value<uint64_t>(), std::memory_order_relaxed);
    }
}

void SkyCells::Load(StateReader &reader, const Settings &settings, size_t skies) {
    settings_ = settings;
    octree_.Load(reader);
    const auto readCount = [&] {
        const auto count = reader.Value<uint64_t>();
        reader.Require(count <= reader.BytesLeft(), "it is shorter than what it announces");
        return count;
    };
    cells_.assign(readCount(), {});
    for (Cell &cell : cells_) {
        Reading{reader}(cell.rays, cell.fresh, cell.box);
        for (auto cuts = readCount(); cuts > 0; --cuts) {
            std::vector<SkyCut::Tile> tiles;
            reader.Vector(&tiles);
            cell.cuts.emplace_back(std::move(tiles));
        }
    }
    rows_.assign(readCount(), {});
    for (Row &row : rows_) Reading{reader}(row.first, row.tiles, row.isOpen);
    reader.Vector(&packets_);
    reader.Vector(&visible_);
    reader.Structure(&numbers_);
    Reading{reader}(traced_, left_);
    std::vector<uint64_t> counts;
    reader.Vector(&counts);
    reader.RequireValid(Validate(skies));
    reader.Require(counts.empty() || counts.size() == 2 * numbers_.size(), "it counts rays towards other tiles");
    counts_.reset(counts.empty() ? nullptr : new std::atomic<uint64_t>[counts.size()]());
    for (size_t i = 0; i < counts.size(); ++i) counts_[i].store(counts[i], std::memory_order_relaxed);
    keys_.assign(numbers_.size(), kNoKey);
    halves_.assign(numbers_.size(), 0);
    tileCount_ = 0;
    for (const Row &row : rows_)
        for (size_t k = 0; k < skies; ++k) {
            const size_t firstLane = row.first[k] * kLanes;
            for (size_t lane = firstLane; lane < firstLane + row.tiles[k]; ++lane)
                keys_[lane] = SkyTiles::KeyOf(numbers_[lane]);
            MakeHalves(firstLane, row.tiles[k]);
            tileCount_ += row.tiles[k];
        }
}

void SkyChoice::Save(StateWriter &writer, bool goesOn) const {
    writer.Value(uint64_t{skies_.size()});
    for (const SkyTiles &sky : skies_) writer.CopyOfVector(goesOn ? sky.Known() : std::vector<uint32_t>());
    cells_.Save(writer);
    writer.Value(seenShare_);
}

void SkyChoice::Load(StateReader &reader) {
    reader.Require(reader.Value<uint64_t>() == skies_.size(), "it has another number of skies");
    for (SkyTiles &sky : skies_) {
        std::vector<uint32_t> known;
        reader.Vector(&known);
        for (size_t i = 0; i < known.size(); ++i)
            reader.Require(known[i] < SkyTile::kCount && (i == 0 || known[i - 1] < known[i]),
                           "a sky has no tile of this number");
        sky.Know(known);
    }
    cells_.Load(reader, settings_, skies_.size());
    reader.Value(&seenShare_);
    reader.Require(seenShare_ >= 0 && seenShare_ <= 1, "a share is not from 0 to 1");
}

bool SkyChoice::CanLearn() const {
    bool areKnown = true;
    cells_.ForEachLearnedTile([&](size_t k, uint32_t number) { areKnown = areKnown && skies_[k].KnowsAround(number); });
    return areKnown && cells_.CanLearn();
}

void VisibilityOctreeLightSampler::TakeFound(StateWriter &out) {
    found_.Take(out);
    if (tiles_) tiles_->TakeFound(out);
}

void VisibilityOctreeLightSampler::AddFound(StateReader &in) {
    found_.Add(in);
    if (tiles_) tiles_->AddFound(in);
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
    write(kVersion, NamesHash(), sky_ != nullptr, tiles_ != nullptr, goesOn);
    write(prepassRecords_, prepassTries_, learnedTries_, prepassSeconds_, buildSeconds_, learningSeconds_, skySeconds_,
          skySeenShare_, sceneBounds_, pixels_, goesOn ? nextLearning_ : 0, samplesPerPixel_, depth_);
    onSurfaces_.Save(writer, goesOn);
    inMedia_.Save(writer, goesOn);
    if (sky_) sky_->Save(writer, goesOn);
    (goesOn ? found_ : RenderRecords()).Save(writer);
}

void VisibilityOctreeLightSampler::LoadLearned(const PrepareContext &context, StateReader &reader) {
    Reading read{reader};
    reader.Require(reader.Value<uint32_t>() == kVersion, kOtherVersion);
    const auto names = reader.Value<uint64_t>();
    const auto hasSky = reader.Value<bool>();
    const auto hasTiles = reader.Value<bool>();
    const auto goesOn = reader.Value<bool>();
    reader.Require(!hasSky || sky_, "it divides skies that are not divided here");
    reader.Require(goesOn == context.learnsOn, "it is of another use");
    if (!hasSky && sky_) KeepSkiesWhole();
    if (hasSky && !hasTiles) {
        sky_ = MakeWindows();
        tiles_ = nullptr;
    }
    reader.Require(names == NamesHash(), "it belongs to other lights");
    read(prepassRecords_, prepassTries_, learnedTries_, prepassSeconds_, buildSeconds_, learningSeconds_, skySeconds_,
         skySeenShare_, sceneBounds_, pixels_, nextLearning_, samplesPerPixel_, depth_);
    for (Knowledge *knowledge : {&onSurfaces_, &inMedia_}) {
        knowledge->Load(reader);
        reader.RequireValid(knowledge->Validate(groups_.Size(), lightTree_.get()));
    }
    if (sky_) sky_->Load(reader);
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
