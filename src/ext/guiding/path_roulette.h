#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "ext/guiding/point_tree.h"
#include "pbrt/transport/vertex.h"

namespace ext {

/// What the parts of a path cost, in vertices.
struct PathCost {
    static constexpr Float kCamera = 1;     ///< what every path costs
    static constexpr Float kBounce = 0.4f;  ///< a ray, and what it meets
    static constexpr Float kLight = 0.6f;   ///< sampling light
};

/// What a path found from one of its vertices on, to be learned from.
struct RouletteRecord {
    struct Part {
        Float found = 0;  ///< by a path of weight 1; mean over wavelengths
        Float cost = 0;   ///< see PathCost; 0: there was no such path
        bool IsUsable() const { return found >= 0 && std::isfinite(found * found); }
    };
    Point3 p{};
    uint32_t kind = 0;   ///< PathRoulette::KindOf
    Part here, onwards;  ///< from there on, and without light sampling there; an empty place if `here` cost nothing
};

/// What a whole path found.
struct PathTotal {
    Float found = 0;  ///< mean over wavelengths
    Float cost = 0;   ///< see PathCost; 0: an empty place
};

/// With which probability a path should go on where it arrives, and again after light was sampled there, by what
/// earlier paths found from there on and what that cost: Rath et al., "EARS: Efficiency-Aware Russian Roulette and
/// Splitting" (2022), without splitting. A vertex of path weight beta whose estimate has the second moment M and costs
/// C, in a pixel of radiance I, gets the probability k beta/I sqrt(M/C) sqrt(C0/V0); C0 is the mean cost of a path, and
/// V0 the mean variance of a sample over I^2. V0 is that of blocks of samples, as pixel samplers are even in their
/// first dimensions, and the factor k makes up for what longer blocks would show.
class PathRoulette {
  public:
    /// The least probability from one sampling of light to the next: what is known of a cell is noisy where light is
    /// hard to find.
    static constexpr Float kMinContinuation = 0.5f;
    /// k.
    static constexpr Float kVarianceCorrection = 1.2f;

    /// Forgets all; places for `paths` paths that may fill `vertices` records each. Number i is of the pixel
    /// pixelOf(i).
    void BeginRecords(size_t paths, size_t vertices);
    size_t Vertices() const { return vertices_; }
    void Record(size_t place, const RouletteRecord &record) { records_[place] = record; }
    void RecordPath(size_t path, const PathTotal &total) { totals_[path] = total; }

    /// Places with different numbers do not know of each other: the six sides that a normal may point to, each with
    /// glossy BSDFs and without, and media.
    static uint32_t KindOf(const Vector3 &n, bool isGlossy);
    static uint32_t KindOf(const PathVertex &vertex);
    static constexpr uint32_t kInMedium = 12, kKinds = 13;

    /// True if something was learned.
    bool HasEstimates() const { return !tree_.IsEmpty(); }
    /// What is known of a place, k sqrt(M / C): where paths arrive, and after light was sampled. Below 0: nothing.
    struct Cell {
        Float here = -1, onwards = -1;
    };
    const Cell &At(const Point3 &p, uint32_t kind) const { return cells_[tree_.LeafOf(p, kind)]; }
    /// The probability by one of a cell's numbers, `least` to 1; 0 where nothing is known. `worth`: the path's weight,
    /// mean over wavelengths, times PixelImportance of its pixel.
    static Float ContinuationProbability(Float known, Float worth, Float least = kMinContinuation) {
        return known < 0 ? 0 : std::clamp(worth * known, least, Float(1));
    }

    /// sqrt(C0/V0)/I of a pixel, relative to the picture's corner: what a path adds to it, times this and squared, is
    /// the part of the variance, in vertices that it is worth. HasEstimates() must be true.
    Float PixelImportance(Point2i pixel) const {
        const Point2i at(std::clamp(pixel.x, 0, size_.x - 1) / tile_, std::clamp(pixel.y, 0, size_.y - 1) / tile_);
        return tiles_[static_cast<size_t>(at.y * ((size_.x + tile_ - 1) / tile_) + at.x)];
    }

    /// What was learned is to be used for a picture of another size, or of something else (`isSameView` false): then
    /// PixelImportance is everywhere what it was in the mean.
    void UseFor(Vector2i size, bool isSameView);

    /// From all records. `pixelOf(i)`: the pixel of path i, relative to the picture's corner; the paths of a pixel are
    /// neighbours.
    template <class PixelOf>
    void Learn(Vector2i size, PixelOf &&pixelOf) {
        std::vector<Point2i> pixels;
        pixels.reserve(totals_.size());
        for (size_t i = 0; i < totals_.size(); ++i) pixels.push_back(pixelOf(i));
        EstimatePixels(size, pixels);
        EstimateCells();
    }
    /// What all recorded paths cost, in vertices.
    double RecordedCost() const;
    size_t Cells() const { return cells_.size(); }
    size_t Bytes() const { return tree_.Bytes() + cells_.size() * sizeof(Cell) + tiles_.size() * sizeof(Float); }
    size_t RecordBytes() const { return records_.size() * sizeof(RouletteRecord) + totals_.size() * sizeof(PathTotal); }

    void Save(StateWriter &out) const;
    void Load(StateReader &in);
    /// Empty, or what is wrong with what was read, but for the tree.
    std::optional<std::string> Validate() const;
    Vector2i Size() const { return size_; }
    void TakeRecords(StateWriter &out) const;
    void AddRecords(StateReader &in);
    void ClearRecords();

  private:
    struct Known;
    void EstimatePixels(Vector2i size, const std::vector<Point2i> &pixels);
    void EstimateCells();
    void Divide(size_t node, const RouletteRecord **begin, const RouletteRecord **end, const Known &prior);

    PointTree tree_;  ///< with kKinds roots
    std::vector<Cell> cells_;
    Vector2i size_{};           ///< of the picture
    int tile_ = 1;              ///< side of tiles_ in pixels
    std::vector<Float> tiles_;  ///< sqrt(C0 / V0) / I
    size_t vertices_ = 1;
    std::vector<RouletteRecord> records_;
    std::vector<PathTotal> totals_;
};

}  // namespace ext
