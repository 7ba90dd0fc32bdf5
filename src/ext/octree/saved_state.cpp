// What the octree light samplers have learned, written and read bit by bit (LightSampler::SaveLearned). What the lights
// alone decide, such as the light tree, is not written: it is made anew.
#include <algorithm>

#include "ext/octree/paper_octree_light_sampler.h"
#include "ext/octree/visibility_octree_light_sampler.h"
#include "pbrt/math/rng.h"

namespace ext {

namespace {

/// Changes with everything that this file writes.
constexpr uint32_t kVersion = 2;

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

void CellOctree::Save(StateWriter &writer) const {
    Writing{writer}(low_, scale_);
    writer.Vector(nodes_);
}

void CellOctree::Load(StateReader &reader) {
    Reading{reader}(low_, scale_);
    reader.Vector(&nodes_);
    if (nodes_.size() < TopCount) reader.Refuse();
    for (uint32_t node : nodes_)
        if (!(node & LeafBit) && size_t(node) + 8 > nodes_.size()) reader.Refuse();
}

void VisibilityTree::Save(StateWriter &writer) const {
    cells_.Save(writer);
    writer.Vector(offset_);
    writer.Vector(nodes_);
    writer.Vector(codes_);
    Writing{writer}(leaves_, depth_);
}

void VisibilityTree::Load(StateReader &reader) {
    cells_.Load(reader);
    reader.Vector(&offset_);
    reader.Vector(&nodes_);
    reader.Vector(&codes_);
    Reading{reader}(leaves_, depth_);
    const bool isSorted = std::is_sorted(offset_.begin(), offset_.end());
    if (!isSorted || (!offset_.empty() && offset_.back() != codes_.size()) ||
        (!nodes_.empty() && nodes_.size() != codes_.size()))
        reader.Refuse();
    if (RowCount() > 0)
        cells_.ForEachLeaf([&](uint32_t, uint32_t row, int) {
            if (row >= RowCount()) reader.Refuse();
        });
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
    if (RowCount() > 0)
        cells_.ForEachLeaf([&](uint32_t, uint32_t row, int) {
            if (row >= RowCount()) reader.Refuse();
        });
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
    uint64_t count = 0, filled = 0;
    Reading{reader}(pixels_, first_, end_, stride_, vertices_, placesPerRow_, count, filled);
    // As many as Begin makes.
    const auto rows = static_cast<uint64_t>(std::max(0, pixels_.high.y - pixels_.low.y));
    if (stride_ < 1 ||
        count != (first_ < end_ ? placesPerRow_ * rows * static_cast<uint64_t>(end_ - first_) * vertices_ : 0))
        reader.Refuse();
    places_.assign(count, {});
    for (; filled > 0; --filled) {
        const auto i = reader.Value<uint64_t>();
        if (i >= count) reader.Refuse();
        Reading{reader}(places_[i].p, places_[i].inMedium, places_[i].found);
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
    if (reader.Value<uint64_t>() != places_.size()) reader.Refuse();
    for (auto filled = reader.Value<uint64_t>(); filled > 0; --filled) {
        const auto i = reader.Value<uint32_t>();
        if (i >= places_.size()) reader.Refuse();
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
    writer.Vector(numbers_);
    writer.Vector(keys_);
    writer.Vector(halves_);
    Writing{writer}(traced_, left_, tileCount_);
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
    const size_t lanes = CountCount();
    if (reader.Value<uint64_t>() != lanes) reader.Refuse();
    for (auto counted = reader.Value<uint64_t>(); counted > 0; --counted) {
        const auto lane = reader.Value<uint32_t>();
        if (lane >= lanes) reader.Refuse();
        counts_[lane].fetch_add(reader.Value<uint64_t>(), std::memory_order_relaxed);
    }
}

void SkyCells::Load(StateReader &reader, const Settings &settings) {
    settings_ = settings;
    octree_.Load(reader);
    const auto readCount = [&] {
        const auto count = reader.Value<uint64_t>();
        if (count > reader.BytesLeft()) reader.Refuse();
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
    reader.Vector(&numbers_);
    reader.Vector(&keys_);
    reader.Vector(&halves_);
    Reading{reader}(traced_, left_, tileCount_);
    std::vector<uint64_t> counts;
    reader.Vector(&counts);
    const size_t lanes = packets_.size() * kLanes;
    if (rows_.size() != cells_.size() || visible_.size() != cells_.size() || numbers_.size() != lanes ||
        keys_.size() != lanes || halves_.size() != lanes || (!counts.empty() && counts.size() != 2 * lanes))
        reader.Refuse();
    counts_.reset();
    if (!counts.empty()) {
        counts_.reset(new std::atomic<uint64_t>[2 * lanes]());
        for (size_t i = 0; i < counts.size(); ++i) counts_[i].store(counts[i], std::memory_order_relaxed);
    }
}

void SkyChoice::Save(StateWriter &writer, bool goesOn) const {
    writer.Value(uint64_t{skies_.size()});
    for (const SkyTiles &sky : skies_) writer.CopyOfVector(goesOn ? sky.Known() : std::vector<uint32_t>());
    cells_.Save(writer);
    writer.Value(seenShare_);
}

void SkyChoice::Load(StateReader &reader) {
    if (reader.Value<uint64_t>() != skies_.size()) reader.Refuse();
    for (SkyTiles &sky : skies_) {
        std::vector<uint32_t> known;
        reader.Vector(&known);
        sky.Know(known);
    }
    cells_.Load(reader, settings_);
    reader.Value(&seenShare_);
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
    for (const VisibilityRecord &r : known.records)
        if (size_t(r.firstTry) + r.tryCount > known.tries.size()) reader.Refuse();
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
    (goesOn ? found_ : RenderRecords()).Save(writer);
    if (sky_) sky_->Save(writer, goesOn);
}

void VisibilityOctreeLightSampler::LoadLearned(StateReader &reader, bool learnsOn) {
    Reading read{reader};
    if (reader.Value<uint32_t>() != kVersion) reader.Refuse();
    const auto names = reader.Value<uint64_t>();
    const auto hasSky = reader.Value<bool>();
    const auto hasTiles = reader.Value<bool>();
    const auto goesOn = reader.Value<bool>();
    if ((hasSky && !sky_) || (learnsOn && !goesOn)) reader.Refuse();
    if (!hasSky && sky_) KeepSkiesWhole();
    if (hasSky && !hasTiles) {
        sky_ = MakeWindows();
        tiles_ = nullptr;
    }
    if (names != NamesHash()) reader.Refuse();
    read(prepassRecords_, prepassTries_, learnedTries_, prepassSeconds_, buildSeconds_, learningSeconds_, skySeconds_,
         skySeenShare_, sceneBounds_, pixels_, nextLearning_, samplesPerPixel_, depth_);
    onSurfaces_.Load(reader);
    inMedia_.Load(reader);
    found_.Load(reader);
    if (sky_) sky_->Load(reader);
    if (!learnsOn || nextLearning_ == 0) EndLearning();
}

void PaperOctreeLightSampler::SaveLearned(StateWriter &writer, bool) const {
    Writing{writer}(kVersion, learned_, uint64_t{vertices_}, prepassSeconds_, buildSeconds_);
    tree_.Save(writer);
    writer.Vector(recordsPerNode_);
}

void PaperOctreeLightSampler::LoadLearned(StateReader &reader) {
    if (reader.Value<uint32_t>() != kVersion) reader.Refuse();
    Reading{reader}(learned_, vertices_, prepassSeconds_, buildSeconds_);
    tree_.Load(reader);
    reader.Vector(&recordsPerNode_);
}

}  // namespace ext
