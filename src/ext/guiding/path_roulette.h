#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>
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
    static constexpr uint32_t kKinds = 13;
    Point3 p{};
    uint32_t kind = 0;      ///< PathRoulette::KindOf
    Segment here, onwards;  ///< suffix with and without light sampling at the vertex; `here` of cost 0: empty slot

    bool IsEmpty() const { return !(here.cost > 0); }
    /// Empty if valid, else the error. Radiance may be infinite; such records are excluded from learning.
    std::optional<std::string> Validate() const {
        if (IsEmpty() || !std::isfinite(p.x + p.y + p.z) || !std::isfinite(here.cost) || !std::isfinite(onwards.cost))
            return "a record is not finite";
        return kind < kKinds ? std::nullopt : std::optional("a record has an invalid kind");
    }
};

struct PathTotal {
    Float radiance = 0;  ///< mean over wavelengths
    Float cost = 0;      ///< see PathCost; 0: empty slot

    bool IsEmpty() const { return !(cost > 0); }
    std::optional<std::string> Validate() const {
        return !IsEmpty() && std::isfinite(cost) ? std::nullopt : std::optional("a record is not finite");
    }
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
    static constexpr Float kVarianceCorrection = 1.2f;  ///< k, for longer blocks of samples

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
    static uint32_t KindOf(const Vector3 &n, bool isGlossy) {
        const Vector3 a = Abs(n);
        const Float component[] = {n.x, n.y, n.z};
        // & instead of &&: normals vary too much for branch prediction.
        const uint32_t axis = (a.x >= a.y) & (a.x >= a.z) ? 0u : a.y >= a.z ? 1u : 2u;
        return axis * 4 + (component[axis] < 0 ? 2u : 0u) + (isGlossy ? 1u : 0u);
    }
    static uint32_t KindOf(const PathVertex &vertex) {
        return KindOf(FaceForward(vertex.point.n, vertex.point.wo), Has(vertex.bsdf.Flags(), BxdfFlags::Glossy));
    }
    static constexpr uint32_t kInMedium = 12, kKinds = RouletteRecord::kKinds;

    bool HasEstimates() const { return !tree_.IsEmpty(); }  ///< true after Learn with enough records
    /// k sqrt(M / C) on arrival and after next-event estimation; negative: no estimate.
    struct Cell {
        Float here = -1, onwards = -1;
    };
    const Cell &At(const Point3 &p, uint32_t kind) const { return cells_[tree_.LeafOf(p, kind)]; }
    /// Continuation probability in [min, 1] from a cell's estimate; 0: no estimate. `importance`: throughput (mean
    /// over wavelengths) times PixelImportance.
    static Float ContinuationProbability(Float estimate, Float importance, Float min = kMinContinuation) {
        return estimate < 0 ? 0 : std::clamp(importance * estimate, min, Float(1));
    }

    /// sqrt(C0/V0)/I of a pixel, relative to the image corner. A contribution times this, squared, is its variance in
    /// units of path cost (EARS). Requires HasEstimates().
    Float PixelImportance(Point2i pixel) const {
        const Point2i at(std::clamp(pixel.x, 0, size_.x - 1) / tile_, std::clamp(pixel.y, 0, size_.y - 1) / tile_);
        return tiles_[at.y * ((size_.x + tile_ - 1) / tile_) + at.x];
    }

    /// Adapts the estimates to another image size. `isSameView` false: the view differs, and every pixel uses the mean
    /// PixelImportance.
    void UseFor(Vector2i size, bool isSameView) {
        if (!HasEstimates() || size.x < 1 || size.y < 1 || (isSameView && size == size_)) return;
        if (!isSameView) {
            double radiance = 0;
            for (const Float importance : tiles_) radiance += 1 / double(importance);
            tiles_ = {Float(double(tiles_.size()) / radiance)};
            size_ = size;
            tile_ = std::max(size.x, size.y);
            return;
        }
        const auto scaled = [](int at, int from, int to) { return int(int64_t{at} * to / from); };
        const int tile = std::max(1, scaled(tile_, size_.x, size.x));
        std::vector<Float> tiles;
        for (int y = 0; y < size.y; y += tile)
            for (int x = 0; x < size.x; x += tile)
                tiles.push_back(PixelImportance({scaled(std::min(x + tile / 2, size.x - 1), size.x, size_.x),
                                                 scaled(std::min(y + tile / 2, size.y - 1), size.y, size_.y)}));
        tiles_ = std::move(tiles);
        size_ = size;
        tile_ = tile;
    }

    /// Rebuilds all estimates from all records. `pixelOf(i)`: pixel of path i relative to the image corner; the paths
    /// of a pixel are consecutive.
    void Learn(Vector2i size, auto &&pixelOf) {
        std::vector<Point2i> pixels;
        pixels.reserve(totals_.Places().size());
        for (size_t i = 0; i < totals_.Places().size(); ++i) pixels.push_back(pixelOf(i));
        EstimatePixels(size, pixels);
        if (!HasEstimates()) return;
        std::vector<const RouletteRecord *> records;
        for (const RouletteRecord &r : records_.Places())
            if (!r.IsEmpty()) records.push_back(&r);
        std::stable_sort(records.begin(), records.end(),
                         [](const auto *a, const auto *b) { return a->kind < b->kind; });
        const RouletteRecord **begin = records.data(), **end = begin + records.size();
        for (uint32_t kind = 0; kind < kKinds; ++kind) {
            const RouletteRecord **const last = std::find_if(begin, end, [&](const auto *r) { return r->kind > kind; });
            Divide(kind, begin, last, {});
            begin = last;
        }
    }
    /// In vertices.
    double RecordedCost() const {
        double cost = 0;
        for (const PathTotal &total : totals_.Places()) cost += double(total.cost);
        return cost;
    }
    size_t Cells() const { return cells_.size(); }
    size_t Bytes() const { return tree_.Bytes() + cells_.size() * sizeof(Cell) + tiles_.size() * sizeof(Float); }
    size_t RecordBytes() const { return records_.Bytes() + totals_.Bytes(); }

    void Visit(auto &archive) { archive(cells_, tree_, size_, tile_, tiles_); }
    std::optional<std::string> Validate() const {
        if (std::optional<std::string> fault = tree_.ValidateFor(kKinds, cells_.size())) return fault;
        if (!HasEstimates())
            return cells_.empty() && tiles_.empty() ? std::nullopt : std::optional("roulette cells without a tree");
        constexpr int kMaxSide = 1 << 24;
        if (tile_ < 1 || tile_ > kMaxSide || size_.x < 1 || size_.y < 1 || size_.x > kMaxSide || size_.y > kMaxSide)
            return "roulette has an invalid image size or tile size";
        const auto along = [&](int pixels) { return size_t((pixels + tile_ - 1) / tile_); };
        if (tiles_.size() != along(size_.x) * along(size_.y)) return "the roulette tiles do not cover the image";
        for (const Float tile : tiles_)
            if (!(tile > 0)) return "a roulette tile has no importance";
        for (const Cell &cell : cells_)
            if (!std::isfinite(cell.here) || !std::isfinite(cell.onwards)) return "a roulette cell is not finite";
        return {};
    }
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
    static constexpr std::ptrdiff_t kCellRecords = 1024;  ///< cells with more records are split
    static constexpr double kPriorRecords = 128;          ///< weight of the parent cell's estimate, in records
    /// Outlier limit: maximum share of one record in its cell's second moment.
    static constexpr double kLargestPart = 0.1;
    static constexpr double kLargestPixel = 0.01;  ///< outlier limit: maximum share of one pixel in the image variance
    static constexpr double kDark = 0.2;           ///< fraction of the image mean below which errors have less weight
    static constexpr double kTilePaths = 64;       ///< minimum recorded paths per image tile, if the image has as many

    struct Moments {
        double squares = 0, cost = 0;
        Float Root() const { return cost > 0 ? kVarianceCorrection * Float(std::sqrt(squares / cost)) : -1; }
    };

    /// `prior`: of the parent cell.
    static Moments MeanOf(const RouletteRecord *const *begin, const RouletteRecord *const *end,
                          RouletteRecord::Segment RouletteRecord::*segment, const Moments &prior) {
        const auto square = [&](const RouletteRecord *r) { return Sqr(double((r->*segment).radiance)); };
        double squares = 0;
        for (const auto *r = begin; r != end; ++r) squares += square(*r);
        double n = prior.cost > 0 ? kPriorRecords : 0;
        Moments mean{n * prior.squares, n * prior.cost};
        for (const auto *r = begin; r != end; ++r) {
            const auto cost = double(((*r)->*segment).cost);
            if (!(cost > 0)) continue;
            ++n;
            mean.squares += std::min(square(*r), kLargestPart * squares);
            mean.cost += cost;
        }
        return n > 0 ? Moments{mean.squares / n, mean.cost / n} : Moments{};
    }

    struct Estimate {
        Moments here, onwards;
    };

    /// Mean radiance of tiles in rows of count.x, by a 3x3 filter weighted 4 : 2 : 1; at least a share of `mean`, the
    /// image's. `sums`: radiance and number of paths.
    static std::vector<double> FilteredRadiance(Vector2i count, std::span<const std::array<double, 2>> sums,
                                                double mean) {
        std::vector<double> radiance(sums.size());
        for (int y = 0; y < count.y; ++y)
            for (int x = 0; x < count.x; ++x) {
                double weighted = 0, paths = 0;
                for (int dy = -1; dy <= 1; ++dy)
                    for (int dx = -1; dx <= 1; ++dx) {
                        if (x + dx < 0 || x + dx >= count.x || y + dy < 0 || y + dy >= count.y) continue;
                        const auto &tile = sums[(y + dy) * count.x + x + dx];
                        const double weight = (dx == 0 ? 2 : 1) * (dy == 0 ? 2 : 1);
                        weighted += weight * tile[0];
                        paths += weight * tile[1];
                    }
                radiance[y * count.x + x] = std::hypot(paths > 0 ? weighted / paths : mean, kDark * mean);
            }
        return radiance;
    }
    /// Variance within pixels, of blocks of successive samples, over the square of `radianceOf`(pixel).
    std::vector<double> RelativeVariances(std::span<const Point2i> pixels, auto &&radianceOf) const {
        const std::span<const PathTotal> totals = totals_.Places();
        std::vector<double> variances;
        for (size_t i = 0, end = 0; i < totals.size(); i = end) {
            while (end < totals.size() && pixels[end] == pixels[i]) ++end;
            const size_t block = std::bit_floor(std::max<size_t>(1, (end - i) / 2));
            double n = 0, sum = 0, squares = 0;
            for (size_t k = i; k + block <= end; k += block) {
                if (!std::all_of(&totals[k], &totals[k] + block, [](const PathTotal &t) { return t.cost > 0; }))
                    continue;
                double x = 0;
                for (size_t m = k; m < k + block; ++m) x += double(totals[m].radiance);
                ++n;
                sum += x;
                squares += x * x;
            }
            if (n < 2) continue;
            const double I = radianceOf(pixels[i]);
            variances.push_back(std::max(0.0, (squares - sum * sum / n) / (n - 1)) / (double(block) * I * I));
        }
        return variances;
    }
    void EstimatePixels(Vector2i size, const std::vector<Point2i> &pixels) {
        const std::span<const PathTotal> totals = totals_.Places();
        double paths = 0, sum = 0;
        for (const PathTotal &t : totals) {
            if (!(t.cost > 0)) continue;
            ++paths;
            sum += double(t.radiance);
        }
        tree_.Begin(0);
        cells_.clear();
        tiles_.clear();
        if (!(sum > 0)) return;
        const double mean = sum / paths;
        const double perPixel = paths / (double(size.x) * size.y);
        size_ = size;
        tile_ = std::max(4, int(std::ceil(std::sqrt(kTilePaths / perPixel))));
        const Vector2i count = (size + (tile_ - 1)) / tile_;
        const auto tileOf = [&](const Point2i &p) { return p.y / tile_ * count.x + p.x / tile_; };
        std::vector<std::array<double, 2>> sums(size_t(count.x) * count.y);
        for (size_t i = 0; i < totals.size(); ++i) {
            if (!(totals[i].cost > 0)) continue;
            auto &tile = sums[tileOf(pixels[i])];
            tile[0] += double(totals[i].radiance);
            ++tile[1];
        }
        const std::vector<double> radiance = FilteredRadiance(count, sums, mean);
        const std::vector<double> variances =
            RelativeVariances(pixels, [&](const Point2i &p) { return radiance[tileOf(p)]; });
        const double all = std::accumulate(variances.begin(), variances.end(), 0.0);
        double limited = 0;
        for (const double v : variances) limited += std::min(v, kLargestPixel * all);
        if (!(limited > 0)) return;
        const double scale = std::sqrt(RecordedCost() / paths * double(variances.size()) / limited);
        tiles_.resize(radiance.size());
        for (size_t i = 0; i < radiance.size(); ++i) tiles_[i] = Float(scale / radiance[i]);
        tree_.Begin(kKinds);
    }
    void Divide(size_t node, const RouletteRecord **begin, const RouletteRecord **end, const Estimate &prior) {
        const std::ptrdiff_t count = end - begin;
        const Estimate mean{MeanOf(begin, end, &RouletteRecord::here, prior.here),
                            MeanOf(begin, end, &RouletteRecord::onwards, prior.onwards)};
        const RouletteRecord **second = begin;
        if (count > kCellRecords) second = tree_.Divide(node, begin, end, [](const RouletteRecord *r) { return r->p; });
        if (second == begin) {
            tree_.MakeLeaf(node, cells_.size());
            cells_.push_back({mean.here.Root(), mean.onwards.Root()});
            return;
        }
        const size_t below = tree_.Nodes()[node].below;
        Divide(below, begin, second, mean);
        Divide(below + 1, second, end, mean);
    }

    PointTree tree_;  ///< with kKinds roots
    std::vector<Cell> cells_;
    Vector2i size_{};           ///< of the image
    int tile_ = 1;              ///< side of tiles_ in pixels
    std::vector<Float> tiles_;  ///< sqrt(C0 / V0) / I
    PathRecordStore<RouletteRecord> records_;
    PathRecordStore<PathTotal> totals_;
};

}  // namespace ext
