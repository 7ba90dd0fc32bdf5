#pragma once
#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "pbrt/core/state_io.h"
#include "pbrt/lightsamplers/light_sampler.h"

namespace ext {
using namespace pbrt;

/// The recorded paths of a render: samples [first, end) of every stride-th pixel per row. Rows are shifted against each
/// other so that recorded pixels form no columns. Default: none.
class RecordedPaths {
  public:
    RecordedPaths() = default;
    /// Uses the smallest stride that gives at most `limit` paths; at least one pixel per row.
    RecordedPaths(const Bounds2i &pixels, int first, int end, size_t limit)
        : pixels_(pixels), first_(first), end_(end) {
        const Vector2i size = pixels.IsEmpty() ? Vector2i(0) : pixels.high - pixels.low;
        for (stride_ = 1;; ++stride_) {
            perRow_ = (size.x + stride_ - 1) / stride_;
            count_ = perRow_ * size.y * (end - first);
            if (count_ <= limit || stride_ >= size.x) break;
        }
    }
    size_t Count() const { return count_; }
    /// Path number below Count(); empty if not recorded.
    std::optional<size_t> NumberOf(Point2i pixel, int sample) const {
        const Vector2i at = pixel - pixels_.low;
        if (count_ == 0 || sample < first_ || sample >= end_ || (at.x + kRowShift * at.y) % stride_ != 0) return {};
        const size_t ofPixel = at.y * perRow_ + at.x / stride_;
        return ofPixel * (end_ - first_) + (sample - first_);
    }
    /// Pixel of a path, relative to the corner of the pixel bounds.
    Point2i PixelOf(size_t path) const {
        const size_t ofPixel = path / (end_ - first_);
        const int y = int(ofPixel / perRow_);
        // x + kRowShift y is a multiple of the stride.
        const int shift = (stride_ - kRowShift * y % stride_) % stride_;
        return {int(ofPixel % perRow_) * stride_ + shift, y};
    }

  private:
    static constexpr int kRowShift = 7;
    Bounds2i pixels_{};
    int first_ = 0, end_ = 0, stride_ = 1;
    size_t perRow_ = 0, count_ = 0;
};

/// Records of paths, each in its own slot, so that the result is independent of thread order. A Record has IsEmpty(),
/// true by default, and `std::optional<std::string> Validate() const`, the error of an invalid one. It has Visit
/// (core/state_io.h) or is trivially copyable without padding.
template <class Record>
class PathRecordStore {
  public:
    /// Discards all records and allocates `perPath` slots for each of `paths` paths.
    void Begin(size_t paths, size_t perPath) {
        places_ = {};
        places_.resize(paths * perPath);
        perPath_ = perPath;
    }
    /// Frees all slots; disables recording until the next Begin.
    void End() { *this = {}; }
    bool IsOpen() const { return !places_.empty(); }
    /// Slots of a path, stored by the path; none if it is not recorded.
    PathObserver::PathPlaces PlacesOf(std::optional<size_t> path) const {
        if (!path || places_.empty()) return {};
        return {*path * perPath_, (*path + 1) * perPath_};
    }
    /// Stores in the next slot of the path; ignored when it is full.
    void Add(PathObserver::PathPlaces &path, const Record &record) {
        if (path.next < path.end) places_[path.next++] = record;
    }
    /// Stores in slot k < PerPath() of a path.
    void Set(size_t path, size_t k, const Record &record) { places_[path * perPath_ + k] = record; }
    size_t PerPath() const { return perPath_; }
    std::span<const Record> Places() const { return places_; }
    size_t PathOf(size_t place) const { return place / perPath_; }
    size_t Bytes() const { return places_.size() * sizeof(Record); }

    /// Writes the non-empty records with their slots.
    void Save(StateWriter &out) const {
        const auto isFilled = [](const Record &record) { return !record.IsEmpty(); };
        out(uint64_t{places_.size()}, uint64_t(std::ranges::count_if(places_, isFilled)));
        for (size_t i = 0; i < places_.size(); ++i)
            if (isFilled(places_[i])) out(uint64_t{i}, places_[i]);
    }
    void Extract(StateWriter &out) {
        Save(out);
        std::fill(places_.begin(), places_.end(), Record{});
    }
    /// Merges the output of Save. Throws UserError if its slots do not match.
    void Merge(StateReader &in) {
        in.Require(in.Value<uint64_t>() == places_.size(), "it has other records than the render makes");
        for (auto filled = in.Value<uint64_t>(); filled > 0; --filled) {
            const auto place = in.Value<uint64_t>();
            in.Require(place < places_.size(), "a record has no place");
            in(places_[place]);
        }
    }

  private:
    std::vector<Record> places_;
    size_t perPath_ = 0;
};

}  // namespace ext
