#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "ext/guiding/point_tree.h"
#include "ext/prepass/path_record_store.h"
#include "pbrt/transport/vertex.h"

namespace ext {

/// Costs within a path, in vertices.
struct PathCost {
    static constexpr Float kCamera = 1;     ///< what every path costs
    static constexpr Float kBounce = 0.4f;  ///< a ray and its hit
    static constexpr Float kLight = 0.6f;   ///< sampling light
};

/// The record of a path from one of its vertices on.
struct RouletteRecord {
    struct Segment {
        Float radiance = 0;  ///< over the throughput at the vertex; mean over wavelengths
        Float cost = 0;      ///< see PathCost; 0: there was no such path
        bool IsUsable() const { return radiance >= 0 && std::isfinite(radiance * radiance); }
    };
    Point3 p{};
    uint32_t kind = 0;      ///< PathRoulette::KindOf
    Segment here, onwards;  ///< from there on, with and without light sampling there; an empty place if `here` cost 0

    bool IsEmpty() const { return !(here.cost > 0); }
    static RouletteRecord Read(StateReader &in);
};

/// The record of a whole path.
struct PathTotal {
    Float radiance = 0;  ///< mean over wavelengths
    Float cost = 0;      ///< see PathCost; 0: an empty place

    bool IsEmpty() const { return !(cost > 0); }
    static PathTotal Read(StateReader &in);
};

/// Learned Russian roulette: continuation probabilities where a path arrives, and again after next-event estimation,
/// from radiance and cost of earlier paths: Rath et al., "EARS: Efficiency-Aware Russian Roulette and Splitting"
/// (2022), without splitting. A vertex of throughput beta whose estimate has the second moment M and the cost C, in a
/// pixel of radiance I, gets the probability k beta/I sqrt(M/C) sqrt(C0/V0); C0 is the mean cost of a path, and V0 the
/// mean variance of a sample over I^2. V0 is that of blocks of samples, as pixel samplers are even in their first
/// dimensions; the factor k corrects for longer blocks.
class PathRoulette {
  public:
    /// Smallest probability between two next-event estimations: estimates are noisy where light is hard to find.
    static constexpr Float kMinContinuation = 0.5f;
    /// k.
    static constexpr Float kVarianceCorrection = 1.2f;

    /// Discards all records; makes places for `paths` paths with up to `vertices` records each.
    void BeginRecords(size_t paths, size_t vertices) {
        records_.Begin(paths, vertices);
        totals_.Begin(paths, 1);
    }
    /// Records of a path.
    size_t Vertices() const { return records_.PerPath(); }
    /// The record of vertex k of a path, below Vertices().
    void Record(size_t path, size_t k, const RouletteRecord &record) { records_.Set(path, k, record); }
    void RecordPath(size_t path, const PathTotal &total) { totals_.Set(path, 0, total); }

    /// Places of different kinds share no estimates: the six sides that a normal may point to, each with glossy BSDFs
    /// and without, and media.
    static uint32_t KindOf(const Vector3 &n, bool isGlossy);
    static uint32_t KindOf(const PathVertex &vertex);
    static constexpr uint32_t kInMedium = 12, kKinds = 13;

    /// True after Learn with enough records.
    bool HasEstimates() const { return !tree_.IsEmpty(); }
    /// k sqrt(M / C): where paths arrive, and after next-event estimation. Below 0: no estimate.
    struct Cell {
        Float here = -1, onwards = -1;
    };
    const Cell &At(const Point3 &p, uint32_t kind) const { return cells_[tree_.LeafOf(p, kind)]; }
    /// Continuation probability by an estimate of a cell, `least` to 1; 0: no estimate. `importance`: throughput, mean
    /// over wavelengths, times PixelImportance of the pixel.
    static Float ContinuationProbability(Float estimate, Float importance, Float least = kMinContinuation) {
        return estimate < 0 ? 0 : std::clamp(importance * estimate, least, Float(1));
    }

    /// sqrt(C0/V0)/I of a pixel, relative to the picture's corner: a contribution times this, squared, is its part of
    /// the variance in units of path cost (EARS). HasEstimates() must be true.
    Float PixelImportance(Point2i pixel) const {
        const Point2i at(std::clamp(pixel.x, 0, size_.x - 1) / tile_, std::clamp(pixel.y, 0, size_.y - 1) / tile_);
        return tiles_[static_cast<size_t>(at.y * ((size_.x + tile_ - 1) / tile_) + at.x)];
    }

    /// Adapts the estimates to a picture of another size. `isSameView` false: it shows something else, so every pixel
    /// gets the mean PixelImportance.
    void UseFor(Vector2i size, bool isSameView);

    /// Estimates everything from all records. `pixelOf(i)`: the pixel of path i, relative to the picture's corner; the
    /// paths of a pixel are neighbours.
    template <class PixelOf>
    void Learn(Vector2i size, PixelOf &&pixelOf) {
        std::vector<Point2i> pixels;
        pixels.reserve(totals_.Places().size());
        for (size_t i = 0; i < totals_.Places().size(); ++i) pixels.push_back(pixelOf(i));
        EstimatePixels(size, pixels);
        EstimateCells();
    }
    /// Cost of all recorded paths, in vertices.
    double RecordedCost() const;
    size_t Cells() const { return cells_.size(); }
    size_t Bytes() const { return tree_.Bytes() + cells_.size() * sizeof(Cell) + tiles_.size() * sizeof(Float); }
    size_t RecordBytes() const { return records_.Bytes() + totals_.Bytes(); }

    void Save(StateWriter &out) const;
    void Load(StateReader &in);
    /// Empty, or what is wrong with what was read, but for the tree.
    std::optional<std::string> Validate() const;
    Vector2i Size() const { return size_; }
    void SaveRecords(StateWriter &out) const {
        records_.Save(out);
        totals_.Save(out);
    }
    void ExtractRecords(StateWriter &out) {
        records_.Extract(out);
        totals_.Extract(out);
    }
    void MergeRecords(StateReader &in) {
        records_.Merge(in);
        totals_.Merge(in);
    }

  private:
    struct Estimate;
    void EstimatePixels(Vector2i size, const std::vector<Point2i> &pixels);
    void EstimateCells();
    void Divide(size_t node, const RouletteRecord **begin, const RouletteRecord **end, const Estimate &prior);

    PointTree tree_;  ///< with kKinds roots
    std::vector<Cell> cells_;
    Vector2i size_{};           ///< of the picture
    int tile_ = 1;              ///< side of tiles_ in pixels
    std::vector<Float> tiles_;  ///< sqrt(C0 / V0) / I
    PathRecordStore<RouletteRecord> records_;
    PathRecordStore<PathTotal> totals_;
};

}  // namespace ext
