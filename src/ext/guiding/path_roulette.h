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
    static constexpr Float kCamera = 1;     ///< per path
    static constexpr Float kBounce = 0.4f;  ///< ray and intersection
    static constexpr Float kLight = 0.6f;   ///< light sampling
};

/// Record of a path suffix, from one of its vertices.
struct RouletteRecord {
    struct Segment {
        Float radiance = 0;  ///< divided by the throughput at the vertex; mean over wavelengths
        Float cost = 0;      ///< see PathCost; 0: not recorded
        bool IsUsable() const { return radiance >= 0 && std::isfinite(radiance * radiance); }
    };
    Point3 p{};
    uint32_t kind = 0;      ///< PathRoulette::KindOf
    Segment here, onwards;  ///< suffix with and without light sampling at the vertex; `here` of cost 0: empty slot

    bool IsEmpty() const { return !(here.cost > 0); }
    /// Empty if valid, else the error. Radiance may be infinite; such records are excluded from learning.
    std::optional<std::string> Validate() const;
};

struct PathTotal {
    Float radiance = 0;  ///< mean over wavelengths
    Float cost = 0;      ///< see PathCost; 0: empty slot

    bool IsEmpty() const { return !(cost > 0); }
    std::optional<std::string> Validate() const;
};

/// Learned Russian roulette without splitting: Rath et al., "EARS: Efficiency-Aware Russian Roulette and Splitting"
/// (2022). Continuation probabilities, on arrival and again after next-event estimation, follow from radiance and cost
/// of earlier paths:
///
///   P = k beta/I sqrt(M/C) sqrt(C0/V0)
///
/// beta is the throughput, I the pixel radiance; M and C are second moment and cost of the cell. C0 is the mean path
/// cost, V0 the mean sample variance over I^2. V0 is measured on blocks of samples, as pixel samplers stratify their
/// first dimensions; k corrects for longer blocks.
class PathRoulette {
  public:
    /// Minimum probability between two next-event estimations: estimates are noisy where light is hard to sample.
    static constexpr Float kMinContinuation = 0.5f;
    /// k.
    static constexpr Float kVarianceCorrection = 1.2f;

    /// Discards all records; allocates `paths` paths with up to `vertices` records each.
    void BeginRecords(size_t paths, size_t vertices) {
        records_.Begin(paths, vertices);
        totals_.Begin(paths, 1);
    }
    size_t Vertices() const { return records_.PerPath(); }
    /// Stores the record of vertex k < Vertices() of a path.
    void Record(size_t path, size_t k, const RouletteRecord &record) { records_.Set(path, k, record); }
    void RecordPath(size_t path, const PathTotal &total) { totals_.Set(path, 0, total); }

    /// Kinds share no estimates: the six dominant directions of the normal, each with and without glossy BSDF, and
    /// media.
    static uint32_t KindOf(const Vector3 &n, bool isGlossy);
    static uint32_t KindOf(const PathVertex &vertex);
    static constexpr uint32_t kInMedium = 12, kKinds = 13;

    /// True after Learn with enough records.
    bool HasEstimates() const { return !tree_.IsEmpty(); }
    /// k sqrt(M / C) on arrival and after next-event estimation; negative: no estimate.
    struct Cell {
        Float here = -1, onwards = -1;
    };
    const Cell &At(const Point3 &p, uint32_t kind) const { return cells_[tree_.LeafOf(p, kind)]; }
    /// Continuation probability in [least, 1] from a cell's estimate; 0: no estimate. `importance`: throughput (mean
    /// over wavelengths) times PixelImportance.
    static Float ContinuationProbability(Float estimate, Float importance, Float least = kMinContinuation) {
        return estimate < 0 ? 0 : std::clamp(importance * estimate, least, Float(1));
    }

    /// sqrt(C0/V0)/I of a pixel, relative to the image corner. A contribution times this, squared, is its variance in
    /// units of path cost (EARS). Requires HasEstimates().
    Float PixelImportance(Point2i pixel) const {
        const Point2i at(std::clamp(pixel.x, 0, size_.x - 1) / tile_, std::clamp(pixel.y, 0, size_.y - 1) / tile_);
        return tiles_[at.y * ((size_.x + tile_ - 1) / tile_) + at.x];
    }

    /// Adapts the estimates to another image size. `isSameView` false: the view differs, and every pixel uses the mean
    /// PixelImportance.
    void UseFor(Vector2i size, bool isSameView);

    /// Rebuilds all estimates from all records. `pixelOf(i)`: pixel of path i relative to the image corner; the paths
    /// of a pixel are consecutive.
    template <class PixelOf>
    void Learn(Vector2i size, PixelOf &&pixelOf) {
        std::vector<Point2i> pixels;
        pixels.reserve(totals_.Places().size());
        for (size_t i = 0; i < totals_.Places().size(); ++i) pixels.push_back(pixelOf(i));
        EstimatePixels(size, pixels);
        EstimateCells();
    }
    /// In vertices.
    double RecordedCost() const;
    size_t Cells() const { return cells_.size(); }
    size_t Bytes() const { return tree_.Bytes() + cells_.size() * sizeof(Cell) + tiles_.size() * sizeof(Float); }
    size_t RecordBytes() const { return records_.Bytes() + totals_.Bytes(); }

    template <class Archive>
    void Visit(Archive &archive) {
        archive(cells_, tree_, size_, tile_, tiles_);
    }
    /// Empty if valid, else the error.
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
    Vector2i size_{};           ///< of the image
    int tile_ = 1;              ///< side of tiles_ in pixels
    std::vector<Float> tiles_;  ///< sqrt(C0 / V0) / I
    PathRecordStore<RouletteRecord> records_;
    PathRecordStore<PathTotal> totals_;
};

}  // namespace ext
