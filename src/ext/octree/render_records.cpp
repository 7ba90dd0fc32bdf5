#include "ext/octree/render_records.h"

namespace ext {

namespace {
/// Each row of pixels is shifted by this much against the row before, so that the recorded pixels do not form columns.
constexpr int kRowShift = 7;
}  // namespace

void RenderRecords::Begin(const Bounds2i &pixels, int first, int end, int vertices, size_t most) {
    pixels_ = pixels;
    first_ = first;
    end_ = end;
    vertices_ = static_cast<size_t>(vertices);
    const Vector2i size = pixels.IsEmpty() ? Vector2i(0) : pixels.high - pixels.low;
    const size_t perPixel = static_cast<size_t>(end - first) * vertices_;
    size_t count = 0;
    for (stride_ = 1;; ++stride_) {
        placesPerRow_ = static_cast<size_t>((size.x + stride_ - 1) / stride_);
        count = placesPerRow_ * static_cast<size_t>(size.y) * perPixel;
        if (count <= most || stride_ >= size.x) break;
    }
    places_.assign(count, {});
}

void RenderRecords::End() { *this = {}; }

PathObserver::PathPlaces RenderRecords::BeginPath(Point2i pixel, int sample) const {
    const Vector2i at = pixel - pixels_.low;
    if (places_.empty() || sample < first_ || sample >= end_ || (at.x + kRowShift * at.y) % stride_ != 0) return {};
    const size_t ofPixel = static_cast<size_t>(at.y) * placesPerRow_ + static_cast<size_t>(at.x / stride_);
    const size_t next =
        (ofPixel * static_cast<size_t>(end_ - first_) + static_cast<size_t>(sample - first_)) * vertices_;
    return {next, next + vertices_};
}

void RenderRecords::AppendTo(VisibilityRecords *records, bool inMedium) const {
    for (const Place &place : places_) {
        if (!(place.found.weight > 0) || place.inMedium != inMedium) continue;
        records->records.push_back({place.p, static_cast<uint32_t>(records->tries.size()), 1});
        records->tries.push_back(place.found);
    }
}

}  // namespace ext
